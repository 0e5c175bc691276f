#include "renderer/weave/patch.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

// The index of point k, any k, in a list of `count` for one period.
std::size_t in_period(int k, std::size_t count) {
  const int n = static_cast<int>(count);
  return static_cast<std::size_t>((k % n + n) % n);
}

}  // namespace

double half_width(const Yarn& yarn) {
  return yarn.radius_mm * std::sqrt(yarn.flatness);
}
double half_height(const Yarn& yarn) {
  return yarn.radius_mm / std::sqrt(yarn.flatness);
}

double profile_point(const std::vector<double>& profile, int k) {
  return profile.empty() ? 1 : profile[in_period(k, profile.size())];
}

double profile_value(const std::vector<double>& profile, double t) {
  if (profile.empty()) return 1;
  const double knot = std::floor(t);
  const Eigen::Vector4d weights = spline_weights(t - knot);
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += weights[i] * profile_point(profile, static_cast<int>(knot) - 1 + i);
  return sum;
}

double profile_bound(const std::vector<double>& profile) {
  return profile.empty() ? 1 : *std::max_element(profile.begin(), profile.end());
}

int thread_of_segment(const Yarn& yarn, int k) {
  return yarn.threads.empty() ? yarn.thread : yarn.threads[in_period(k, yarn.threads.size())];
}

Eigen::Vector3d period_of(const YarnPatch& patch, const Yarn& yarn) {
  return yarn.warp ? Eigen::Vector3d(0, patch.period_y_mm, 0) : Eigen::Vector3d(patch.period_x_mm, 0, 0);
}

PeriodicSpline center_line(const YarnPatch& patch, const Yarn& yarn) {
  return {yarn.control_points, period_of(patch, yarn)};
}

}  // namespace renderer
