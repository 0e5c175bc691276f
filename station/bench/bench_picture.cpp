#include "station/bench/bench_picture.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "renderer/scattering/fiber_bundle.h"
#include "renderer/trace/path_tracer.h"
#include "renderer/weave/woven_patch.h"
#include "station/bench/bench_objects.h"
#include "station/bench/camera_adapter.h"
#include "station/bench/cloth_on_cylinder.h"
#include "station/documents/matrix_rows.h"

namespace station {
namespace {

// Length of a fiber's pieces in radii: below the 30 up to which curve_geometry.cpp has rays meet cylinders.
constexpr double kPieceRadii = 29;
constexpr int kPackingAttempts = 3000, kPackingTries = 40;
constexpr int kPiecesPerTurn = 16;                // of a ply
constexpr double kOpaque = 1e6;                   // 1 / energy of what comes back from inside metal
constexpr std::uint64_t kPictureSeedStep = 7919;  // between the seeds of two pictures
constexpr double kRoomLampRadius_mm = 250;
constexpr int kRoughSamples = 2;                          // of live view
const Eigen::Vector3d kRoomLampPosition(900, 350, 1100);  // above and beside the camera: upright targets are lit too

renderer::SphereLight flashlight(const rig::TrueLamp& lamp, const Eigen::Isometry3d& object_from_world) {
  const double area = std::numbers::pi * lamp.radius_mm * lamp.radius_mm;
  return {.center = object_from_world * lamp.position,
          .radius_mm = lamp.radius_mm,
          .radiance = lamp.intensity / area,
          .beam_axis = object_from_world.linear() * (lamp.aim - lamp.position).normalized(),
          .beam_exponent = lamp.beam_exponent};
}

// A ceiling lamp that gives a white diffuser at the origin, facing it, the asked radiance.
renderer::SphereLight room_lamp(const Eigen::Vector3d& diffuser_radiance, const Eigen::Isometry3d& object_from_world) {
  const double ratio = kRoomLampPosition.norm() / kRoomLampRadius_mm;
  return {.center = object_from_world * kRoomLampPosition,
          .radius_mm = kRoomLampRadius_mm,
          .radiance = diffuser_radiance * ratio * ratio};
}

void add(renderer::Scene& scene, std::vector<renderer::TriangleMesh> meshes, const Eigen::Isometry3d& scene_from_mesh) {
  for (renderer::TriangleMesh& mesh : meshes) {
    transform(mesh, scene_from_mesh);
    scene.meshes.push_back(std::move(mesh));
  }
}

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

struct Painter {
  RigFile rig;
  std::optional<Spool> spool;
  std::vector<renderer::CurveSet> fibers;      // none until a holder is drawn first
  std::optional<renderer::YarnPatch> patch{};  // until a cloth is
  std::uint64_t pictures = 0;

  // The scene in the frame of the object, where long straight fibers are axis-aligned and their boxes tight.
  renderer::Scene scene(const rig::BenchState& state, const Eigen::Isometry3d& object_from_world) {
    renderer::Scene scene;
    switch (state.arrangement.object) {
      case rig::BenchObject::nothing:
        break;
      case rig::BenchObject::board:
        scene.meshes = board_meshes(rig.board, rig.simulation->board_bow_mm);
        break;
      case rig::BenchObject::spectralon:
        scene.meshes = spectralon_meshes(rig.spectralon, rig.simulation->spectralon_droop);
        break;
      case rig::BenchObject::colour_chart:
        if (!rig.colour_chart)
          throw std::runtime_error("rig \"" + rig.name + "\" has no colour_chart; there is none to draw");
        scene.meshes = colour_chart_meshes(*rig.colour_chart, matrix_of(rig.linear_srgb_from_camera).inverse());
        break;
      case rig::BenchObject::holder:
        if (!spool)
          throw std::runtime_error("the simulated bench was asked for a spool, but none was given; give --spool");
        if (fibers.empty()) fibers = spool_fibers(*spool);
        scene.curves = fibers;
        scene.meshes = holder_meshes(spool->wrapping, rig.holder_tags);
        if (rig.reference_chip)
          for (renderer::TriangleMesh& chip :
               reference_chip_meshes(*rig.reference_chip, spool->wrapping, rig.simulation->spectralon_droop))
            scene.meshes.push_back(std::move(chip));
        break;
      case rig::BenchObject::cylinder:
        if (!spool || !spool->fabric || !spool->fabric->weave)
          throw std::runtime_error(
              "the simulated bench was asked for a cloth on the cylinder and is not told what it is woven of; give "
              "--spool a fabric file with a \"weave\"");
        if (!patch) patch = renderer::woven_patch(spool->fabric->weave->draft).patch;
        add_cloth_on_cylinder(scene, spool->fabric->cylinder, *patch,
                              {spool->fabric->weave->threads.begin(), spool->fabric->weave->threads.end()});
        break;
    }
    const rig::BenchTruth& truth = rig.simulation->truth;
    const Eigen::Isometry3d world_from_ring =
        Eigen::AngleAxisd(state.platform_angle_rad, Eigen::Vector3d::UnitZ()) * truth.platform_from_ring;
    add(scene, table_and_platform(rig.platform_height_mm, rig.platform_radius_mm), object_from_world);
    add(scene, lying_tag_meshes(rig.platform_ring), object_from_world * world_from_ring);
    add(scene, lying_tag_meshes(rig.table_tags), object_from_world * truth.world_from_table_sheet);
    if (state.lamp) scene.lights.push_back(flashlight(*state.lamp, object_from_world));
    if (state.room_radiance.maxCoeff() > 0) scene.lights.push_back(room_lamp(state.room_radiance, object_from_world));
    return scene;
  }

  cv::Mat3f paint(const rig::BenchState& state) {
    const bool dark = !state.lamp && state.room_radiance.maxCoeff() <= 0;
    if (dark) return cv::Mat3f(state.lens.height_px, state.lens.width_px, cv::Vec3f(0, 0, 0));
    const Eigen::Isometry3d object_from_world = state.world_from_object.inverse();
    const renderer::PathTracer tracer(scene(state, object_from_world));
    const renderer::Camera camera =
        camera_of(lens_of(state.lens), object_from_world * state.lens.world_from_camera, false);
    renderer::RenderOptions options;
    options.samples_per_pixel = rig.simulation->target_samples_per_pixel;
    if (state.roughly) options.samples_per_pixel = std::min(kRoughSamples, options.samples_per_pixel);
    options.seed = rig.simulation->truth.seed + (state.roughly ? 0 : kPictureSeedStep * ++pictures);
    const bool threads =
        state.arrangement.object == rig::BenchObject::holder || state.arrangement.object == rig::BenchObject::cylinder;
    const bool threads_lit = threads && state.lamp;
    if (!threads_lit) return tracer.render(camera, options);
    // Fibers scatter far more noisily than paper: their pixels get their own number of samples.
    const cv::Mat1b covered = tracer.curve_coverage(camera, 4);
    options.only = ~covered;
    cv::Mat3f picture = tracer.render(camera, options);
    options.only = covered;
    options.samples_per_pixel = state.roughly ? kRoughSamples : rig.simulation->samples_per_pixel;
    tracer.render(camera, options).copyTo(picture, covered);
    return picture;
  }
};

}  // namespace

const SimulatedFibers& simulated_fibers(const Spool& spool) {
  if (!spool.simulation)
    throw std::runtime_error("spool \"" + spool.name +
                             "\" has no \"simulation\" part; the simulated bench cannot draw it");
  return *spool.simulation;
}

const SimulatedFibers& bundled_fibers(const Spool& spool) {
  const SimulatedFibers& fibers = simulated_fibers(spool);
  if (fibers.reflectance || fibers.plies)
    throw std::runtime_error("spool \"" + spool.name + "\" is simulated " + (fibers.plies ? "of plies" : "of metal") +
                             "; give one whose threads are a bundle of fibers with \"eta\" and \"sigma_a\"");
  return fibers;
}

std::vector<Eigen::Vector2d> fiber_centres(const Spool& spool, std::uint64_t seed, double flatness) {
  const SimulatedFibers& fibers = simulated_fibers(spool);
  return places_in_bundle(spool, spool.wrapping.thread_diameter_mm / 2, fibers.fibers_per_thread, seed, flatness);
}

std::vector<renderer::CurveSet> spool_fibers(const Spool& spool) {
  return simulated_fibers(spool).plies ? plied_fibers(spool) : std::vector{straight_fibers(spool)};
}
rig::DrawPicture make_bench_picture(const RigFile& rig, const std::optional<Spool>& spool) {
  if (!rig.simulation)
    throw std::runtime_error("rig \"" + rig.name + "\" has no \"simulation\" part; there is no bench to draw");
  auto painter = std::make_shared<Painter>(Painter{.rig = rig, .spool = spool, .fibers = {}});
  return [painter](const rig::BenchState& state) { return painter->paint(state); };
}

}  // namespace station
