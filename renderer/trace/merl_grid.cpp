#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "renderer/trace/cloth_reflectance.h"

namespace renderer {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

constexpr double kLeastHeight = 0.00873;  // sine of half a degree
// How far to each side a cell is averaged with others: about three degrees, which are more cells where these are
// narrow.
constexpr double kReach_deg = 3;
constexpr int kLeastReachTheta = 3, kMostReachThetaH = 20, kLeastReachPhi = 10;

Vector3d turned(const Vector3d& w, double turn_rad) {
  return Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ()) * w;
}

Vector3d by_cosine(const Eigen::Vector2f& u) {
  const double radius2 = std::min(0.9999, static_cast<double>(u.x())), phi = 2 * std::numbers::pi * u.y();
  return {std::sqrt(radius2) * std::cos(phi), std::sqrt(radius2) * std::sin(phi), std::sqrt(1 - radius2)};
}

bool is_above(const MerlDirections& directions) {
  return std::min(directions.wi.z(), directions.wo.z()) >= kLeastHeight;
}

// The weight of a squared difference of BRDFs: what is seen is the BRDF times both cosines.
double weight_of(const MerlDirections& directions) {
  const double cosines = directions.wi.z() * directions.wo.z();
  return cosines * cosines;
}

// Sums of numbers and of weights side by side, so that a mean leaves out what is below the horizon.
struct Cell {
  std::array<Array3d, 2> sums{Array3d::Zero(), Array3d::Zero()};  // two independent halves of the samples
  double weight = 0;
};
using Cells = std::vector<Cell>;

constexpr std::array<int, 3> kSizes{MerlGrid::kThetaH, MerlGrid::kThetaD, MerlGrid::kPhiD};
constexpr std::array<int, 3> kStrides{MerlGrid::kThetaD * MerlGrid::kPhiD, MerlGrid::kPhiD, 1};

std::array<int, 3> place_of(int cell) {
  return {cell / kStrides[0], cell / kStrides[1] % kSizes[1], cell % kSizes[2]};
}

int reach(int axis, int theta_h, int theta_d) {
  if (axis == 0) {
    const double width_deg = 90 * (2 * theta_h + 1.0) / (MerlGrid::kThetaH * MerlGrid::kThetaH);
    return std::clamp(static_cast<int>(kReach_deg / width_deg), kLeastReachTheta, kMostReachThetaH);
  }
  if (axis == 1) return kLeastReachTheta;
  const double circle = std::sin((theta_d + 0.5) / MerlGrid::kThetaD * std::numbers::pi / 2);
  return std::clamp(static_cast<int>(2 * kReach_deg / circle), kLeastReachPhi, MerlGrid::kPhiD / 2 - 1);
}

// The cells averaged along one axis; phi_d goes on in a circle, the other angles end.
Cells averaged_along(const Cells& cells, int axis) {
  const auto a = static_cast<std::size_t>(axis);
  Cells result(cells.size());
  tbb::parallel_for(0, MerlGrid::kCells, [&](int i) {
    const std::array<int, 3> place = place_of(i);
    const int at = place[a], size = kSizes[a], most = reach(axis, place[0], place[1]);
    Cell& sum = result[static_cast<std::size_t>(i)];
    for (int d = -most; d <= most; ++d) {
      const int other = axis == 2 ? (at + d + size) % size : at + d;
      if (other < 0 || other >= size) continue;
      const Cell& cell = cells[static_cast<std::size_t>(i + (other - at) * kStrides[a])];
      const double share = most + 1 - std::abs(d);
      for (std::size_t half = 0; half < 2; ++half) sum.sums[half] += share * cell.sums[half];
      sum.weight += share * cell.weight;
    }
  });
  return result;
}

MerlDirections directions_of(int cell) {
  const std::array<int, 3> place = place_of(cell);
  return merl_directions(place[0], place[1], place[2]);
}

// The samples of one cell. Neighbours in phi_d, which are averaged, share one sequence of well-spread places and turns.
Cell measured(const ClothReflectance& cloth, int number, int samples, std::uint64_t seed) {
  Cell cell;
  const MerlDirections directions = directions_of(number);
  if (!is_above(directions)) return cell;
  for (std::size_t half = 0; half < 2; ++half) {
    Sampler sampler(seed + half, static_cast<std::uint64_t>(number / MerlGrid::kPhiD));
    for (int s = 0; s < samples / 2; ++s) {
      sampler.start_sample(static_cast<std::uint32_t>(number % MerlGrid::kPhiD * samples / 2 + s));
      const double turn = 2 * std::numbers::pi * static_cast<double>(sampler.next_1d());
      const Vector3d wi = turned(directions.wi, turn), wo = turned(directions.wo, turn);
      cell.sums[half] += (s % 2 == 0 ? cloth.sample(wi, wo, sampler) : cloth.sample(wo, wi, sampler)) / (samples / 2);
    }
  }
  cell.weight = 1;
  return cell;
}

}  // namespace

MerlDirections merl_directions(int theta_h, int theta_d, int phi_d) {
  const double share = (theta_h + 0.5) / MerlGrid::kThetaH, h = share * share * std::numbers::pi / 2;
  const double d = (theta_d + 0.5) / MerlGrid::kThetaD * std::numbers::pi / 2,
               phi = (phi_d + 0.5) / MerlGrid::kPhiD * std::numbers::pi;
  const Vector3d difference(std::sin(d) * std::cos(phi), std::sin(d) * std::sin(phi), std::cos(d));
  const Eigen::AngleAxisd tilt(h, Vector3d::UnitY());
  return {tilt * difference, tilt * Vector3d(-difference.x(), -difference.y(), difference.z())};
}

double anisotropy(const ClothReflectance& cloth, std::uint64_t seed) {
  constexpr int kPairs = 512, kTurns = 12, kSamples = 64;
  std::vector<double> squares(kPairs), means(kPairs);
  tbb::parallel_for(0, kPairs, [&](int pair) {
    Sampler sampler(seed, static_cast<std::uint64_t>(pair));
    sampler.start_sample(0);
    const Vector3d wi = by_cosine(sampler.next_2d()), wo = by_cosine(sampler.next_2d());
    // Two independent estimates at each turn: the product of their deviations has no part of the noise.
    std::array<std::array<Array3d, kTurns>, 2> estimates;
    std::array<Array3d, 2> mean{Array3d::Zero(), Array3d::Zero()};
    for (std::size_t k = 0; k < 2; ++k)
      for (int t = 0; t < kTurns; ++t) {
        const double turn = 2 * std::numbers::pi * t / kTurns;
        Sampler own(seed + 1 + k, static_cast<std::uint64_t>(pair * kTurns + t));
        Array3d sum = Array3d::Zero();
        for (int s = 0; s < kSamples; ++s) {
          own.start_sample(static_cast<std::uint32_t>(s));
          sum += cloth.sample(turned(wi, turn), turned(wo, turn), own);
        }
        estimates[k][static_cast<std::size_t>(t)] = sum / kSamples;
        mean[k] += sum / (kSamples * kTurns);
      }
    double square = 0;
    for (std::size_t t = 0; t < kTurns; ++t)
      square += ((estimates[0][t] - mean[0]) * (estimates[1][t] - mean[1])).sum() / kTurns;
    const double seen = weight_of({wi, wo});
    squares[static_cast<std::size_t>(pair)] = seen * square;
    means[static_cast<std::size_t>(pair)] = seen * (mean[0] * mean[1]).sum();
  });
  double square = 0, whole = 0;
  for (std::size_t i = 0; i < kPairs; ++i) square += squares[i], whole += means[i];
  return whole > 0 ? std::sqrt(std::max(0.0, square) / whole) : 0;
}

MerlGrid measure_merl(const ClothReflectance& cloth, int samples_per_cell, std::uint64_t seed,
                      const std::function<bool(double)>& progress) {
  constexpr int kRow = MerlGrid::kPhiD;
  const int samples = std::max(4, samples_per_cell / 4 * 4);  // halves, each both ways of the light
  Cells cells(MerlGrid::kCells);
  std::atomic<int> rows{0}, measured_cells{0};
  std::atomic<bool> stopped{false};
  tbb::parallel_for(0, MerlGrid::kCells / kRow, [&](int row) {
    if (stopped) return;
    for (int i = row * kRow; i < (row + 1) * kRow; ++i) {
      Cell& cell = cells[static_cast<std::size_t>(i)];
      cell = measured(cloth, i, samples, seed);
      measured_cells += cell.weight > 0;
    }
    ++rows;
    if (progress && row % 16 == 0 && !progress(static_cast<double>(rows) * kRow / MerlGrid::kCells)) stopped = true;
  });
  if (stopped) throw std::runtime_error("the measurement was stopped on request; start it again for the whole table");
  const Cells means = averaged_along(averaged_along(averaged_along(cells, 0), 1), 2);
  MerlGrid grid{.brdf = std::vector<Array3d>(MerlGrid::kCells, Array3d::Constant(-1)),
                .samples = static_cast<std::uint64_t>(measured_cells) * static_cast<std::uint64_t>(samples)};
  double error = 0, whole = 0;
  for (std::size_t i = 0; i < means.size(); ++i) {
    if (!(cells[i].weight > 0)) continue;
    const Array3d a = means[i].sums[0] / means[i].weight, b = means[i].sums[1] / means[i].weight;
    grid.brdf[i] = (a + b) / 2;
    const double seen = weight_of(directions_of(static_cast<int>(i)));
    error += seen * (a - b).square().sum() / 4;
    whole += seen * (a * b).sum();
  }
  grid.noise = whole > 0 ? std::sqrt(error / whole) : 0;
  return grid;
}

}  // namespace renderer
