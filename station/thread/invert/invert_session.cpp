#include "station/thread/invert/invert_session.h"

#include <cmath>
#include <stdexcept>

#include "inversion/fit/fit_doubts.h"
#include "inversion/view/irregularity.h"
#include "renderer/picture/image_file.h"
#include "station/documents/bundle_file.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/fiber_file.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/documents/views_file.h"
#include "station/documents/yarn_file.h"
#include "station/output/interrupt.h"
#include "station/session/results.h"
#include "station/thread/invert/held_out_views.h"

namespace station {
namespace {

using nlohmann::json;

constexpr std::uint64_t kViewSeed = 424242;    // of the fitted views: paths that the fit has not seen
constexpr std::uint64_t kShadedSeed = 515151;  // of the same with uneven shades
constexpr double kFitShare = 0.6;              // of the progress bar; the fitted views take the rest

json provenance_json(const std::filesystem::path& session, const SessionFile& asked) {
  const std::filesystem::path folder = std::filesystem::absolute(session).lexically_normal();
  return {{"session", (folder.has_filename() ? folder : folder.parent_path()).filename().string()},
          {"captured", asked.utc},
          {"captured_by", asked.software},
          {"fitted_by", software_version()},
          {"rig", asked.rig.name},
          {"spool", asked.spool.name},
          {"material", asked.spool.material},
          {"thread_diameter_mm", asked.spool.wrapping.thread_diameter_mm},
          {"paper", "Xia et al. 2025, Predicting Fabric Appearance Through Thread Scattering and Inversion"}};
}

std::filesystem::path folder_of(const InvertRequest& request) {
  return results_of(request.session, name_of(request.fit.model));
}

std::filesystem::path model_file(const InvertRequest& request) {
  return model_file_of(request.session, name_of(request.fit.model));
}

// The document of a fitted model; a thread's and a bundle's say what they were fitted to as well.
struct ModelDocument {
  const SessionFile& asked;
  const DevelopedViews& developed;
  const json &fit_part, &provenance;

  json operator()(const renderer::FiberParameters& fiber) const { return to_json(fiber); }
  json operator()(const renderer::YarnParameters& yarn) const { return to_json(yarn); }
  json operator()(const renderer::ThreadParameters& thread) const { return to_json(digitized(thread)); }
  json operator()(const renderer::BundleParameters& bundle) const { return to_json(digitized(bundle)); }

  template <class Parameters>
  DigitizedThread<Parameters> digitized(const Parameters& parameters) const {
    return {.name = asked.spool.name,
            .diameter_mm = asked.spool.wrapping.thread_diameter_mm,
            .parameters = parameters,
            .linear_srgb_from_camera = developed.linear_srgb_from_camera,
            .fit = fit_part,
            .provenance = provenance};
  }
};

// Renders one view with the fitted thread into `fitted`, compares it, and writes both pictures.
FittedView write_fitted_view(const InvertRequest& request, const inversion::WrappedSpool& spool,
                             const inversion::View& view, const inversion::ViewFit& fit, std::uint64_t seed,
                             cv::Mat3f& fitted) {
  fitted = inversion::fitted_view(spool, view, fit.model, request.samples_per_pixel, seed,
                                  [](double) { return !interrupted(); });
  cv::Mat3f residual(fitted.size(), cv::Vec3f(0, 0, 0));
  cv::subtract(fitted, view.image, residual, view.mask);
  renderer::ImageHeader header{{"threadstation/view", view.id},
                               {"threadstation/samples_per_pixel", std::to_string(request.samples_per_pixel)}};
  std::string& content = header["threadstation/content"];
  content = "linear camera RGB, radiance unit; rendered with the fitted thread inside the mask";
  renderer::write_exr(fitted_file_of(request.session, view.id, name_of(request.fit.model)), fitted, header);
  content = "linear camera RGB, radiance unit; fitted minus photographed inside the mask";
  renderer::write_exr(folder_of(request) / "residual" / (view.id + ".exr"), residual, header);
  return {
      .id = view.id, .transmission = view.transmission, .agreement = inversion::agreement(view, fitted, fit.block_px)};
}

// By how much the brightness of a view falls with the absorption: of its logarithm for each unit of the other's.
Eigen::Array3d darkening_of(const inversion::WrappedSpool& spool, const inversion::View& view,
                            const renderer::ThreadParameters& thread, int samples_per_pixel) {
  constexpr double kMore = 1.1;
  std::array<Eigen::Array3d, 2> light;
  for (std::size_t i = 0; i < 2; ++i) {
    renderer::ThreadParameters changed = thread;
    changed.sigma_a *= i == 0 ? kMore : 1 / kMore;
    const cv::Scalar mean =
        cv::mean(inversion::fitted_view(spool, view, changed, samples_per_pixel, kViewSeed), view.mask);
    light.at(i) = Eigen::Array3d(mean[0], mean[1], mean[2]);
  }
  const Eigen::Array3d darkening = (light[1] / light[0]).log() / (2 * std::log(kMore));
  return darkening.isFinite().select(darkening, 0);  // a colour without light tells nothing
}

json to_json(const std::optional<inversion::Deviation>& deviation) {
  if (!deviation) return nullptr;
  return {{"value", deviation->value}, {"sigma", deviation->sigma}};
}

// How uneven the thread is, by its photographs and their fitted twins.
json irregularity_json(const InvertRequest& request, const inversion::WrappedSpool& spool,
                       const std::vector<inversion::View>& views, const std::vector<cv::Mat3f>& fitted,
                       const renderer::ThreadParameters& thread) {
  const auto reflected = std::ranges::find(views, false, &inversion::View::transmission);
  if (reflected == views.end()) return nullptr;
  const int samples = std::max(1, request.samples_per_pixel / 4);
  const inversion::Irregularity found = inversion::measure_irregularity(
      spool, views,
      {.even = fitted,
       .darkening = darkening_of(spool, *reflected, thread, samples),
       .shaded = [&](std::size_t view, const std::vector<double>& shades) {
         return inversion::fitted_view(spool, views[view], inversion::shaded_threads(spool, thread, shades), samples,
                                       kShadedSeed + view, [](double) { return !interrupted(); });
       }});
  if (!found.brightness) return nullptr;
  return {{"brightness", to_json(found.brightness)},
          {"shade", to_json(found.shade)},
          {"diameter", to_json(found.diameter)},
          {"length_mm", found.length_mm}};
}

// Makes the folders of the results before the work, and finds out then what cannot be written.
void prepare_results(const InvertRequest& request) {
  FileSystem disk;
  if (request.out) check_can_store(disk, *request.out);
  for (const char* name : {"fitted", "residual"}) {
    const std::filesystem::path folder = folder_of(request) / name;
    std::error_code code;
    std::filesystem::create_directories(folder, code);
    if (code)
      throw std::runtime_error("cannot make " + folder.string() + ": " + code.message() +
                               "; is the session's folder writable?");
  }
  check_can_store(disk, model_file(request));
}

}  // namespace

InvertResult invert_session(const InvertRequest& request) {
  watch_interrupts();
  const SessionFile asked = read_session_file(request.session);
  if (asked.spool.fabric)
    throw std::runtime_error(request.session.string() + " shows a cloth on the cylinder (" + asked.spool.name +
                             "), and threads are fitted to wrapped ones; use predict, or give a spool's session");
  DevelopedViews developed = read_views(request.session);
  read_view_pictures(request.session, developed);
  std::vector<inversion::View> views;
  for (const DevelopedView& view : developed.views) views.push_back(view.view);
  const std::vector<bool> held_out = held_out_views(developed.views, request.held_out);
  std::vector<inversion::View> seen;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (!held_out[i]) seen.push_back(views[i]);

  prepare_results(request);
  ProgressDisplay progress("invert", request.progress_style);
  inversion::FitOptions options = request.fit;
  int shown = -1;
  options.progress = [&](const std::string& what, double share) {
    const int percent = static_cast<int>(100 * kFitShare * share);
    if (percent / 5 != shown / 5 || shown < 0) progress.show(shown = percent, 100, what);
    return !interrupted();
  };
  const inversion::ViewFit fit = inversion::fit_views(asked.spool.wrapping, seen, options);

  InvertResult result{.model = fit.model, .file = model_file(request)};
  std::filesystem::remove(result.file);  // it no longer belongs to the pictures beside it
  std::vector<cv::Mat3f> fitted(views.size());
  for (const inversion::View& view : views) {
    const double share = static_cast<double>(result.views.size()) / static_cast<double>(views.size());
    progress.show(static_cast<int>(100 * (kFitShare + (1 - kFitShare) * share)), 100, "view " + view.id);
    result.views.push_back(write_fitted_view(request, asked.spool.wrapping, view, fit, kViewSeed + result.views.size(),
                                             fitted[result.views.size()]));
    result.views.back().held_out = held_out[result.views.size() - 1];
  }
  result.fit = fit_document(fit, request.fit, result.views, request.samples_per_pixel);
  result.relative_rmse = result.fit.at("relative_rmse");
  result.doubts = inversion::fit_doubts(seen, fit, agreements_of(result.views, false));
  result.fit["doubts"] = result.doubts;
  if (const auto* thread = std::get_if<renderer::ThreadParameters>(&fit.model))
    result.fit["irregularity"] = irregularity_json(request, asked.spool.wrapping, views, fitted, *thread);
  const json provenance = provenance_json(request.session, asked);
  const json document = std::visit(ModelDocument{asked, developed, result.fit, provenance}, fit.model);
  write_json_file(result.file, document);
  if (request.fit.model != inversion::ModelKind::thread)
    write_json_file(baseline_fit_of(request.session, name_of(request.fit.model)), result.fit);
  if (request.out) write_json_file(*request.out, document);
  progress.finish("relative RMSE " + number_text(100 * result.relative_rmse, 1) + " %");
  return result;
}

namespace {

// The unknowns from `first` on with their deviations: "0.512 +- 0.013".
std::string uncertain_text(const json& unknowns, std::size_t first, std::size_t count) {
  std::string text;
  for (std::size_t k = first; k < first + count; ++k) {
    const json& unknown = unknowns.at(k);
    const double sigma = unknown.at("sigma");
    text += (k > first ? ", " : "") + number_text(unknown.at("value"), 3) +
            (sigma > 0 ? " +- " + number_text(sigma, 3) : std::string(" (held)")) +
            (unknown.at("at_bound").get<bool>() ? " (at its bound)" : "");
  }
  return text;
}

std::string thread_text(const renderer::ThreadParameters& p, const json& fit) {
  const json& unknowns = fit.at("certainty").at("unknowns");
  std::string text = "sigma_a " + uncertain_text(unknowns, 0, 3) + " per thread radius (R G B)\n";
  text += "alpha   " + uncertain_text(unknowns, 3, 3) + " (R TT TRT)\n";
  text += "beta    " + uncertain_text(unknowns, 6, 3) + "\n";
  text += "r0 " + numbers_text({p.r0a, p.r0b, p.r0c}, 3) + "   r1 " + number_text(p.r1a, 3) + "   r2 " +
          numbers_text({p.r2a, p.r2b, p.r2c}, 3) + "\n";
  for (const json& band : fit.value("bands", json::array()))
    if (const double c = band.at("cosine"); c > 0.55 && std::lround(10 * c) % 2 == 0)
      text += "energies at cos theta " + number_text(c, 1) + ": R " + number_text(band.at("lambda")[0], 3) + " +- " +
              number_text(band.at("sigma")[0], 3) + ", TT " + number_text(band.at("lambda")[1], 3) + " +- " +
              number_text(band.at("sigma")[1], 3) + ", TRT " + number_text(band.at("lambda")[2], 3) + " +- " +
              number_text(band.at("sigma")[2], 3) + "\n";
  return text;
}

std::string irregularity_text(const json& fit) {
  const json found = fit.value("irregularity", json());
  if (!found.is_object()) return "";
  std::string text = "uneven along the thread:";
  for (const char* what : {"brightness", "shade", "diameter"})
    if (const json& one = found.at(what); one.is_object())
      text += std::string(text.back() == ':' ? " " : ", ") + what + " " +
              number_text(100 * one.at("value").get<double>(), 1) + " +- " +
              number_text(100 * one.at("sigma").get<double>(), 1) + " %";
  return text + ", alike over " + number_text(found.at("length_mm"), 0) + " mm\n";
}

std::string baseline_text(const json& fit) {
  std::string text;
  if (fit.contains("fiber_count")) text += "fibers  " + std::to_string(fit.at("fiber_count").get<int>()) + "\n";
  const json& unknowns = fit.at("certainty").at("unknowns");
  for (std::size_t k = 0; k < unknowns.size(); ++k)
    text += unknowns.at(k).at("name").get<std::string>() + "  " + uncertain_text(unknowns, k, 1) + "\n";
  return text;
}

}  // namespace

std::string describe(const InvertResult& result) {
  std::string text;
  for (const FittedView& view : result.views)
    text += view.id + (view.held_out ? " (held out)" : "") + ": relative RMSE " +
            number_text(100 * view.agreement.relative_rmse(), 1) + " %, bias " +
            number_text(100 * view.agreement.relative_bias, 1) + " %\n";
  text += "overall: relative RMSE " + number_text(100 * result.relative_rmse, 1) + " %";
  for (const char* part : {"reflection", "transmission"})
    if (const auto found = result.fit.find(std::string("relative_rmse_") + part); found != result.fit.end())
      text += std::string(", ") + part + " " + number_text(100 * found->get<double>(), 1) + " %";
  text += "\n";
  if (const auto found = result.fit.find("relative_rmse_held_out"); found != result.fit.end())
    text += "held out: relative RMSE " + number_text(100 * found->get<double>(), 1) +
            " %, views that the fit has not seen\n";
  if (const auto* thread = std::get_if<renderer::ThreadParameters>(&result.model))
    text += thread_text(*thread, result.fit);
  else
    text += baseline_text(result.fit);
  text += irregularity_text(result.fit);
  for (const std::string& doubt : result.doubts) text += "doubt: " + doubt + "\n";
  return text + result.fit.at("model").get<std::string>() + "  " + result.file.string() + "\n";
}

json to_json(const InvertResult& result) {
  json document{{"model", result.fit.at("model")}, {"relative_rmse", result.relative_rmse}, {"fit", result.fit}};
  document[result.fit.at("model").get<std::string>()] = result.file;
  document["parameters"] = read_json_file(result.file);
  if (document["parameters"].contains("parameters")) document["parameters"] = document["parameters"]["parameters"];
  return document;
}

}  // namespace station
