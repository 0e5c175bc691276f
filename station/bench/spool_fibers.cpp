#include "station/bench/spool_fibers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include "inversion/view/irregularity.h"
#include "renderer/scattering/fiber_bundle.h"
#include "renderer/weave/unevenness.h"

namespace station {
namespace {

// Length of a fiber's pieces in radii: below the 30 up to which curve_geometry.cpp has rays meet cylinders.
constexpr double kPieceRadii = 29;
constexpr int kPackingAttempts = 3000, kPackingTries = 40;
constexpr int kPiecesPerTurn = 16;  // of a ply
constexpr double kOpaque = 1e6;     // 1 / energy of what comes back from inside metal
constexpr int kShades = 17;         // that an uneven thread is drawn in
constexpr double kMostShade = 2.8;  // standard deviations
constexpr int kShadesInFront = 8;   // one after the other, of the part of a turn that is seen

std::vector<Eigen::Vector2d> places_in_bundle(const Spool& spool, double radius_mm, int count, std::uint64_t seed,
                                              double flatness = 1) {
  const SimulatedFibers& fibers = *spool.simulation;
  std::size_t most = 0;
  // Random sequential placement may end a fiber short of what another order of the same circles would hold: try again.
  for (int attempt = 0; attempt < kPackingTries; ++attempt) {
    const auto centres = renderer::pack_fibers(radius_mm, fibers.fiber_radius_mm, fibers.min_gap_mm, kPackingAttempts,
                                               count, seed + static_cast<std::uint64_t>(attempt),
                                               renderer::FiberPlacement::area_uniform, flatness);
    if (static_cast<int>(centres.size()) == count) return centres;
    most = std::max(most, centres.size());
  }
  throw std::runtime_error("spool \"" + spool.name + "\": at most " + std::to_string(most) + " of " +
                           std::to_string(count) +
                           " fibers fit into a thread at random; make fibers_per_thread or fiber_radius_mm smaller");
}

// A metal fiber: an opaque thread that only reflects, with a colour.
renderer::ScatteringModel scattering_of(const SimulatedFibers& fibers) {
  if (!fibers.reflectance) return fibers.scattering;
  renderer::ThreadParameters metal;
  const double m = fibers.scattering.beta_m, n = fibers.scattering.beta_n;
  metal.alpha = {m, m, m}, metal.beta = {n, n, n};
  metal.r0a = metal.r0b = 0, metal.r0c = 1;
  metal.r1a = 0;
  metal.r2a = 0, metal.r2b = kOpaque, metal.r2c = 0;
  metal.lambda0_rgb = *fibers.reflectance;
  metal.exit = renderer::ThreadExit::entry_point;
  return metal;
}

// An uneven thread along itself, in standard deviations at even places, eight of them in the length of a turn that lies
// in front.
std::vector<double> wound_noise(const Spool& spool, std::uint64_t seed) {
  const double turn_mm = inversion::turn_length_mm(spool.wrapping),
               places = kShadesInFront * turn_mm / spool.wrapping.frame_width_mm;
  std::mt19937_64 random(seed);
  return renderer::closed_noise(static_cast<int>(std::lround(places * spool.wrapping.turns)),
                                turn_mm * spool.wrapping.turns, spool.simulation->uneven->length_mm, random);
}

// Turns that touch as they are, the sheet's middle where it was; each turn has one thickness.
std::vector<renderer::CurveSet> uneven_fibers(const Spool& spool) {
  const SimulatedFibers& fibers = *spool.simulation;
  const SimulatedUnevenness& uneven = *fibers.uneven;
  std::vector<renderer::CurveSet> sets(kShades);
  for (int shade = 0; shade < kShades; ++shade) {
    renderer::FiberParameters scattering = fibers.scattering;
    scattering.sigma_a *= std::exp(uneven.shade * kMostShade * (2.0 * shade / (kShades - 1) - 1));
    sets[static_cast<std::size_t>(shade)].scattering = scattering;
  }
  const std::vector<double> darker = wound_noise(spool, fibers.seed * kSeedsPerSpool + 1),
                            thicker = wound_noise(spool, fibers.seed * kSeedsPerSpool + 2);
  const auto turns = static_cast<std::size_t>(spool.wrapping.turns);
  std::vector<double> thickness, middle_mm{0};
  for (std::size_t turn = 0; turn < turns; ++turn) {
    const std::size_t place = turn * thicker.size() / turns;
    thickness.push_back(1 + uneven.diameter *
                                std::clamp(thicker[place], -renderer::kMostDeviation, renderer::kMostDeviation));
    if (turn > 0)
      middle_mm.push_back(middle_mm.back() +
                          spool.wrapping.thread_diameter_mm * (thickness[turn - 1] + thickness[turn]) / 2);
  }
  std::uint64_t seed = fibers.seed * kSeedsPerSpool;
  std::size_t line_number = 0;
  for (const inversion::Segment3& line : inversion::thread_lines(spool.wrapping)) {
    const std::size_t turn = line_number++ % turns;
    const double z = middle_mm[turn] - middle_mm.back() / 2;
    const std::size_t first = turn * darker.size() / turns;
    for (const Eigen::Vector2d& centre : fiber_centres(spool, ++seed * kFiberSeedStep)) {
      const Eigen::Vector3d from(line.from.x() + thickness[turn] * centre.x(), line.from.y(),
                                 z + thickness[turn] * centre.y()),
          step = (line.to - line.from) / kShadesInFront;
      const int pieces = static_cast<int>(std::ceil(step.norm() / (kPieceRadii * fibers.fiber_radius_mm)));
      for (int piece = 0; piece < kShadesInFront; ++piece) {
        const double noise = darker[(first + static_cast<std::size_t>(piece)) % darker.size()] / kMostShade;
        const auto shade =
            static_cast<std::size_t>(std::clamp<long>(std::lround((noise + 1) / 2 * (kShades - 1)), 0, kShades - 1));
        inversion::add_straight_curve(sets[shade], {from + piece * step, from + (piece + 1) * step},
                                      thickness[turn] * fibers.fiber_radius_mm, pieces);
      }
    }
  }
  std::erase_if(sets, [](const renderer::CurveSet& set) { return set.segments.empty(); });
  return sets;
}

renderer::CurveSet straight_fibers(const Spool& spool) {
  const SimulatedFibers& fibers = *spool.simulation;
  renderer::CurveSet curves;
  curves.scattering = scattering_of(fibers);
  std::uint64_t seed = fibers.seed * kSeedsPerSpool;  // a stream of its own for every thread of every spool
  for (const inversion::Segment3& line : inversion::thread_lines(spool.wrapping)) {
    const int pieces =
        static_cast<int>(std::ceil((line.to - line.from).norm() / (kPieceRadii * fibers.fiber_radius_mm)));
    for (const Eigen::Vector2d& centre : fiber_centres(spool, ++seed * kFiberSeedStep)) {
      const Eigen::Vector3d offset(centre.x(), 0, centre.y());  // threads run along y
      inversion::add_straight_curve(curves, {line.from + offset, line.to + offset}, fibers.fiber_radius_mm, pieces);
    }
  }
  return curves;
}

// Plies turn about the thread, and their fibers keep their places in them; each thread begins at an angle of its own.
std::vector<renderer::CurveSet> plied_fibers(const Spool& spool) {
  const SimulatedFibers& fibers = *spool.simulation;
  const std::vector<Eigen::Vector3d>& absorptions = fibers.plies->sigma_a;
  const auto plies = static_cast<int>(absorptions.size());
  const double radius_mm = spool.wrapping.thread_diameter_mm / 2, share = std::sin(std::numbers::pi / plies),
               of_ply_mm = radius_mm * share / (1 + share), out_mm = radius_mm - of_ply_mm;
  const double step_rad = 2 * std::numbers::pi / kPiecesPerTurn;
  const double drawn_mm = out_mm * 3 / (2 + std::cos(step_rad));  // B-splines run inside their control points
  std::vector<renderer::CurveSet> sets(absorptions.size());
  std::uint64_t seed = fibers.seed * kSeedsPerSpool;
  for (const inversion::Segment3& line : inversion::thread_lines(spool.wrapping)) {
    const double step_mm = fibers.plies->turn_mm / kPiecesPerTurn;
    const int steps = static_cast<int>(std::ceil((line.to - line.from).norm() / step_mm));
    const double begin_rad = 2 * std::numbers::pi * static_cast<double>(++seed % kPiecesPerTurn) / kPiecesPerTurn;
    for (int ply = 0; ply < plies; ++ply) {
      renderer::CurveSet& curves = sets[static_cast<std::size_t>(ply)];
      renderer::FiberParameters scattering = fibers.scattering;
      scattering.sigma_a = absorptions[static_cast<std::size_t>(ply)];
      curves.scattering = scattering;
      const int count = (fibers.fibers_per_thread + ply) / plies;  // they add up
      const std::uint64_t of_ply = seed * kFiberSeedStep + static_cast<std::uint64_t>(ply * kPackingTries);
      for (const Eigen::Vector2d& place : places_in_bundle(spool, of_ply_mm, count, of_ply)) {
        std::vector<Eigen::Vector4f> points;
        for (int i = 0; i <= steps; ++i) {
          const double angle = begin_rad + 2 * std::numbers::pi * ply / plies + i * step_rad;
          const Eigen::Vector3d at =
              line.from + (line.to - line.from) * i / steps +
              Eigen::Vector3d(drawn_mm * std::cos(angle) + place.x(), 0, drawn_mm * std::sin(angle) + place.y());
          points.emplace_back(at.cast<float>().x(), at.cast<float>().y(), at.cast<float>().z(),
                              static_cast<float>(fibers.fiber_radius_mm));
        }
        curves.add_clamped_curve(points);
      }
    }
  }
  return sets;
}

}  // namespace

const SimulatedFibers& simulated_fibers(const Spool& spool) {
  if (!spool.simulation)
    throw std::runtime_error("spool \"" + spool.name +
                             "\" has no \"simulation\" part; the simulated bench cannot draw it");
  return *spool.simulation;
}

const SimulatedFibers& bundled_fibers(const Spool& spool) {
  const SimulatedFibers& fibers = simulated_fibers(spool);
  if (fibers.reflectance || fibers.plies || fibers.uneven)
    throw std::runtime_error("spool \"" + spool.name + "\" is simulated " +
                             (fibers.plies         ? "of plies"
                              : fibers.reflectance ? "of metal"
                                                   : "as an uneven thread") +
                             "; give one whose threads are a bundle of fibers with \"eta\" and \"sigma_a\"");
  return fibers;
}

std::vector<Eigen::Vector2d> fiber_centres(const Spool& spool, std::uint64_t seed, double flatness) {
  const SimulatedFibers& fibers = simulated_fibers(spool);
  return places_in_bundle(spool, spool.wrapping.thread_diameter_mm / 2, fibers.fibers_per_thread, seed, flatness);
}

std::vector<renderer::CurveSet> spool_fibers(const Spool& spool) {
  const SimulatedFibers& fibers = simulated_fibers(spool);
  if (fibers.plies) return plied_fibers(spool);
  return fibers.uneven ? uneven_fibers(spool) : std::vector{straight_fibers(spool)};
}

}  // namespace station
