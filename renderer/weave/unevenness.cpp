#include "renderer/weave/unevenness.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace renderer {
namespace {

using Eigen::Vector3d;

double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

// A normal number that is the same everywhere: the generator is specified, the standard's normal distribution is not.
double normal(std::mt19937_64& random) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += uniform(random);
  return sum;
}

double cut_normal(std::mt19937_64& random) {
  for (;;) {
    const double value = normal(random);
    if (std::abs(value) <= 2) return value;
  }
}

int any_shade(int shades, std::mt19937_64& random) {
  return static_cast<int>(random() % static_cast<std::uint64_t>(shades));
}

// The control points of 1 + scale x noise, with mean 1.
std::vector<double> uneven_profile(double scale, int count, double length_mm, double correlation_mm,
                                   std::mt19937_64& random) {
  std::vector<Vector3d> knots;
  double mean = 0;
  for (const double value : closed_noise(count, length_mm, correlation_mm, random)) {
    knots.push_back({std::clamp(value, -kMostDeviation, kMostDeviation), 0, 0});
    mean += knots.back().x() / count;
  }
  std::vector<double> profile;
  for (const Vector3d& point : spline_through(knots, Vector3d::Zero()).control_points)
    profile.push_back(1 + scale * (point.x() - mean));
  return profile;
}

// The thread of each segment: the yarn is cut into pieces of random length and shade.
std::vector<int> shades_along(int thread, int shades, int count, double length_mm, double piece_mm,
                              std::mt19937_64& random) {
  const int pieces = std::max(1, static_cast<int>(std::lround(length_mm / piece_mm)));
  std::vector<int> begins, threads(static_cast<std::size_t>(count));
  for (int i = 0; i < pieces; ++i) begins.push_back(static_cast<int>(uniform(random) * count));
  std::sort(begins.begin(), begins.end());
  for (std::size_t i = 0; i < begins.size(); ++i) {
    const int end = i + 1 < begins.size() ? begins[i + 1] : begins[0] + count;
    const int shade = any_shade(shades, random);
    for (int k = begins[i]; k < end; ++k) threads[static_cast<std::size_t>(k % count)] = thread * shades + shade;
  }
  return threads;
}

void make_yarns_differ(YarnPatch& patch, const Draft& draft) {
  const Unevenness& uneven = draft.unevenness;
  std::mt19937_64 random(uneven.seed);
  for (Yarn& yarn : patch.yarns) {
    const double room = (yarn.warp ? draft.warp : draft.weft).pitch_mm - 2 * yarn.radius_mm;
    const double thicker = cut_normal(random), aside = cut_normal(random);
    const int shade = any_shade(uneven.shades, random);
    yarn.radius_mm *= 1 + uneven.radius * thicker;
    for (Vector3d& point : yarn.control_points) point[yarn.warp ? 0 : 1] += uneven.pitch * room * aside;
    yarn.thread = yarn.thread * uneven.shades + shade;
  }
}

void make_slubs(YarnPatch& patch, const Draft& draft) {
  const Slubs& slubs = draft.slubs;
  std::mt19937_64 thickness(draft.unevenness.seed + 1), twist(draft.unevenness.seed + 2),
      shades(draft.unevenness.seed + 3);
  for (Yarn& yarn : patch.yarns) {
    const int count = static_cast<int>(yarn.control_points.size());
    const double length_mm = spline_length(center_line(patch, yarn));
    if (slubs.radius > 0) yarn.thickness = uneven_profile(slubs.radius, count, length_mm, slubs.length_mm, thickness);
    if (slubs.twist > 0 && draft.plies.count > 1)
      yarn.twist = uneven_profile(slubs.twist, count, length_mm, slubs.length_mm, twist);
    if (slubs.shade_mm > 0) {
      const int own = yarn.thread / draft.unevenness.shades;
      yarn.threads = shades_along(own, draft.unevenness.shades, count, length_mm, slubs.shade_mm, shades);
      yarn.thread = yarn.threads.front();
    }
  }
}

}  // namespace

// The noise is a Fourier sum whose cycles have normal amplitudes; the transform of exp(-(d / c)^2) is exp(-(pi c k /
// length)^2) in cycles k per length.
std::vector<double> closed_noise(int count, double length_mm, double correlation_mm, std::mt19937_64& random) {
  constexpr double kLeastPower = 1e-14;
  const double decay = std::pow(std::numbers::pi * correlation_mm / length_mm, 2);
  std::vector<double> power;
  double sum = 0;
  for (int k = 1; 2 * k < count; ++k) {
    const double share = std::exp(-decay * (k * k - 1));  // of the first
    if (share < kLeastPower) break;
    power.push_back(share);
    sum += share;
  }
  std::vector<double> noise(static_cast<std::size_t>(count), 0.0);
  for (std::size_t k = 1; k <= power.size(); ++k) {
    const double scale = std::sqrt(power[k - 1] / sum), cosine = scale * normal(random), sine = scale * normal(random);
    for (std::size_t i = 0; i < noise.size(); ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k * i % noise.size()) / count;
      noise[i] += cosine * std::cos(angle) + sine * std::sin(angle);
    }
  }
  return noise;
}

void make_uneven(YarnPatch& patch, const Draft& draft) {
  make_yarns_differ(patch, draft);
  make_slubs(patch, draft);
}

}  // namespace renderer
