#include "renderer/scattering/multi_fiber.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <thread>

#include "renderer/scattering/circle_grid.h"
#include "renderer/scattering/degree.h"
#include "renderer/scattering/lobes.h"
#include "renderer/scattering/random_stream.h"

namespace renderer {
namespace {

using Eigen::Vector2d;

constexpr double kFaint = 0.05;  // rays below this energy play Russian roulette
constexpr double kSteepest = 89.9 * kDegree;

// What the rays of one block did; energies are sums over rays.
struct Tally {
  std::vector<double> energy;  // per bin of azimuth
  std::vector<double> exits;   // as MultiFiberScattering::exits
  std::array<double, MultiFiberScattering::kRefractionBins> by_fibers_passed{};
  double entered = 0, length = 0;
  std::uint64_t met = 0;

  explicit Tally(const MultiFiberOptions& options)
      : energy(static_cast<std::size_t>(options.bins)),
        exits(energy.size() * static_cast<std::size_t>(options.offset_bins * options.offset_bins)) {}
  void add(const Tally& other) {
    for (std::size_t i = 0; i < energy.size(); ++i) energy[i] += other.energy[i];
    for (std::size_t i = 0; i < exits.size(); ++i) exits[i] += other.exits[i];
    for (std::size_t i = 0; i < by_fibers_passed.size(); ++i) by_fibers_passed[i] += other.by_fibers_passed[i];
    entered += other.entered, length += other.length, met += other.met;
  }
};

// A smooth fiber seen under one inclination.
class FiberOptics {
 public:
  explicit FiberOptics(const MultiFiberOptions& options) : cos_theta_(std::cos(options.theta_rad)), eta_(options.eta) {
    const double sin_theta = std::sin(options.theta_rad);
    const double inside2 = eta_ * eta_ - sin_theta * sin_theta;  // (eta cos theta_t)^2
    inverse_plane_eta_ = cos_theta_ / std::sqrt(inside2);
    length_per_cos_ = 2 * eta_ / std::sqrt(inside2);
  }

  // A ray's visit of a fiber: it enters the unit circle at normal n; n and the direction become those where it leaves.
  struct Visit {
    int chords = 0;     // 0: reflected outside
    double length = 0;  // in space, in radii
  };
  Visit visit(Vector2d& normal, Vector2d& direction, double random) const {
    // Back to unit length (Newton's step for 1 / |n|): curved mirrors multiply an error about tenfold at each visit.
    normal *= 1.5 - 0.5 * normal.squaredNorm();
    const Vector2d tangent(-normal.y(), normal.x());
    const double sin_gamma = std::clamp(direction.dot(tangent), -1.0, 1.0);
    const double cos_gamma = std::sqrt(1 - sin_gamma * sin_gamma);
    const double reflectance = fresnel_dielectric(cos_theta_ * cos_gamma, eta_);
    if (random < reflectance) {
      direction = sin_gamma * tangent + cos_gamma * normal;
      return {};
    }
    // The same random number, stretched again, says how often the ray stays inside.
    random = (random - reflectance) / (1 - reflectance);
    const double sin_t = sin_gamma * inverse_plane_eta_, cos_t = std::sqrt(1 - sin_t * sin_t);
    // From hit to hit the normal turns by pi - 2 gamma_t.
    const Vector2d turn(sin_t * sin_t - cos_t * cos_t, 2 * sin_t * cos_t);
    Visit visit;
    for (bool inside = true; inside; ++visit.chords) {
      normal = Vector2d(normal.x() * turn.x() - normal.y() * turn.y(), normal.x() * turn.y() + normal.y() * turn.x());
      inside = random < reflectance;
      if (inside) random /= reflectance;
    }
    visit.length = visit.chords * length_per_cos_ * cos_t;
    direction = sin_gamma * Vector2d(-normal.y(), normal.x()) + cos_gamma * normal;
    return visit;
  }

 private:
  double cos_theta_, eta_, inverse_plane_eta_, length_per_cos_;
};

class Simulation {
 public:
  explicit Simulation(const MultiFiberOptions& options)
      : options_(options), optics_(options), bins_per_radian_(options.bins / (2 * std::numbers::pi)) {}

  // Rays first..last of the configuration whose fibers `grid` holds (unit radius).
  Tally trace(const CircleGrid& grid, double reach, int first, int last, std::uint64_t stream) const {
    Tally tally(options_);
    RandomStream random(options_.seed, stream);
    for (int ray = first; ray < last; ++ray) {
      const double h = 2 * (ray + random.uniform()) / options_.rays - 1;
      trace_ray(grid, Vector2d(reach, h * reach), random, tally);
    }
    return tally;
  }

 private:
  void trace_ray(const CircleGrid& grid, Vector2d position, RandomStream& random, Tally& tally) const {
    Vector2d direction(-1, 0);
    CircleHit hit = grid.nearest(position, direction, -1);
    const double offset_in = offset_of(position, direction);
    double energy = 1;
    if (hit.circle < 0) return count_exit(offset_in, position, direction, energy, tally);
    ++tally.met;
    std::size_t passed = 0;
    while (hit.circle >= 0) {
      const Vector2d& center = grid.center(hit.circle);
      Vector2d normal = position + hit.distance * direction - center;
      const FiberOptics::Visit visit = optics_.visit(normal, direction, random.uniform());
      position = center + normal;
      if (visit.chords > 0) {
        ++passed;
        tally.entered += energy;
        tally.length += energy * visit.length;
        if (options_.sigma_a > 0) {
          energy *= std::exp(-options_.sigma_a * visit.length);
          if (energy < kFaint) {
            if (random.uniform() * kFaint >= energy) return;
            energy = kFaint;
          }
        }
      }
      hit = grid.nearest(position, direction, hit.circle);
    }
    tally.energy[static_cast<std::size_t>(azimuth_bin(direction))] += energy;
    count_exit(offset_in, position, direction, energy, tally);
    tally.by_fibers_passed[std::min(passed, tally.by_fibers_passed.size() - 1)] += energy;
  }

  int azimuth_bin(const Vector2d& direction) const {
    const double azimuth = std::atan2(direction.y(), direction.x());
    return std::min(static_cast<int>((azimuth + std::numbers::pi) * bins_per_radian_), options_.bins - 1);
  }

  double offset_of(const Vector2d& position, const Vector2d& direction) const {
    return (direction.x() * position.y() - direction.y() * position.x()) * options_.fiber_radius /
           options_.thread_radius;
  }

  void count_exit(double offset_in, const Vector2d& position, Vector2d direction, double energy, Tally& tally) const {
    const int bins = options_.offset_bins;
    if (bins == 0) return;
    double offset_out = offset_of(position, direction);
    if (offset_in < 0) offset_in = -offset_in, offset_out = -offset_out, direction.y() = -direction.y();
    const int in = std::clamp(static_cast<int>(offset_in * bins), 0, bins - 1);
    const int out = std::clamp(static_cast<int>((offset_out + 1) / 2 * bins), 0, bins - 1);
    tally.exits[static_cast<std::size_t>((in * options_.bins + azimuth_bin(direction)) * bins + out)] += energy;
  }

  const MultiFiberOptions& options_;
  FiberOptics optics_;
  double bins_per_radian_;
};

void require(bool fine, const std::string& message) {
  if (!fine) throw std::invalid_argument(message);
}

void check(const MultiFiberOptions& o) {
  require(o.fiber_radius > 0 && o.thread_radius >= o.fiber_radius && std::isfinite(o.thread_radius),
          "fiber radius " + std::to_string(o.fiber_radius) + " does not fit into thread radius " +
              std::to_string(o.thread_radius) + "; take a positive one that is no larger than the thread");
  require(o.thread_radius <= 1000 * o.fiber_radius,
          "the thread is more than 1000 times as thick as its fibers; that many circles are not simulated");
  require(o.min_gap >= 0 && std::isfinite(o.min_gap), "the gap between fibers must be 0 or more");
  require(o.max_attempts >= 1, "at least one attempt is needed to place a fiber");
  require(o.eta > 1 && o.eta <= 4, "the index of refraction must lie above 1 and at most at 4");
  require(o.sigma_a >= 0 && std::isfinite(o.sigma_a), "absorption must be 0 or more");
  require(std::abs(o.theta_rad) <= kSteepest, "theta must lie between -89.9 and 89.9 degrees");
  require(o.rays >= 1 && o.configurations >= 1, "at least one ray and one configuration are needed");
  require(o.bins >= 4 && o.bins <= 100000 && o.bins % 4 == 0,
          "the number of bins must be a multiple of 4 up to 100000, so that none lies across front and back");
  require(o.offset_bins >= 0 && o.offset_bins <= 1000, "the number of bins of offsets must lie between 0 and 1000");
}

// Runs independent pieces of work on the cores asked for; `progress` is called as MultiFiberOptions says.
class Workers {
 public:
  Workers(const MultiFiberOptions& options, std::int64_t pieces) : options_(options), pieces_(pieces) {
    const int cores = tbb::info::default_concurrency();
    arena_.initialize(options.threads > 0 ? std::min(options.threads, cores) : cores);
  }

  template <class Work>
  void for_each(int count, const Work& work) {
    const std::thread::id caller = std::this_thread::get_id();
    const auto piece = [&](int i) {
      if (stopped_) return;
      work(i);
      const double finished = static_cast<double>(++done_) / static_cast<double>(pieces_);
      if (options_.progress && std::this_thread::get_id() == caller && !options_.progress(finished)) stopped_ = true;
    };
    arena_.execute([&] { tbb::parallel_for(0, count, piece); });
    if (stopped_) throw std::runtime_error("the simulation was stopped on request; start it again");
  }

 private:
  const MultiFiberOptions& options_;
  std::int64_t pieces_;
  tbb::task_arena arena_;
  std::atomic<std::int64_t> done_{0};
  std::atomic<bool> stopped_{false};
};

// Sums of blocks, each added in the order of its number, so that the threads do not change the rounding.
struct Accumulator {
  Tally sum;
  std::vector<double> squares;  // of each configuration's fractions
  std::size_t fibers = 0;

  explicit Accumulator(const MultiFiberOptions& options) : sum(options), squares(sum.energy.size()) {}
  void add(const Tally& configuration, std::size_t its_fibers) {
    sum.add(configuration);
    fibers += its_fibers;
    const double met = static_cast<double>(std::max<std::uint64_t>(configuration.met, 1));
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const double fraction = configuration.energy[i] / met;
      squares[i] += fraction * fraction;
    }
  }
};

MultiFiberScattering summary(const Accumulator& all, const MultiFiberOptions& options) {
  const Tally& sum = all.sum;
  const double met = static_cast<double>(std::max<std::uint64_t>(sum.met, 1));
  const double per_radian = options.bins / (2 * std::numbers::pi), configurations = options.configurations;
  MultiFiberScattering result;
  result.rays = sum.met;
  result.miss = 1 - static_cast<double>(sum.met) / (static_cast<double>(options.rays) * configurations);
  result.mean_fibers = static_cast<double>(all.fibers) / configurations;
  result.mean_entered = sum.entered / met;
  result.mean_length = sum.length / met;
  for (std::size_t i = 0; i < sum.by_fibers_passed.size(); ++i)
    result.by_fibers_passed[i] = sum.by_fibers_passed[i] / met;
  for (double energy : sum.exits) result.exits.push_back(energy / (options.rays * configurations));
  const std::size_t quarter = sum.energy.size() / 4;
  for (std::size_t i = 0; i < sum.energy.size(); ++i) {
    const double fraction = sum.energy[i] / met;
    result.density.push_back(fraction * per_radian);
    const double variance = std::max(0.0, all.squares[i] / configurations - fraction * fraction);
    result.density_error.push_back(configurations > 1 ? std::sqrt(variance / (configurations - 1)) * per_radian : 0);
    result.albedo += fraction;
    if (i >= quarter && i < 3 * quarter) result.back += fraction;
  }
  return result;
}

}  // namespace

std::vector<Vector2d> fiber_configuration(const MultiFiberOptions& options, int configuration) {
  const std::uint64_t seed = mixed_bits(options.seed + mixed_bits(static_cast<std::uint64_t>(configuration)));
  return pack_fibers(options.thread_radius, options.fiber_radius, options.min_gap, options.max_attempts,
                     options.max_attempts, seed, options.placement);
}

MultiFiberScattering simulate_multi_fiber(const MultiFiberOptions& options) {
  check(options);
  const Simulation simulation(options);
  const double reach = options.thread_radius / options.fiber_radius;
  // Pieces of work are blocks of rays, so that few rays in many configurations and many in one both share out evenly;
  // tallies of one wave of configurations are kept at a time.
  constexpr int kLeastBlock = 1 << 14, kMostKept = 1 << 22;  // rays; bins in all tallies
  const int most_blocks =
      std::max(1, kMostKept / (options.bins * std::max(1, options.offset_bins * options.offset_bins)));
  const int block = std::max(kLeastBlock, options.rays / most_blocks + 1);
  const int blocks = (options.rays - 1) / block + 1;
  const int wave = std::min(options.configurations, std::max(1, most_blocks / blocks));

  Workers workers(options, static_cast<std::int64_t>(options.configurations) * (blocks + 1));
  Accumulator all(options);
  for (int start = 0; start < options.configurations; start += wave) {
    const int count = std::min(wave, options.configurations - start);
    std::vector<CircleGrid> grids(static_cast<std::size_t>(count));
    workers.for_each(count, [&](int i) {
      std::vector<Vector2d> centers = fiber_configuration(options, start + i);
      for (Vector2d& center : centers) center /= options.fiber_radius;
      grids[static_cast<std::size_t>(i)] = CircleGrid(centers, 1, reach);
    });
    std::vector<Tally> tallies(static_cast<std::size_t>(count * blocks), Tally(options));
    workers.for_each(count * blocks, [&](int i) {
      const int first = i % blocks * block;
      tallies[static_cast<std::size_t>(i)] = simulation.trace(
          grids[static_cast<std::size_t>(i / blocks)], reach, first, std::min(options.rays, first + block),
          static_cast<std::uint64_t>(start) * static_cast<std::uint64_t>(blocks) + static_cast<std::uint64_t>(i));
    });
    for (int i = 0; i < count; ++i) {
      Tally configuration(options);
      for (int k = 0; k < blocks; ++k) configuration.add(tallies[static_cast<std::size_t>(i * blocks + k)]);
      all.add(configuration, grids[static_cast<std::size_t>(i)].size());
    }
  }
  return summary(all, options);
}

}  // namespace renderer
