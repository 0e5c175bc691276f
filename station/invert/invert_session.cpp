#include "station/invert/invert_session.h"

#include <stdexcept>

#include "renderer/image_file.h"
#include "station/capture/stored_file.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/documents/views_file.h"
#include "station/interrupt.h"
#include "station/report/html.h"

namespace station {
namespace {

using nlohmann::json;

constexpr std::uint64_t kViewSeed = 424242;  // of the fitted views: paths that the fit has not seen
constexpr double kFitShare = 0.6;            // of the progress bar; the fitted views take the rest

json fit_json(const inversion::ViewFit& fit, const InvertRequest& request, const InvertResult& result) {
  json rounds = json::array(), views = json::array(), held = json::array();
  for (const inversion::FitRound& round : fit.rounds)
    rounds.push_back({{"paths_per_block", round.paths_per_block},
                      {"steps", round.steps},
                      {"loss_before", round.loss_before},
                      {"loss_after", round.loss_after},
                      {"converged", round.converged}});
  for (const FittedView& view : result.views)
    views.push_back({{"id", view.id},
                     {"relative_rmse", view.agreement.relative_rmse()},
                     {"relative_bias", view.agreement.relative_bias},
                     {"mean_over_diffuser", view.agreement.mean_reference}});
  for (inversion::ParameterGroup group : request.fit.held) held.push_back(name_of(group));
  return {{"model", "thread"},
          {"solver", "lm"},
          {"seed", request.fit.seed},
          {"held", held},
          {"block_px", fit.block_px},
          {"blocks", fit.blocks},
          {"start", fit.start},
          {"rounds", rounds},
          {"relative_rmse", result.relative_rmse},
          {"samples_per_pixel", request.samples_per_pixel},
          {"views", views}};
}

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

// Renders one view with the fitted thread, compares it, and writes both pictures.
FittedView write_fitted_view(const InvertRequest& request, const inversion::WrappedSpool& spool,
                             const inversion::View& view, const inversion::ViewFit& fit, std::uint64_t seed) {
  const cv::Mat3f fitted = inversion::fitted_view(spool, view, fit.thread(), request.samples_per_pixel, seed,
                                                  [](double) { return !interrupted(); });
  cv::Mat3f residual(fitted.size(), cv::Vec3f(0, 0, 0));
  cv::subtract(fitted, view.image, residual, view.mask);
  renderer::ImageHeader header{{"threadstation/view", view.id},
                               {"threadstation/samples_per_pixel", std::to_string(request.samples_per_pixel)}};
  std::string& content = header["threadstation/content"];
  content = "linear camera RGB, radiance unit; rendered with the fitted thread inside the mask";
  renderer::write_exr(fitted_file_of(request.session, view.id), fitted, header);
  content = "linear camera RGB, radiance unit; fitted minus photographed inside the mask";
  renderer::write_exr(request.session / "result" / "residual" / (view.id + ".exr"), residual, header);
  return {.id = view.id, .agreement = inversion::agreement(view, fitted, fit.block_px)};
}

// Before the work, not after it: what cannot be written is found out now.
void prepare_results(const InvertRequest& request) {
  FileSystem disk;
  if (request.out) check_can_store(disk, *request.out);
  for (const char* name : {"fitted", "residual"}) {
    const std::filesystem::path folder = request.session / "result" / name;
    std::error_code code;
    std::filesystem::create_directories(folder, code);
    if (code)
      throw std::runtime_error("cannot make " + folder.string() + ": " + code.message() +
                               "; is the session's folder writable?");
  }
  check_can_store(disk, thread_file_of(request.session));
}

}  // namespace

std::filesystem::path thread_file_of(const std::filesystem::path& session) {
  return session / "result" / "thread.json";
}

std::filesystem::path fitted_file_of(const std::filesystem::path& session, const std::string& view) {
  return session / "result" / "fitted" / (view + ".exr");
}

InvertResult invert_session(const InvertRequest& request) {
  watch_interrupts();
  const SessionFile asked = read_session_file(request.session);
  DevelopedViews developed = read_views(request.session);
  read_view_pictures(request.session, developed);
  std::vector<inversion::View> views;
  for (const DevelopedView& view : developed.views) views.push_back(view.view);

  prepare_results(request);
  ProgressDisplay progress("invert", request.progress_style);
  inversion::FitOptions options = request.fit;
  int shown = -1;
  options.progress = [&](const std::string& what, double share) {
    const int percent = static_cast<int>(100 * kFitShare * share);
    if (percent / 5 != shown / 5 || shown < 0) progress.show(shown = percent, 100, what);
    return !interrupted();
  };
  const inversion::ViewFit fit = inversion::fit_views(asked.spool.wrapping, views, options);

  InvertResult result;
  std::filesystem::remove(thread_file_of(request.session));  // it no longer belongs to the pictures beside it
  std::vector<inversion::ViewAgreement> agreements;
  for (const inversion::View& view : views) {
    const double share = static_cast<double>(result.views.size()) / static_cast<double>(views.size());
    progress.show(static_cast<int>(100 * (kFitShare + (1 - kFitShare) * share)), 100, "view " + view.id);
    result.views.push_back(
        write_fitted_view(request, asked.spool.wrapping, view, fit, kViewSeed + result.views.size()));
    agreements.push_back(result.views.back().agreement);
  }
  result.relative_rmse = inversion::overall_relative_rmse(agreements);
  result.thread.name = asked.spool.name;
  result.thread.diameter_mm = asked.spool.wrapping.thread_diameter_mm;
  result.thread.parameters = fit.thread();
  result.thread.linear_srgb_from_camera = developed.linear_srgb_from_camera;
  result.thread.fit = fit_json(fit, request, result);
  result.thread.provenance = provenance_json(request.session, asked);
  result.thread_file = thread_file_of(request.session);
  write_json_file(result.thread_file, to_json(result.thread));
  if (request.out) write_json_file(*request.out, to_json(result.thread));
  progress.finish("relative RMSE " + number_text(100 * result.relative_rmse, 1) + " %");
  return result;
}

std::string describe(const InvertResult& result) {
  std::string text;
  for (const FittedView& view : result.views)
    text += view.id + ": relative RMSE " + number_text(100 * view.agreement.relative_rmse(), 1) + " %, bias " +
            number_text(100 * view.agreement.relative_bias, 1) + " %\n";
  const renderer::ThreadParameters& p = result.thread.parameters;
  text += "overall: relative RMSE " + number_text(100 * result.relative_rmse, 1) + " %\n";
  text += "sigma_a " + numbers_text({p.sigma_a[0], p.sigma_a[1], p.sigma_a[2]}, 3) + " per thread radius (R G B)\n";
  text += "alpha   " + numbers_text({p.alpha[0], p.alpha[1], p.alpha[2]}, 3) + " (R TT TRT)\n";
  text += "beta    " + numbers_text({p.beta[0], p.beta[1], p.beta[2]}, 3) + "\n";
  text += "r0 " + numbers_text({p.r0a, p.r0b, p.r0c}, 3) + "   r1 " + number_text(p.r1a, 3) + "   r2 " +
          numbers_text({p.r2a, p.r2b, p.r2c}, 3) + "\n";
  return text + "thread  " + result.thread_file.string() + "\n";
}

json to_json(const InvertResult& result) {
  return {{"thread", result.thread_file},
          {"relative_rmse", result.relative_rmse},
          {"parameters", to_json(result.thread).at("parameters")},
          {"fit", result.thread.fit}};
}

}  // namespace station
