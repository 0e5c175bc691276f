#include "station/thread/validate/validate_cloth.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "renderer/picture/image_file.h"
#include "renderer/trace/path_tracer.h"
#include "station/bench/cloth_on_cylinder.h"
#include "station/bench/spool_fibers.h"
#include "station/documents/draft_file.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/output/display.h"
#include "station/output/interrupt.h"
#include "station/output/watched_work.h"
#include "station/session/results.h"
#include "station/thread/invert/fit_document.h"
#include "station/thread/validate/photographed_spool.h"
#include "station/thread/validate/seeds.h"
#include "station/thread/validate/synthetic_views.h"

namespace station {
namespace {

using inversion::ModelKind;
using inversion::View;
namespace fs = std::filesystem;

constexpr int kWarp = 0, kWeft = 1;  // of the cloth's threads
constexpr const char *kReference = "reference", *kTrueFibers = "true fibers";
// Warp ends and weft picks of the reference's patch, at least. Bundles of ten fibers differ in brightness by some ten
// percent; of so many the mean is within about 1 %.
constexpr int kReferenceYarns = 40;
constexpr const char* kValidationStopped =
    "the validation was interrupted; the same command goes on with the pictures it has";

struct SpoolToFit {
  fs::path file;
  Spool spool;
};

// A patch with its threads, as the path tracer takes them.
struct Woven {
  renderer::YarnPatch patch;
  std::vector<renderer::ScatteringModel> threads;
};

void require_thread_of(const Spool& spool, double yarn_diameter_mm) {
  bundled_fibers(spool);
  if (std::abs(spool.wrapping.thread_diameter_mm - yarn_diameter_mm) > 1e-6)
    throw std::runtime_error("spool \"" + spool.name + "\": its thread is " +
                             number_text(spool.wrapping.thread_diameter_mm, 3) + " mm thick and the draft's yarn " +
                             number_text(yarn_diameter_mm, 3) + " mm; give a draft of this thread");
}

int yarns_of(const renderer::YarnPatch& patch, bool warp) {
  return static_cast<int>(std::ranges::count(patch.yarns, warp, &renderer::Yarn::warp));
}

renderer::YarnPatch of_many_yarns(const renderer::YarnPatch& patch) {
  const auto times = [&](bool warp) {
    const int yarns = yarns_of(patch, warp);
    return (kReferenceYarns + yarns - 1) / yarns;
  };
  return renderer::repeated(patch, times(true), times(false));
}

renderer::BundleParameters true_bundle(const Spool& spool) {
  const SimulatedFibers& fibers = bundled_fibers(spool);
  return {.fiber_count = fibers.fibers_per_thread,
          .radius_ratio = 2 * fibers.fiber_radius_mm / spool.wrapping.thread_diameter_mm,
          .fiber = fibers.scattering};
}

class Study {
 public:
  explicit Study(const ValidateClothRequest& request)
      : request_(request),
        rig_(read_rig(request.rig)),
        progress_("validate-cloth", request.progress_style),
        swatch_(back_lit_swatch(rig_, request.width_px, request.height_px)) {
    for (const fs::path& file : request.warps) warps_.push_back({file, read_spool(file)});
    weft_ = {request.weft, read_spool(request.weft)};
    for (const fs::path& file : request.drafts) {
      renderer::Draft draft = read_draft(file);
      draft.warp.threads = {kWarp}, draft.weft.threads = {kWeft};
      for (const SpoolToFit& warp : warps_) require_thread_of(warp.spool, draft.warp.diameter_mm);
      require_thread_of(weft_.spool, draft.weft.diameter_mm);
      drafts_.push_back({file.stem().string(), draft});
    }
    views_ = cylinder_views(rig_, cylinder_, request.width_px, request.height_px);
    views_.push_back(swatch_.view);
    for (const ModelKind model : request.models) models_.push_back(name_of(model));
    if (request.true_fibers) models_.push_back(kTrueFibers);
    pictures_ = drafts_.size() * warps_.size() * views_.size() * (1 + models_.size());
    fs::create_directories(request.out / "samples");
  }

  std::vector<PredictedSample> run() {
    std::vector<PredictedSample> samples;
    std::vector<cv::Mat3b> rows;
    for (const auto& [name, draft] : drafts_) {
      const renderer::YarnPatch patch = weave_watched(draft, progress_).patch;
      for (const SpoolToFit& warp : warps_)
        for (const View& view : views_) {
          std::vector<cv::Mat3f> shown;
          samples.push_back(predict(name, patch, warp, view, shown));
          const double white = display_scale(shown.front(), view.mask);
          std::vector<cv::Mat3b> row;
          for (const cv::Mat3f& picture : shown) row.push_back(renderer::encode_srgb(picture, white));
          cv::hconcat(row, rows.emplace_back());
        }
    }
    cv::Mat3b sheet;
    cv::vconcat(rows, sheet);
    renderer::write_png(request_.out / "samples.png", sheet);
    write_json_file(request_.out / "validation.json", to_json(samples));
    progress_.finish(std::to_string(samples.size()) + " samples");
    return samples;
  }

 private:
  PredictedSample predict(const std::string& draft, const renderer::YarnPatch& patch, const SpoolToFit& warp,
                          const View& view, std::vector<cv::Mat3f>& shown) {
    PredictedSample sample{.weave = draft,
                           .warp = warp.file.stem().string(),
                           .side = view.id,
                           .block_px = comparable_block_px(patch, view.camera),
                           .models = {}};
    const std::string name = draft + "-" + sample.warp + "-" + view.id;
    const CompareOptions options{.fit_scale = false, .block_px = sample.block_px};
    const PictureHalves reference = pictures(name, kReference, warp, view, [&] {
      return Woven{.patch = with_fibers_of(of_many_yarns(patch), {warp.spool, weft_.spool}),
                   .threads = {simulated_fibers(warp.spool).scattering, simulated_fibers(weft_.spool).scattering}};
    });
    sample.noise_delta_e = compare_pictures(reference[0], reference[1], view.mask, options).mean_delta_e / 2;
    shown.push_back(mean_of(reference));
    for (const std::string& model : models_) {
      const PictureHalves predicted = pictures(name, model, warp, view, [&] {
        return Woven{.patch = patch, .threads = {model_of(warp, model), model_of(weft_, model)}};
      });
      shown.push_back(mean_of(predicted));
      sample.models.push_back({model, compare_pictures(shown.front(), shown.back(), view.mask, options)});
    }
    return sample;
  }

  static cv::Mat3f mean_of(const PictureHalves& halves) {
    cv::Mat3f mean;
    cv::addWeighted(halves[0], 0.5, halves[1], 0.5, 0, mean);
    return mean;
  }

  // Both renderings of a picture; those that are on the disk and were made from the same are read.
  PictureHalves pictures(const std::string& sample, const std::string& what, const SpoolToFit& warp, const View& view,
                         const std::function<Woven()>& cloth) {
    progress_.show(static_cast<int>(done_++), static_cast<int>(pictures_), sample + ", " + what);
    const std::string origin = origin_of(what, sample, warp);
    PictureHalves halves;
    std::optional<renderer::PathTracer> tracer;
    for (std::size_t half = 0; half < halves.size(); ++half) {
      if (interrupted()) throw std::runtime_error(kValidationStopped);
      const fs::path file = request_.out / "samples" / (sample + "-" + what + (half ? "-b.exr" : "-a.exr"));
      renderer::ImageHeader header;
      if (fs::exists(file)) halves[half] = renderer::read_exr(file, &header);
      if (header["threadstation/made_from"] == origin) continue;
      if (!tracer) {
        const Woven woven = cloth();
        renderer::Scene scene;
        if (view.transmission)
          scene.cloths.push_back({renderer::surface_of(swatch_.shape, woven.patch, swatch_.frame_from_swatch),
                                  woven.patch, woven.threads});
        else
          add_cloth_on_cylinder(scene, cylinder_, woven.patch, woven.threads);
        scene.lights.push_back(inversion::sphere_light(view.light));
        tracer.emplace(std::move(scene));
      }
      halves[half] = tracer->render(view.camera, {.samples_per_pixel = request_.samples_per_pixel,
                                                  .seed = request_.seed * 2 + half,
                                                  .only = view.mask,
                                                  .progress = [](double) { return !interrupted(); }});
      renderer::write_exr(file, halves[half], {{"threadstation/made_from", origin}});
    }
    return halves;
  }

  // A text of everything that a picture depends on.
  std::string origin_of(const std::string& what, const std::string& sample, const SpoolToFit& warp) const {
    std::string words = software_version() + "/" + what + "/" + sample;
    for (const fs::path& file : {request_.rig, warp.file, weft_.file}) words += read_json_file(file).dump();
    for (const fs::path& file : request_.drafts)
      if (sample.starts_with(file.stem().string() + "-")) words += read_json_file(file).dump();
    for (int number : {request_.samples_per_pixel, request_.photograph_samples, request_.width_px, request_.height_px})
      words += "/" + std::to_string(number);
    words += "/" + std::to_string(kReferenceYarns);
    if (what != kReference && what != kTrueFibers)  // fitted
      for (const int paths : request_.paths_per_block) words += "/" + std::to_string(paths);
    if (what == name_of(ModelKind::thread)) words += "/" + std::to_string(static_cast<int>(request_.exit));
    return words + "/" + std::to_string(request_.seed);
  }

  // The model of a spool's thread; the spool is photographed and fitted when first asked for.
  renderer::ScatteringModel model_of(const SpoolToFit& of, const std::string& model_name) {
    if (model_name == kTrueFibers) return true_bundle(of.spool);
    const std::string name = of.file.stem().string();
    const auto key = std::pair(name, model_name);
    if (const auto found = fits_.find(key); found != fits_.end()) return found->second;
    const auto named = [](ModelKind kind) { return std::string(name_of(kind)); };
    const ModelKind model = *std::ranges::find(request_.models, model_name, named);
    const auto step = [&](const std::string& what, double) {
      progress_.show(static_cast<int>(done_), static_cast<int>(pictures_), name + ": " + what);
    };
    if (!photographs_.contains(name))
      photographs_[name] = photograph_spool(rig_, of.spool,
                                            {.rig_file = request_.rig,
                                             .spool_file = of.file,
                                             .folder = request_.out / "spools" / name,
                                             .samples_per_pixel = request_.photograph_samples,
                                             .seed = request_.seed},
                                            step)
                               .views;
    inversion::FitOptions options{.model = model, .seed = request_.seed};
    options.start.exit = request_.exit;
    if (model == ModelKind::yarn) options.paths_per_block = {128, 512};
    if (!request_.paths_per_block.empty()) options.paths_per_block = request_.paths_per_block;
    options.progress = [&](const std::string& what, double share) {
      step(name_of(model) + ", " + what, share);
      return !interrupted();
    };
    return fits_[key] = inversion::fit_views(of.spool.wrapping, photographs_.at(name), options).model;
  }

  ValidateClothRequest request_;
  RigFile rig_;
  ProgressDisplay progress_;
  renderer::CylinderShape cylinder_{};
  BackLitSwatch swatch_;
  std::vector<SpoolToFit> warps_;
  SpoolToFit weft_;
  std::vector<std::pair<std::string, renderer::Draft>> drafts_;
  std::vector<View> views_;
  std::vector<std::string> models_;
  std::map<std::string, std::vector<View>> photographs_;
  std::map<std::pair<std::string, std::string>, renderer::ScatteringModel> fits_;  // by spool and model
  std::size_t pictures_ = 0, done_ = 0;
};

double percent_off(double brightness) {
  return 100 * (brightness - 1);
}

struct Summary {
  int pictures = 0;
  double delta_e = 0, off_percent = 0, most_percent = 0;  // sums over pictures and channels; the largest either way
};

// By model and by where the lamp stood.
std::map<std::string, Summary> summaries(const std::vector<PredictedSample>& samples) {
  std::map<std::string, Summary> sums;
  for (const PredictedSample& sample : samples) {
    const std::string lit = sample.side == "behind" ? ", lit from behind" : ", lit in front";
    Summary& noise = sums["noise of the reference" + lit];
    ++noise.pictures, noise.delta_e += sample.noise_delta_e;
    for (const PredictedSample::OfModel& of : sample.models) {
      Summary& sum = sums[shown_model(of.model) + lit];
      ++sum.pictures, sum.delta_e += of.comparison.mean_delta_e;
      for (const double brightness : of.comparison.brightness) {
        sum.off_percent += percent_off(brightness);
        sum.most_percent = std::max(sum.most_percent, std::abs(percent_off(brightness)));
      }
    }
  }
  return sums;
}

}  // namespace

renderer::YarnPatch with_fibers_of(const renderer::YarnPatch& patch, const std::vector<Spool>& spools) {
  std::vector<renderer::Strands> bundles;
  for (const renderer::Yarn& yarn : patch.yarns) {
    const Spool& spool = spools.at(static_cast<std::size_t>(yarn.thread));
    const SimulatedFibers& fibers = bundled_fibers(spool);
    const std::uint64_t seed = fibers.seed * kSeedsPerSpool + kFirstSeedOfCloth + bundles.size();
    const double scale = 2 * yarn.radius_mm / spool.wrapping.thread_diameter_mm;
    renderer::Strands& bundle =
        bundles.emplace_back(renderer::Strands{.radius_mm = scale * fibers.fiber_radius_mm,
                                               .places = fiber_centres(spool, seed * kFiberSeedStep, yarn.flatness)});
    for (Eigen::Vector2d& place : bundle.places) place *= scale;
  }
  return renderer::with_strands(patch, bundles);
}

std::vector<PredictedSample> validate_cloth(const ValidateClothRequest& request) {
  watch_interrupts();
  return Study(request).run();
}

std::string describe(const std::vector<PredictedSample>& samples) {
  std::string text =
      "CIEDE2000 of block averages, mean red, green and blue over the reference's (% off), and the highlight's column, "
      "width (px), height (of the reference's) and hue (deg)\n"
      "weave            warp                       lamp   model                mean  95 % below   red green  blue  "
      "column  width  height   hue\n";
  const auto add_line = [&](const PredictedSample& of, const std::string& what, double mean, double most,
                            const std::array<double, 3>& brightness, const HighlightProfile& highlight, double unit) {
    char line[200];
    std::snprintf(line, sizeof line,
                  "%-16s %-26s %-6s %-19s %5.2f  %10.2f %+5.1f %+5.1f %+5.1f  %6.0f %6.0f  %6.3f %5.0f\n",
                  of.weave.c_str(), of.warp.c_str(), of.side.c_str(), what.c_str(), mean, most,
                  percent_off(brightness[0]), percent_off(brightness[1]), percent_off(brightness[2]), highlight.peak_px,
                  highlight.width_px, highlight.peak / unit, highlight.hue_deg);
    text += line;
  };
  for (const PredictedSample& sample : samples) {
    if (sample.models.empty()) continue;
    const HighlightProfile& reference = sample.models.front().comparison.photograph;
    add_line(sample, "reference", sample.noise_delta_e, 0, {1, 1, 1}, reference, reference.peak);
    for (const PredictedSample::OfModel& of : sample.models)
      add_line(sample, shown_model(of.model), of.comparison.mean_delta_e, of.comparison.delta_e_95,
               of.comparison.brightness, of.comparison.rendering, reference.peak);
  }
  for (const auto& [what, sum] : summaries(samples)) {
    char line[200];
    std::snprintf(line, sizeof line, "%s: CIEDE2000 %.2f on average", what.c_str(), sum.delta_e / sum.pictures);
    text += line;
    if (sum.most_percent > 0) {
      std::snprintf(line, sizeof line, "; mean light %+.1f %% on average, %.1f %% at most",
                    sum.off_percent / (3 * sum.pictures), sum.most_percent);
      text += line;
    }
    text += "\n";
  }
  return text;
}

nlohmann::json to_json(const std::vector<PredictedSample>& samples) {
  nlohmann::json document = nlohmann::json::array();
  for (const PredictedSample& sample : samples) {
    nlohmann::json models = nlohmann::json::object();
    for (const PredictedSample::OfModel& of : sample.models) models[of.model] = to_json(of.comparison);
    document.push_back({{"weave", sample.weave},
                        {"warp", sample.warp},
                        {"lamp", sample.side},
                        {"block_px", sample.block_px},
                        {"noise_delta_e_2000", sample.noise_delta_e},
                        {"models", models}});
  }
  return {{"samples", document}};
}

}  // namespace station
