#include "station/thread/scatter/plot_scattering.h"

#include <cmath>

#include "renderer/scattering/azimuthal_profile.h"
#include "renderer/scattering/lobes.h"
#include "station/documents/degree.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/output/plot.h"
#include "station/thread/scatter/fit_distributions.h"
#include "station/thread/scatter/simulate.h"

namespace station {
namespace {

using renderer::MultiFiberOptions;
constexpr double kThetasDeg[] = {0, 15, 30, 45, 60, 70, 75, 80};
constexpr std::size_t kShownThetas[] = {0, 3, 5, 7};  // of them, in figure 5
constexpr double kRadiusRatios[] = {0.2, 0.1, 0.05};  // fiber / thread, in figure 3
const char* const kAzimuthLabel = "phi (degrees; 0 = back)";
const char* const kLobeNames[] = {"R", "TT", "TRT"};

template <class Density>
PlotLine azimuth_line(const std::string& title, const Density& density, PlotStyle style = PlotStyle::line,
                      int color = 0) {
  PlotLine line{.title = title, .style = style, .color = color};
  const auto bins = static_cast<double>(density.size());
  double phi_deg = -180 + 180 / bins;
  for (double value : density) {
    line.points.emplace_back(phi_deg, value);
    phi_deg += 360 / bins;
  }
  return line;
}

PlotPanel azimuth_panel(const std::string& title) {
  return {.title = title, .x_label = kAzimuthLabel, .y_label = "per radian", .x_range = std::pair{-180.0, 180.0}};
}

// The options at another radius ratio, with attempts enough to fill the section as densely whatever the fibers' size,
// and a gap in proportion to it.
MultiFiberOptions with_ratio(MultiFiberOptions options, double ratio) {
  const double scale = ratio * options.thread_radius / options.fiber_radius;
  options.fiber_radius *= scale;
  options.min_gap *= scale;
  options.max_attempts = std::max(1, static_cast<int>(options.max_attempts / (scale * scale)));
  return options;
}

PlotSheet figure_3(const ScatterPlotRequest& request) {
  PlotPanel section{.title = "one configuration"};
  section.circles.push_back({0, 0, request.options.thread_radius, false});
  for (const Eigen::Vector2d& center : renderer::fiber_configuration(request.options, 0))
    section.circles.push_back({center.x(), center.y(), request.options.fiber_radius});
  PlotPanel panel = azimuth_panel("one circle and many, theta = 0");
  Eigen::ArrayXd single = Eigen::ArrayXd::Zero(request.options.bins);
  for (int p = 0; p < 8; ++p) single += renderer::smooth_fiber_lobe(p, 0, request.options.eta, 0, request.options.bins);
  panel.lines.push_back(azimuth_line("one circle", single));
  for (double ratio : kRadiusRatios) {
    const std::string title = formatted("r = %g R", ratio);
    panel.lines.push_back(azimuth_line(
        title,
        simulate_with_progress(with_ratio(request.options, ratio), "simulate " + title, request.progress).density));
  }
  return {
      .panels = {section, panel}, .columns = 2, .panel_width_px = 560, .panel_height_px = 480, .key_outside = false};
}

PlotSheet figure_4(const ScatterPlotRequest& request, const DistributionFits& fits) {
  PlotPanel lobes = azimuth_panel("lobes of one circle, theta = 0");
  for (int p = 0; p < 3; ++p)
    lobes.lines.push_back(
        azimuth_line(kLobeNames[p], renderer::smooth_fiber_lobe(p, 0, request.options.eta, 0, request.options.bins)));
  PlotPanel scales{.title = "scale factors: points each angle, lines eq. 5 jointly",
                   .x_label = "cos theta",
                   .y_label = "lambda",
                   .x_range = std::pair{0.0, 1.0},
                   .y_range = std::pair{0.0, 0.8}};
  constexpr int kSteps = 100;
  for (std::size_t p = 0; p < 3; ++p) {
    const int color = static_cast<int>(p) + 1;
    const std::string name = "lambda_" + std::to_string(p) + " (" + kLobeNames[p] + ")";
    PlotLine points{.style = PlotStyle::points, .color = color}, curve{.title = name, .color = color};
    for (std::size_t i = 0; i < fits.separate.size(); ++i)
      points.points.emplace_back(std::cos(fits.distributions[i].data.theta_rad), fits.separate[i].thread.lambda[p]);
    renderer::ThreadParameters joint = fits.by_absorption.front().thread.parameters;
    joint.limit_energy = false;
    for (int k = 0; k <= kSteps; ++k) {
      const double c = static_cast<double>(k) / kSteps;
      const auto lambda = renderer::thread_lobe_energies<double>(joint, c);
      curve.points.emplace_back(c, lambda[p]);
    }
    scales.lines.push_back(points);
    scales.lines.push_back(curve);
  }
  return {.panels = {lobes, scales}, .columns = 2, .panel_width_px = 560, .panel_height_px = 420, .key_outside = false};
}

PlotSheet figure_5(const DistributionFits& fits) {
  PlotSheet sheet{.columns = static_cast<int>(std::size(kShownThetas)),
                  .panel_width_px = 400,
                  .panel_height_px = 320,
                  .key_outside = false};
  const JointFits& joint = fits.by_absorption.front();
  for (const bool jointly : {false, true})
    for (std::size_t i : kShownThetas) {
      const renderer::AzimuthalData& data = fits.distributions[i].data;
      const SeparateFits& separate = fits.separate[i];
      PlotPanel panel = azimuth_panel((jointly ? "jointly, theta = " : "separately, theta = ") +
                                      formatted("%g", data.theta_rad / kDegree));
      panel.lines = {azimuth_line("simulated", data.density, PlotStyle::line, 7),
                     azimuth_line("thread model", jointly ? joint.thread.densities[i] : separate.thread.densities[0],
                                  PlotStyle::line, 1),
                     azimuth_line("yarn reconstruction", jointly ? joint.yarn.densities[i] : separate.yarn.densities[0],
                                  PlotStyle::dashed, 2)};
      panel.y_range = std::pair{0.0, 1.4 * data.density.maxCoeff()};
      sheet.panels.push_back(panel);
    }
  return sheet;
}

}  // namespace

std::vector<std::filesystem::path> plot_scattering(const ScatterPlotRequest& request) {
  std::error_code problem;
  std::filesystem::create_directories(request.out, problem);
  if (problem || !std::filesystem::is_directory(request.out))
    throw std::runtime_error("cannot make the folder " + request.out.string() + "; give another one with --out");
  const PlotSheet third = figure_3(request);
  std::vector<Distribution> distributions;
  for (double theta_deg : kThetasDeg) {
    MultiFiberOptions options = request.options;
    options.theta_rad = theta_deg * kDegree;
    const std::string title = formatted("theta %g deg", theta_deg);
    const std::vector<double> density = simulate_with_progress(options, "simulate " + title, request.progress).density;
    distributions.push_back(
        {.source = title,
         .radius_ratio = options.fiber_radius / options.thread_radius,
         .data = {.theta_rad = options.theta_rad,
                  .eta = options.eta,
                  .absorption = 0,
                  .density = Eigen::Map<const Eigen::ArrayXd>(density.data(), std::ssize(density))}});
  }
  const DistributionFits fits = fit_distributions(std::move(distributions), request.progress);
  std::vector<std::filesystem::path> files;
  const auto write = [&](const std::string& name, const PlotSheet& sheet) {
    for (const auto& [format, ending] : {std::pair{PlotFormat::svg, ".svg"}, std::pair{PlotFormat::png, ".png"}}) {
      files.push_back(request.out / (name + ending));
      write_text_file(files.back(), draw(sheet, format));
    }
  };
  write("figure_3", third);
  write("figure_4", figure_4(request, fits));
  write("figure_5", figure_5(fits));
  files.push_back(request.out / "fits.json");
  write_json_file(files.back(), to_json(fits));
  return files;
}

}  // namespace station
