#include "station/thread/scatter/queries.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "renderer/scene/scene.h"
#include "station/documents/degree.h"
#include "station/documents/fiber_file.h"
#include "station/documents/number_table.h"
#include "station/documents/parameter_ranges.h"
#include "station/documents/reader.h"
#include "station/documents/thread_file.h"
#include "station/documents/yarn_file.h"

namespace station {
namespace {

using renderer::FiberParameters;
using Value = renderer::ScatteringValue<double>;

const std::vector<std::string> kPlace{"h", "theta_i_rad", "phi_i_rad", "theta_o_rad", "phi_o_rad"};
const std::vector<std::string> kFiberColumns{"eta",    "sigma_a_r", "sigma_a_g", "sigma_a_b",
                                             "beta_m", "beta_n",    "tilt_deg"};
constexpr Range kOffset{-1, 1}, kAzimuth{-1e6, 1e6};
constexpr Range kInclination{-1.5708, 1.5708};  // a right angle rounded up; what is beyond it counts as it

ScatteringPlace place(const NumberTable& table, std::size_t row) {
  const auto inclination = [&](const char* column) {
    return std::clamp(table.number(row, column, kInclination), -std::numbers::pi / 2, std::numbers::pi / 2);
  };
  const double phi = table.number(row, "phi_i_rad", kAzimuth) - table.number(row, "phi_o_rad", kAzimuth);
  return scattering_place(table.number(row, "h", kOffset), inclination("theta_i_rad"), inclination("theta_o_rad"), phi);
}

template <class Model>
Value value(const Model& model, const ScatteringPlace& at) {
  return model.lobes_at(at.h, at.wo).evaluate(at.wi);
}

template <template <class> class Model, class Parameters>
std::vector<Value> values_of(const Parameters& parameters, const NumberTable& table) {
  const Model<double> model(parameters);
  std::vector<Value> values;
  for (std::size_t row = 0; row < table.rows(); ++row) values.push_back(value(model, place(table, row)));
  return values;
}

FiberParameters overridden(FiberParameters fiber, const NumberTable& table, std::size_t row) {
  const auto take = [&](double& parameter, const char* column, Range range) {
    if (table.has(column)) parameter = table.number(row, column, range);
  };
  take(fiber.eta, "eta", kRefractiveIndex);
  take(fiber.sigma_a[0], "sigma_a_r", kAbsorption);
  take(fiber.sigma_a[1], "sigma_a_g", kAbsorption);
  take(fiber.sigma_a[2], "sigma_a_b", kAbsorption);
  take(fiber.beta_m, "beta_m", kRoughness);
  take(fiber.beta_n, "beta_n", kRoughness);
  double tilt_deg = fiber.tilt_rad / kDegree;
  take(tilt_deg, "tilt_deg", kTilt_deg);
  fiber.tilt_rad = tilt_deg * kDegree;
  return fiber;
}

FiberParameters fiber_of(const ScatteringQueries& queries, const NumberTable& table) {
  if (!queries.parameters.empty()) return read_fiber(queries.parameters);
  for (const std::string& column : kFiberColumns)
    if (!table.has(column))
      throw std::runtime_error("no --parameters given and " + queries.in.string() + " has no column \"" + column +
                               "\"; give a fiber file or all of the fiber's columns");
  return {};
}

std::vector<Value> fiber_values(const ScatteringQueries& queries, const NumberTable& table) {
  const FiberParameters fiber = fiber_of(queries, table);
  if (std::none_of(kFiberColumns.begin(), kFiberColumns.end(), [&](const auto& c) { return table.has(c); }))
    return values_of<renderer::FiberModel>(fiber, table);
  std::vector<Value> values;
  for (std::size_t row = 0; row < table.rows(); ++row)
    values.push_back(value(renderer::FiberModel<double>(overridden(fiber, table, row)), place(table, row)));
  return values;
}

std::vector<Value> values_of(const ScatteringQueries& queries) {
  const bool fiber = queries.model == "fiber";
  if (!fiber && queries.parameters.empty())
    throw std::runtime_error("no --parameters given; model " + queries.model + " needs a " + queries.model + " file");
  const NumberTable table(queries.in, kPlace, fiber ? kFiberColumns : std::vector<std::string>{});
  if (fiber) return fiber_values(queries, table);
  if (queries.model == "yarn") return values_of<renderer::YarnModel>(read_yarn(queries.parameters), table);
  return values_of<renderer::ThreadModel>(read_thread(queries.parameters).parameters, table);
}

}  // namespace

ScatteringPlace scattering_place(double h, double theta_i_rad, double theta_o_rad, double phi_rad) {
  return {h,
          {std::sin(theta_i_rad), std::cos(theta_i_rad) * std::cos(phi_rad), std::cos(theta_i_rad) * std::sin(phi_rad)},
          {std::sin(theta_o_rad), std::cos(theta_o_rad), 0}};
}

std::size_t evaluate_queries(const ScatteringQueries& queries) {
  const std::vector<Value> values = values_of(queries);
  std::string text = "f_cos_r,f_cos_g,f_cos_b,pdf\n";
  for (const Value& v : values) {
    char line[128];
    std::snprintf(line, sizeof line, "%.17g,%.17g,%.17g,%.17g\n", v.f_cos[0], v.f_cos[1], v.f_cos[2], v.pdf);
    text += line;
  }
  write_text_file(queries.out, text);
  return values.size();
}

}  // namespace station
