#include "station/thread/scatter/distribution_file.h"

#include <cstdio>
#include <numbers>

#include "station/documents/degree.h"
#include "station/documents/number_table.h"
#include "station/documents/number_text.h"
#include "station/documents/session_file.h"

namespace station {
namespace {

std::string note(const char* name, double value) {
  return formatted("# %s %.10g\n", name, value);
}

}  // namespace

std::string distribution_text(const renderer::MultiFiberOptions& o, const renderer::MultiFiberScattering& s) {
  std::string text = "# made_by threadstation scatter simulate, " + software_version() + "\n";
  text += note("thread_radius", o.thread_radius) + note("fiber_radius", o.fiber_radius) + note("gap", o.min_gap);
  text += note("attempts", o.max_attempts);
  text +=
      std::string("# placement ") + (o.placement == renderer::FiberPlacement::area_uniform ? "area" : "radius") + "\n";
  text +=
      note("eta", o.eta) + note("absorption_per_fiber_radius", o.sigma_a) + note("theta_deg", o.theta_rad / kDegree);
  text += note("rays", o.rays) + note("configurations", o.configurations) + note("seed", static_cast<double>(o.seed));
  text += note("missed", s.miss) + note("albedo", s.albedo) + note("back", s.back);
  text += note("mean_fibers", s.mean_fibers) + note("mean_fibers_entered", s.mean_entered) +
          note("mean_length_fiber_radii", s.mean_length);
  for (std::size_t i = 0; i < s.by_fibers_passed.size(); ++i) {
    const std::string name =
        "energy_after_refractions_" + std::to_string(2 * i) + (i + 1 == s.by_fibers_passed.size() ? "_or_more" : "");
    text += note(name.c_str(), s.by_fibers_passed[i]);
  }
  double worst = 0;
  for (double error : s.density_error) worst = std::max(worst, error);
  text += note("largest_standard_error", worst);
  text += "phi_rad,density\n";
  const double width = 2 * std::numbers::pi / static_cast<double>(s.density.size());
  for (std::size_t i = 0; i < s.density.size(); ++i) {
    char row[64];
    std::snprintf(row, sizeof row, "%.17g,%.17g\n", -std::numbers::pi + (static_cast<double>(i) + 0.5) * width,
                  s.density[i]);
    text += row;
  }
  return text;
}

Distribution read_distribution(const std::filesystem::path& file) {
  const NumberTable table(file, {"phi_rad", "density"}, {});
  Distribution distribution;
  distribution.source = file.string();
  distribution.radius_ratio = table.note("fiber_radius", {1e-9, 1e9}) / table.note("thread_radius", {1e-9, 1e9});
  distribution.data.theta_rad = table.note("theta_deg", {-89.9, 89.9}) * kDegree;
  distribution.data.eta = table.note("eta", {1.0001, 4});
  distribution.data.absorption = table.note("absorption_per_fiber_radius", {0, 1e6});
  const auto bins = static_cast<Eigen::Index>(table.rows());
  distribution.data.density.resize(bins);
  const double width = 2 * std::numbers::pi / static_cast<double>(bins);
  for (Eigen::Index i = 0; i < bins; ++i) {
    const auto row = static_cast<std::size_t>(i);
    const double center = -std::numbers::pi + (static_cast<double>(i) + 0.5) * width;
    table.number(row, "phi_rad", {center - 0.01 * width, center + 0.01 * width});  // equal bins over the whole turn
    distribution.data.density[i] = table.number(row, "density", {0, 1e9});
  }
  return distribution;
}

}  // namespace station
