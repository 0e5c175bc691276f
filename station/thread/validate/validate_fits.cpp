#include "station/thread/validate/validate_fits.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <opencv2/imgproc.hpp>

#include "inversion/view/agreement.h"
#include "renderer/picture/image_file.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/output/interrupt.h"
#include "station/output/progress.h"
#include "station/session/results.h"
#include "station/thread/invert/fit_document.h"
#include "station/thread/validate/photographed_spool.h"
#include "station/thread/validate/seeds.h"
#include "station/thread/validate/synthetic_views.h"

namespace station {
namespace {

using inversion::View;
using Step = std::function<void(const std::string&, double)>;  // told what is being done and the finished fraction

constexpr int kBlock_px = 8;
constexpr double kPhotographShare = 0.2;  // of the work, for each draw
// The views that each fold leaves out, as indices among the reflections and among the transmissions: middle and oblique
// ones of both mountings.
constexpr std::array<std::pair<std::size_t, std::size_t>, 3> kFolds{{{2, 2}, {7, 1}, {10, 3}}};

struct Gathered {
  std::vector<inversion::ViewAgreement> all, reflection, transmission, fitted;
  double seconds = 0;
  std::vector<ValidatedModel::OfView> views;

  void add(const View& view, const inversion::ViewAgreement& agreement) {
    all.push_back(agreement);
    (view.transmission ? transmission : reflection).push_back(agreement);
  }
};

std::vector<bool> left_out(const std::vector<View>& views, std::size_t fold) {
  std::size_t reflections = 0, transmissions = 0;
  std::vector<bool> out;
  for (const View& view : views)
    out.push_back(view.transmission ? transmissions++ == kFolds[fold].second : reflections++ == kFolds[fold].first);
  return out;
}

PictureHalves rendered(const inversion::WrappedSpool& spool, const View& view, const inversion::ViewFit& fit,
                       int samples, std::uint64_t seed) {
  PictureHalves pictures;
  for (std::size_t half = 0; half < 2; ++half)
    pictures[half] =
        inversion::fitted_view(spool, view, fit.model, samples, seed + half, [](double) { return !interrupted(); });
  return pictures;
}

// A row of pictures: the photograph, then each model's rendering and its difference (grey: none; full scale is a
// quarter of the brightest pixel).
cv::Mat3b comparison_row(const View& view, const std::vector<cv::Mat3f>& renderings) {
  double most = 0;
  cv::minMaxIdx(view.image.reshape(1), nullptr, &most);
  const double scale = most > 0 ? 1 / most : 1;
  std::vector<cv::Mat3b> parts{renderer::encode_srgb(view.image, scale)};
  for (const cv::Mat3f& rendering : renderings) {
    cv::Mat3f difference;
    cv::subtract(rendering, view.image, difference);
    difference.convertTo(difference, CV_32F, 2 * scale, 0.5);
    difference.setTo(cv::Scalar::all(0.5), view.mask == 0);
    parts.push_back(renderer::encode_srgb(rendering, scale));
    parts.push_back(renderer::encode_srgb(difference, 0.4));
  }
  cv::Mat3b row;
  cv::hconcat(parts, row);
  return row;
}

// Fits the thread model to all views by either solver with its defaults, then by the fewest of Levenberg-Marquardt's
// first rounds that get as far as Adam.
std::vector<ComparedSolver> compare_solvers(const ValidateRequest& request, const Spool& spool,
                                            const std::vector<View>& views, const Step& step) {
  constexpr int kPaths = 4096, kRepetitions = 4;
  const inversion::FitOptions whole{.seed = request.seed},
      adam{.solver = inversion::Solver::adam, .seed = request.seed};
  std::vector<ComparedSolver> compared;
  const auto compare = [&](const std::string& name, inversion::FitOptions options) -> const ComparedSolver& {
    options.progress = [&](const std::string& what, double share) {
      step("solver " + name + ", " + what, std::min(1.0, 0.4 * (static_cast<double>(compared.size()) + share)));
      return !interrupted();
    };
    const auto started = std::chrono::steady_clock::now();
    const inversion::ViewFit fit = inversion::fit_views(spool.wrapping, views, options);
    compared.push_back({.name = name,
                        .seconds = seconds_since(started),
                        .loss = inversion::independent_loss(spool.wrapping, views, fit, kPaths, kRepetitions,
                                                            request.seed + kIndependentLossSeeds)});
    return compared.back();
  };
  compare(name_of(whole.solver), whole);
  const double by_adam = compare(name_of(adam.solver), adam).loss.mean;
  for (std::size_t rounds = 1; rounds <= whole.paths_per_block.size(); ++rounds) {
    const std::string name = name_of(whole.solver) + ", " + std::to_string(rounds) + " of " +
                             std::to_string(whole.paths_per_block.size()) + " rounds";
    if (compare(name, inversion::first_rounds(whole, rounds)).loss.mean <= by_adam) break;
  }
  return compared;
}

// What is fitted: a model, and the views as they truly are or as a calibration takes them to be.
struct Variant {
  inversion::ModelKind model;
  bool calibrated = false;
  std::vector<View> views;
};

std::vector<Variant> variants_of(const ValidateRequest& request, const RigFile& rig, const Spool& spool,
                                 const PhotographedSpool& made) {
  std::vector<Variant> variants;
  for (inversion::ModelKind model : request.models) variants.push_back({.model = model, .views = made.views});
  if (!request.calibration) return variants;
  const RigCalibration calibration = read_calibration(*request.calibration);
  Variant calibrated{.model = inversion::ModelKind::thread,
                     .calibrated = true,
                     .views = synthetic_views(rig, spool.wrapping, kPooledWidth_px, kPooledHeight_px, &calibration)};
  for (std::size_t i = 0; i < made.views.size(); ++i) {
    calibrated.views[i].image = made.views[i].image;
    calibrated.views[i].mask &= made.views[i].mask;  // the photograph is drawn there only
  }
  variants.push_back(std::move(calibrated));
  return variants;
}

std::string label_of(const ValidatedModel& of) {
  return shown_model(name_of(of.model)) + (of.calibrated ? "*" : "");
}

// The photographs of a spool and those of another draw of its fibers.
struct TwoDraws {
  PhotographedSpool made, other;
};

TwoDraws photograph_twice(const ValidateRequest& request, const RigFile& rig, const Spool& spool,
                          const std::filesystem::path& spool_file, const Step& step) {
  const std::filesystem::path folder = request.out / spool_file.stem();
  const SpoolPhotographs as_asked{.rig_file = request.rig,
                                  .spool_file = spool_file,
                                  .folder = folder / "photographs",
                                  .samples_per_pixel = request.samples_per_pixel,
                                  .seed = request.seed};
  TwoDraws draws;
  draws.made = photograph_spool(rig, spool, as_asked,
                                [&](const std::string& what, double share) { step(what, kPhotographShare * share); });
  SimulatedFibers placed_anew = *spool.simulation;
  placed_anew.seed += kPlacedAnew;
  Spool drawn_anew = spool;
  drawn_anew.simulation = placed_anew;
  SpoolPhotographs of_other = as_asked;
  of_other.folder = folder / "another_draw";
  draws.other = photograph_spool(rig, drawn_anew, of_other, [&](const std::string& what, double share) {
    step(what, kPhotographShare * (1 + share));
  });
  return draws;
}

Gathered agreement_of(const TwoDraws& draws) {
  const PhotographedSpool& made = draws.made;
  Gathered gathered;
  for (std::size_t i = 0; i < made.views.size(); ++i)
    gathered.add(made.views[i],
                 inversion::noiseless_agreement(made.views[i], made.pictures[i], draws.other.pictures[i], kBlock_px));
  return gathered;
}

// A spool whose variants are fitted, fold by fold.
struct FittedSpool {
  const ValidateRequest& request;
  const Spool& spool;
  const PhotographedSpool& made;
  std::vector<Variant> variants;
  std::vector<Gathered> gathered;  // of each variant
};

struct Fold {
  int number;
  std::vector<bool> out;                      // of each view
  std::vector<std::vector<cv::Mat3f>> shown;  // of each view that is left out: the variants' renderings
};

// Fits a variant to the views that the fold keeps. `step` is told the finished fraction of this fit.
inversion::ViewFit fit_kept(const FittedSpool& of, const Variant& variant, const Fold& fold, const Step& step) {
  std::vector<View> kept;
  for (std::size_t i = 0; i < fold.out.size(); ++i)
    if (!fold.out[i]) kept.push_back(variant.views[i]);
  inversion::FitOptions options{.model = variant.model, .seed = of.request.seed};
  if (options.model == inversion::ModelKind::yarn) options.paths_per_block = {128, 512};
  options.progress = [&](const std::string& what, double share) {
    step(name_of(options.model) + (variant.calibrated ? " as calibrated, " : ", ") + what, share);
    return !interrupted();
  };
  return inversion::fit_views(of.spool.wrapping, kept, options);
}

// Renders the views that the fold leaves out, in the first fold the others too, and gathers how they agree.
void compare_views(const FittedSpool& of, const Variant& variant, const inversion::ViewFit& fit, Fold& fold,
                   Gathered& gathered) {
  for (std::size_t i = 0; i < fold.out.size(); ++i) {
    if (!fold.out[i] && fold.number > 0) continue;
    const View& view = variant.views[i];
    const PictureHalves pictures =
        rendered(of.spool.wrapping, view, fit, of.request.fitted_samples,
                 kFittedViewSeeds + kFoldSeedStep * static_cast<std::uint64_t>(fold.number) + 2 * i);
    const auto agreement = inversion::noiseless_agreement(view, of.made.pictures[i], pictures, kBlock_px);
    if (fold.number == 0)
      gathered.views.push_back({view.id, fold.out[i], agreement.relative_rmse(), agreement.relative_bias});
    if (!fold.out[i]) {
      gathered.fitted.push_back(agreement);
      continue;
    }
    gathered.add(view, agreement);
    cv::Mat3f& mean = fold.shown[i].emplace_back();
    cv::addWeighted(pictures[0], 0.5, pictures[1], 0.5, 0, mean);
  }
}

// Fits all variants without the fold's views. `step` is told the finished fraction of all folds.
void validate_fold(FittedSpool& of, int number, const std::filesystem::path& folder, const Step& step) {
  Fold fold{.number = number, .out = left_out(of.made.views, static_cast<std::size_t>(number)), .shown = {}};
  fold.shown.resize(fold.out.size());
  const auto variants = static_cast<double>(of.variants.size()), parts = variants * of.request.folds;
  for (std::size_t m = 0; m < of.variants.size(); ++m) {
    const double done = (static_cast<double>(number) * variants + static_cast<double>(m)) / parts;
    const auto started = std::chrono::steady_clock::now();
    const inversion::ViewFit fit = fit_kept(of, of.variants[m], fold, [&](const std::string& what, double share) {
      step(what, 2 * kPhotographShare + (1 - 2 * kPhotographShare) * (done + 0.8 * share / parts));
    });
    of.gathered[m].seconds += seconds_since(started) / of.request.folds;
    compare_views(of, of.variants[m], fit, fold, of.gathered[m]);
  }
  for (std::size_t i = 0; i < fold.out.size(); ++i)
    if (fold.out[i])
      renderer::write_png(folder / (of.made.views[i].id + ".png"), comparison_row(of.made.views[i], fold.shown[i]));
}

ValidatedModel validated_model(const Variant& variant, const Gathered& gathered) {
  return {.model = variant.model,
          .calibrated = variant.calibrated,
          .relative_rmse = inversion::overall_relative_rmse(gathered.all),
          .reflection = inversion::overall_relative_rmse(gathered.reflection),
          .transmission = inversion::overall_relative_rmse(gathered.transmission),
          .fitted_views = inversion::overall_relative_rmse(gathered.fitted),
          .seconds = gathered.seconds,
          .views = gathered.views};
}

ValidatedSpool validate_spool(const ValidateRequest& request, const RigFile& rig,
                              const std::filesystem::path& spool_file, const Step& step) {
  const Spool spool = read_spool(spool_file);
  const TwoDraws photographs = photograph_twice(request, rig, spool, spool_file, step);
  const PhotographedSpool& made = photographs.made;
  const Gathered draws = agreement_of(photographs);
  FittedSpool fitted{.request = request,
                     .spool = spool,
                     .made = made,
                     .variants = variants_of(request, rig, spool, made),
                     .gathered = {}};
  fitted.gathered.resize(fitted.variants.size());
  for (int fold = 0; fold < request.folds; ++fold) validate_fold(fitted, fold, request.out / spool_file.stem(), step);
  ValidatedSpool result{.name = spool.name,
                        .fibers_per_thread = spool.simulation->fibers_per_thread,
                        .draw = inversion::overall_relative_rmse(draws.all) / std::sqrt(2.0),
                        .draw_reflection = inversion::overall_relative_rmse(draws.reflection) / std::sqrt(2.0),
                        .draw_transmission = inversion::overall_relative_rmse(draws.transmission) / std::sqrt(2.0),
                        .models = {},
                        .solvers = {}};
  if (request.solvers) result.solvers = compare_solvers(request, spool, made.views, step);
  if (request.folds == 0) return result;
  for (std::size_t m = 0; m < fitted.variants.size(); ++m)
    result.models.push_back(validated_model(fitted.variants[m], fitted.gathered[m]));
  return result;
}

}  // namespace

std::vector<ValidatedSpool> validate_fits(const ValidateRequest& request) {
  watch_interrupts();
  const RigFile rig = read_rig(request.rig);
  ProgressDisplay progress("validate", request.progress_style);
  std::vector<ValidatedSpool> spools;
  int shown = -1;
  for (std::size_t i = 0; i < request.spools.size(); ++i) {
    spools.push_back(validate_spool(request, rig, request.spools[i], [&](const std::string& what, double share) {
      const auto percent =
          static_cast<int>(100 * (static_cast<double>(i) + share) / static_cast<double>(request.spools.size()));
      if (percent != shown) progress.show(shown = percent, 100, request.spools[i].stem().string() + ": " + what);
    }));
    write_json_file(request.out / "validation.json", to_json(spools));
  }
  progress.finish(std::to_string(spools.size()) + " spools");
  return spools;
}

std::string describe(const std::vector<ValidatedSpool>& spools) {
  std::string text =
      "Relative RMSE over 8 x 8-block averages, %, without the noise of photograph and rendering\n"
      "spool                      fibers  model                left out  reflection  transmission  fitted views  "
      "seconds\n";
  std::map<std::string, std::vector<double>> by_model;
  for (const ValidatedSpool& spool : spools) {
    char line[160];
    std::snprintf(line, sizeof line, "%-25s  %6d  %-19s  %8.1f  %10.1f  %12.1f\n", spool.name.c_str(),
                  spool.fibers_per_thread, "draw", 100 * spool.draw, 100 * spool.draw_reflection,
                  100 * spool.draw_transmission);
    text += line;
    for (const ValidatedModel& m : spool.models) {
      std::snprintf(line, sizeof line, "%-25s  %6d  %-19s  %8.1f  %10.1f  %12.1f  %12.1f  %7.1f\n", spool.name.c_str(),
                    spool.fibers_per_thread, label_of(m).c_str(), 100 * m.relative_rmse, 100 * m.reflection,
                    100 * m.transmission, 100 * m.fitted_views, m.seconds);
      text += line;
      by_model[label_of(m)].push_back(m.relative_rmse);
    }
    for (const ComparedSolver& of : spool.solvers) {
      std::snprintf(line, sizeof line, "%-25s  %6d  %-18s  loss on other paths %.4g +- %.1g, %.1f s\n",
                    spool.name.c_str(), spool.fibers_per_thread, of.name.c_str(), of.loss.mean, of.loss.standard_error,
                    of.seconds);
      text += line;
    }
  }
  if (by_model.contains("thread*")) text += "thread*: with the geometry and light of the calibration\n";
  for (const auto& [model, errors] : by_model) {
    double sum = 0, worst = 0;
    for (double e : errors) sum += e, worst = std::max(worst, e);
    text += model + ": " + number_text(100 * sum / static_cast<double>(errors.size()), 1) + " % on average, " +
            number_text(100 * worst, 1) + " % at worst\n";
  }
  return text;
}

nlohmann::json to_json(const std::vector<ValidatedSpool>& spools) {
  nlohmann::json document = nlohmann::json::array();
  for (const ValidatedSpool& spool : spools) {
    nlohmann::json models = nlohmann::json::object();
    for (const ValidatedModel& m : spool.models) {
      nlohmann::json views = nlohmann::json::array();
      for (const ValidatedModel::OfView& view : m.views)
        views.push_back({{"id", view.id},
                         {"left_out", view.left_out},
                         {"relative_rmse", view.relative_rmse},
                         {"relative_bias", view.relative_bias}});
      models[m.calibrated ? "thread_calibrated" : name_of(m.model)] = {
          {"relative_rmse", m.relative_rmse}, {"reflection", m.reflection}, {"transmission", m.transmission},
          {"fitted_views", m.fitted_views},   {"seconds", m.seconds},       {"views", views}};
    }
    nlohmann::json solvers = nlohmann::json::object();
    for (const ComparedSolver& of : spool.solvers)
      solvers[of.name] = {
          {"seconds", of.seconds}, {"loss", of.loss.mean}, {"loss_standard_error", of.loss.standard_error}};
    document.push_back({{"spool", spool.name},
                        {"fibers_per_thread", spool.fibers_per_thread},
                        {"draw", spool.draw},
                        {"draw_reflection", spool.draw_reflection},
                        {"draw_transmission", spool.draw_transmission},
                        {"models", models},
                        {"solvers", solvers}});
  }
  return {{"spools", document}};
}

}  // namespace station
