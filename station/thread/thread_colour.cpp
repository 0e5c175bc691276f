#include "station/thread/thread_colour.h"

#include <Eigen/Dense>
#include <optional>

#include "calibration/light/colour_chart.h"
#include "inversion/fit/energy_bands.h"
#include "station/documents/matrix_rows.h"

namespace station {
namespace {

using Eigen::Vector3d;
using nlohmann::json;

// All the light that the thread scatters, of what meets it from all sides in a plane along it; camera RGB.
Vector3d mean_albedo(const ThreadFile& thread) {
  constexpr int kCosines = 40;
  std::vector<double> cosines;
  for (int i = 0; i <= kCosines; ++i) cosines.push_back(static_cast<double>(i) / kCosines);
  const Eigen::VectorXd unknowns = inversion::tinted_unknowns_of(thread.parameters);
  const auto bands =
      inversion::energy_bands(unknowns, Eigen::MatrixXd::Zero(unknowns.size(), unknowns.size()), cosines);
  Vector3d albedo = Vector3d::Zero();
  for (const inversion::EnergyBand& band : bands)
    for (int c = 0; c < 3; ++c)
      albedo[c] += band.albedo[static_cast<std::size_t>(c)] / static_cast<double>(bands.size());
  return albedo;
}

// Camera RGB, as the photographs have it; nothing where an earlier version has not kept it.
std::optional<Vector3d> photographed_colour(const json& fit) {
  Vector3d sum = Vector3d::Zero();
  double count = 0;
  for (const json& view : fit.value("views", json::array())) {
    if (view.value("transmission", false)) continue;
    const auto colour = view.find("colour_over_diffuser");
    if (colour == view.end()) return std::nullopt;
    sum += Vector3d(colour->at(0), colour->at(1), colour->at(2));
    count += 1;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

}  // namespace

ThreadColour colour_of(const ThreadFile& thread) {
  const std::optional<Vector3d> photographed = photographed_colour(thread.fit);
  ThreadColour colour{.photographed = photographed.has_value()};
  colour.linear_srgb = matrix_of(thread.linear_srgb_from_camera) * (photographed ? *photographed : mean_albedo(thread));
  colour.lab = calibration::lab_of_linear_srgb(colour.linear_srgb);
  return colour;
}

}  // namespace station
