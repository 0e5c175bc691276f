#include "station/thread/report/thread_report.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "renderer/picture/image_file.h"
#include "station/documents/number_text.h"
#include "station/documents/thread_file.h"
#include "station/output/display.h"
#include "station/output/html.h"
#include "station/output/plot.h"
#include "station/session/results.h"
#include "station/thread/invert/invert_session.h"
#include "station/thread/report/fitted_twins.h"

namespace station {
namespace {

std::string parameter_table(const ThreadFile& thread) {
  const renderer::ThreadParameters& p = thread.parameters;
  return fact_table(
      {{"agreement with the photographs",
        number_text(100 * thread.fit.at("relative_rmse").get<double>(), 1) + " % relative RMSE over blocks of " +
            std::to_string(thread.fit.at("block_px").get<int>()) + " px, all views alike"},
       {"absorption sigma_a (R, G, B)",
        numbers_text({p.sigma_a[0], p.sigma_a[1], p.sigma_a[2]}, 3) + " per thread radius"},
       {"longitudinal roughness alpha (R, TT, TRT)", numbers_text({p.alpha[0], p.alpha[1], p.alpha[2]}, 3)},
       {"azimuthal roughness beta (R, TT, TRT)", numbers_text({p.beta[0], p.beta[1], p.beta[2]}, 3)},
       {"r0", numbers_text({p.r0a, p.r0b, p.r0c}, 3)},
       {"r1", number_text(p.r1a, 3)},
       {"r2", numbers_text({p.r2a, p.r2b, p.r2c}, 3)},
       {"thread diameter", number_text(thread.diameter_mm, 3) + " mm"}});
}

std::string energy_plot(const renderer::ThreadParameters& parameters) {
  constexpr int kSteps = 100;
  std::vector<PlotLine> lines{{"R: lambda_0", {}}, {"TT: lambda_1", {}}, {"TRT: lambda_2", {}}, {"sum", {}}};
  for (int i = 0; i <= kSteps; ++i) {
    const double c = static_cast<double>(i) / kSteps;
    const auto lambda = renderer::thread_lobe_energies<double>(parameters, c);
    for (std::size_t p = 0; p < 3; ++p) lines[p].points.emplace_back(c, lambda[p]);
    lines[3].points.emplace_back(c, lambda[0] + lambda[1] + lambda[2]);
  }
  return line_plot("cos theta", "scale factor", lines);
}

std::string figures_of(const nlohmann::json& fit, const std::string& id) {
  for (const nlohmann::json& view : fit.at("views"))
    if (view.at("id") == id)
      return "relative RMSE " + number_text(100 * view.at("relative_rmse").get<double>(), 1) + " %, bias " +
             number_text(100 * view.at("relative_bias").get<double>(), 1) + " %";
  return "not fitted";
}

std::string fitted_tile(const std::filesystem::path& session, const DevelopedView& developed, const ThreadFile& thread,
                        const std::array<double, 9>& colour) {
  const inversion::View& view = developed.view;
  const FittedTwins twins = read_twins(session, view);
  const auto shown = [&](const cv::Mat3f& picture, const std::string& what) {
    return embedded_image(display(picture, twins.scale, colour)(twins.box).clone(), view.id + " " + what);
  };
  return "<figure>" + shown(twins.photographed, "photographed") + shown(twins.fitted, "fitted") +
         shown(residual_picture(view, twins, thread.fit.at("block_px").get<int>()), "residual") + "<figcaption>" +
         escaped(view.id) + ": photographed, fitted, fitted minus photographed (grey is none)<br>" +
         figures_of(thread.fit, view.id) + "</figcaption></figure>\n";
}

cv::Mat3b fitted_into(const cv::Mat3b& picture, cv::Size size) {
  const double scale =
      std::min(static_cast<double>(size.width) / picture.cols, static_cast<double>(size.height) / picture.rows);
  cv::Mat3b small;
  cv::resize(picture, small, {cvRound(scale * picture.cols), cvRound(scale * picture.rows)}, 0, 0, cv::INTER_AREA);
  cv::Mat3b tile(size, cv::Vec3b(255, 255, 255));
  small.copyTo(tile(cv::Rect((size.width - small.cols) / 2, (size.height - small.rows) / 2, small.cols, small.rows)));
  return tile;
}

}  // namespace

std::string thread_section(const std::filesystem::path& session, const DevelopedViews& developed) {
  if (!std::filesystem::exists(thread_file_of(session))) return {};
  const ThreadFile thread = read_thread(thread_file_of(session));
  std::string doubts;
  if (const auto found = thread.fit.find("doubts"); found != thread.fit.end())
    for (const nlohmann::json& doubt : *found)
      doubts += "<p class=\"doubt\">Doubt: " + escaped(doubt.get<std::string>()) + "</p>\n";
  std::string html = "<h2>Thread</h2>\n" + doubts + parameter_table(thread) + energy_plot(thread.parameters) +
                     "\n<h2>Photographs and their fitted twins</h2>\n<div class=\"sheet\">\n";
  for (const DevelopedView& view : developed.views)
    html += fitted_tile(session, view, thread, developed.linear_srgb_from_camera);
  return html + "</div>\n";
}

std::string cloth_section(const std::filesystem::path& session, const DevelopedViews& developed) {
  std::string html;
  for (const std::filesystem::path& file : cloth_pictures(session))
    html += "<figure>" +
            embedded_image(display(renderer::read_exr(file), developed.linear_srgb_from_camera), file.stem().string()) +
            "<figcaption>" + escaped(file.stem().string()) + "</figcaption></figure>\n";
  return html.empty() ? html : "<h2>Predicted cloth</h2>\n<div class=\"sheet\">\n" + html + "</div>\n";
}

cv::Mat3b overview_picture(const std::filesystem::path& session, const DevelopedViews& developed) {
  const auto cloths = cloth_pictures(session);
  if (cloths.empty() || !std::filesystem::exists(thread_file_of(session))) return {};
  constexpr int kShown = 6, kTile_px = 111, kTileHeight_px = 74;
  cv::Mat3b left;
  for (std::size_t i = 0; i < developed.views.size(); i += std::max<std::size_t>(1, developed.views.size() / kShown)) {
    const FittedTwins twins = read_twins(session, developed.views[i].view);
    const auto tile = [&](const cv::Mat3f& picture) {
      return fitted_into(display(picture, twins.scale, developed.linear_srgb_from_camera)(twins.box),
                         {kTile_px, kTileHeight_px});
    };
    cv::Mat3b row;
    cv::hconcat(tile(twins.photographed), tile(twins.fitted), row);
    if (left.empty())
      left = row;
    else
      cv::vconcat(left, row, left);
  }
  cv::Mat3b sheet = left;
  for (const std::filesystem::path& file : cloths) {
    const cv::Mat3b cloth = display(renderer::read_exr(file), developed.linear_srgb_from_camera);
    cv::hconcat(sheet, fitted_into(cloth, {left.rows * cloth.cols / cloth.rows, left.rows}), sheet);
  }
  return sheet;
}

}  // namespace station
