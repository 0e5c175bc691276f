#include "station/cloth/export/cloth_far_field.h"

#include <cmath>

#include "station/documents/degree.h"

namespace station {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;
constexpr int kPeriod_px = 32;  // across a period

std::vector<Vector3d> directions(std::initializer_list<double> polar_deg, int azimuths, double first_deg) {
  std::vector<Vector3d> found;
  for (const double polar : polar_deg)
    for (int k = 0; k < (polar == 0 ? 1 : azimuths); ++k)
      found.push_back(direction_at(polar, first_deg + 360.0 * k / azimuths));
  return found;
}

}  // namespace

Vector3d direction_at(double polar_deg, double azimuth_deg) {
  const double sine = std::sin(polar_deg * kDegree);
  return {sine * std::cos(azimuth_deg * kDegree), sine * std::sin(azimuth_deg * kDegree),
          std::cos(polar_deg * kDegree)};
}

std::vector<DirectionPair> standard_pairs() {
  std::vector<DirectionPair> pairs;
  for (const Vector3d& to_light : directions({0, 25, 45, 65}, 8, 0))
    for (const Vector3d& to_view : directions({0, 30, 50, 70}, 4, 0)) pairs.push_back({to_view, to_light});
  for (const Vector3d& to_light : directions({180, 150, 120}, 4, 45))
    for (const Vector3d& to_view : directions({0, 30, 60}, 4, 0)) pairs.push_back({to_view, to_light});
  return pairs;
}

std::vector<Array3d> far_field(const ClothSample& cloth, const std::vector<DirectionPair>& pairs,
                               const FarFieldOptions& options) {
  std::vector<Array3d> found;
  const int samples = std::max(1, options.samples_per_pair / (kPeriod_px * kPeriod_px));
  for (const DirectionPair& pair : pairs) {
    renderer::Scene scene = endless_cloth(cloth);
    scene.lights = {distant_light(pair.to_light)};
    const renderer::PathTracer tracer(std::move(scene));
    const double done = static_cast<double>(found.size());
    const cv::Mat3f picture = in_linear_srgb(
        cloth, render_or_stop(tracer, camera_of_period(cloth, pair.to_view, kPeriod_px, kPeriod_px), samples,
                              options.seed + found.size(), [&](double part) {
                                return options.progress((done + part) / static_cast<double>(pairs.size()));
                              }));
    const cv::Scalar mean = cv::mean(picture);
    found.push_back({mean[0], mean[1], mean[2]});
  }
  return found;
}

}  // namespace station
