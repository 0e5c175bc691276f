#include "station/bench/calibrate/calibration_report.h"

#include <cmath>
#include <limits>

#include "station/bench/calibrate/error_budget.h"
#include "station/documents/degree.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/output/html.h"
#include "station/output/plot.h"

namespace station {
namespace {

std::string position_text(const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance) {
  std::string text;
  for (int i = 0; i < 3; ++i)
    text += (i ? ", " : "") + number_text(position[i], 1) + " ± " + number_text(std::sqrt(covariance(i, i)), 1);
  return text + " mm";
}

std::string facts(const RigCalibration& calibration) {
  const calibration::Lens& lens = calibration.lens.lens;
  const calibration::PlatformFit& platform = calibration.platform;
  const calibration::LightFit& light = calibration.light;
  const Eigen::Vector3d camera = platform.world_from_camera.translation();
  std::vector<std::pair<std::string, std::string>> rows{
      {"made", calibration.utc + " on " + calibration.rig_name},
      {"valid for", calibration.camera.model + " " + calibration.camera.serial + ", " + calibration.camera.lens + ", " +
                        calibration.camera.focus + ", f/" + number_text(calibration.camera.f_number, 1)},
      {"lens", "f " + number_text(lens.fx_px, 1) + " / " + number_text(lens.fy_px, 1) + " px, rms " +
                   number_text(calibration.lens.rms_px, 3) + " px over " +
                   std::to_string(calibration.lens.corners_used) + " corners"},
      {"camera in the world", numbers_text({camera.x(), camera.y(), camera.z()}, 1) + " mm"},
      {"platform", "angles " + number_text(platform.angle_rms_rad / kDegree, 4) + "° rms about " +
                       number_text(platform.scale, 5) + " × the reading; rms " + number_text(platform.rms_px, 3) +
                       " px"},
      {"lamp in front", position_text(light.positions[0], light.position_covariances[0])},
      {"lamp behind", position_text(light.positions[1], light.position_covariances[1])},
      {"lamp intensity (R, G, B)", numbers_text({light.intensity[0], light.intensity[1], light.intensity[2]}, 0) +
                                       " (radiance unit × mm²), beam cos^" + number_text(light.beam_exponent, 2)},
      {"Spectralon residual", number_text(100 * light.relative_rms, 2) + " % rms"}};
  if (calibration.sensor)
    rows.emplace_back("sensor", number_text(calibration.sensor->response.gain_dn_per_e, 4) + " DN/e, read noise " +
                                    number_text(calibration.sensor->response.read_noise_e, 2) + " e");
  return fact_table(rows);
}

std::string gate_table(const std::vector<calibration::Gate>& gates) {
  std::string rows;
  for (const calibration::Gate& gate : gates) {
    char numbers[80];
    std::snprintf(numbers, sizeof numbers, "%.4g (limit %.4g)", gate.value, gate.limit);
    rows += std::string("<tr><td>") + (gate.passed ? "passed" : "<strong>FAILED</strong>") + "</td><th>" +
            escaped(gate.name) + "</th><td>" + numbers + "</td><td>" + (gate.passed ? "" : escaped(gate.reason)) +
            "</td></tr>\n";
  }
  return "<table>\n" + rows + "</table>\n";
}

std::string budget_table(const RigCalibration& calibration) {
  const std::vector<ErrorShare> front = error_budget(calibration, false), back = error_budget(calibration, true);
  std::string rows = "<tr><th>source</th><th>lamp in front</th><th>lamp behind</th></tr>\n";
  for (std::size_t i = 0; i < front.size(); ++i)
    rows += "<tr><th>" + escaped(front[i].source) + "</th><td>" + number_text(100 * front[i].relative, 3) +
            " %</td><td>" + number_text(100 * back[i].relative, 3) + " %</td></tr>\n";
  return "<table>\n" + rows + "</table>\n";
}

// Each used corner of the board where it was seen, and a line of its error, enlarged; the field that they cover.
PlotPanel corner_panel(const calibration::LensFit& fit) {
  constexpr double kEnlarged = 300.0;
  const double gap = std::numeric_limits<double>::quiet_NaN();
  const double height = fit.lens.height_px;
  PlotPanel panel{.title = "lens: corners seen, errors x " + number_text(kEnlarged, 0),
                  .x_label = "column, px",
                  .y_label = "row from below, px",
                  .lines = {},
                  .circles = {},
                  .x_range = std::pair(0.0, static_cast<double>(fit.lens.width_px)),
                  .y_range = std::pair(0.0, height)};
  PlotLine seen{.title = "seen", .points = {}, .style = PlotStyle::points};
  PlotLine errors{.title = "error", .points = {}};
  for (const calibration::CornerError& error : fit.corner_errors) {
    if (!error.used) continue;
    const Eigen::Vector2d at = error.corner.pixel, to = at + kEnlarged * error.error_px;
    seen.points.emplace_back(at.x(), height - at.y());
    errors.points.insert(errors.points.end(), {{at.x(), height - at.y()}, {to.x(), height - to.y()}, {gap, gap}});
  }
  panel.lines = {seen, errors};
  return panel;
}

// Along three rows of the picture: how far a projection may be off.
PlotPanel uncertainty_panel(const calibration::LensFit& fit) {
  PlotPanel panel{.title = "lens: uncertainty of projections at " + number_text(fit.working_distance_mm, 0) + " mm",
                  .x_label = "column, px",
                  .y_label = "1 sigma, px",
                  .lines = {},
                  .circles = {}};
  const Eigen::Index last_row = fit.projection_sigma_px.rows() - 1, columns = fit.projection_sigma_px.cols();
  for (const auto& [name, row] :
       {std::pair<std::string, Eigen::Index>{"top", 0}, {"middle", last_row / 2}, {"bottom", last_row}}) {
    if (row < 0) continue;
    PlotLine line{.title = name, .points = {}};
    for (Eigen::Index c = 0; c < columns; ++c)
      line.points.emplace_back((fit.lens.width_px - 1) * static_cast<double>(c) / static_cast<double>(columns - 1),
                               fit.projection_sigma_px(row, c));
    panel.lines.push_back(line);
  }
  return panel;
}

PlotPanel angle_panel(const calibration::PlatformFit& fit) {
  PlotPanel panel{.title = "platform: measured angle less the straight line",
                  .x_label = "reading, deg",
                  .y_label = "deg",
                  .lines = {},
                  .circles = {},
                  .x_range = std::nullopt,
                  .y_range = std::nullopt};
  PlotLine line{.title = "turning pictures", .points = {}, .style = PlotStyle::points};
  double largest = 0.005;
  for (std::size_t i = 0; i < fit.angles_rad.size(); ++i) {
    const double off_deg = (fit.angles_rad[i] - fit.scale * fit.readings_rad[i]) / kDegree;
    line.points.emplace_back(fit.readings_rad[i] / kDegree, off_deg);
    largest = std::max(largest, 1.2 * std::abs(off_deg));
  }
  panel.lines = {line};
  panel.y_range = std::pair(-largest, largest);
  return panel;
}

PlotPanel light_panel(const calibration::LightFit& fit) {
  PlotPanel panel{.title = "light: pictures of the panel predicted without them",
                  .x_label = "picture",
                  .y_label = "error, %",
                  .lines = {},
                  .circles = {},
                  .x_range = std::nullopt,
                  .y_range = std::nullopt};
  PlotLine front{.title = "lamp in front", .points = {}, .style = PlotStyle::points}, back = front;
  back.title = "lamp behind";
  double largest = 0.1;
  for (const calibration::HeldOutPicture& held : fit.held_out) {
    PlotLine& line = held.light == 0 ? front : back;
    line.points.emplace_back(static_cast<double>(line.points.size() + 1), 100 * held.picture_error);
    largest = std::max(largest, 120 * std::abs(held.picture_error));
  }
  panel.lines = {front, back};
  panel.y_range = std::pair(-largest, largest);
  return panel;
}

}  // namespace

std::string calibration_section(const RigCalibration& calibration) {
  const PlotSheet sheet{.panels = {corner_panel(calibration.lens), uncertainty_panel(calibration.lens),
                                   angle_panel(calibration.platform), light_panel(calibration.light)},
                        .columns = 2,
                        .panel_width_px = 560,
                        .panel_height_px = 380,
                        .key_outside = false};
  return facts(calibration) + "<h3>Is it good enough?</h3>\n" + gate_table(all_gates(calibration)) +
         "<h3>Error of a radiance at the spool, one standard deviation</h3>\n" + budget_table(calibration) +
         draw(sheet, PlotFormat::svg);
}

std::filesystem::path write_calibration_page(const std::filesystem::path& folder, const RigCalibration& calibration) {
  const std::filesystem::path file = folder / "calibration.html";
  write_text_file(file, html_page("Calibration of " + calibration.rig_name, calibration_section(calibration)));
  return file;
}

}  // namespace station
