#include "station/bench/bench_picture.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "renderer/trace/path_tracer.h"
#include "renderer/weave/woven_patch.h"
#include "station/bench/bench_objects.h"
#include "station/bench/camera_adapter.h"
#include "station/bench/cloth_on_cylinder.h"
#include "station/bench/spool_fibers.h"
#include "station/documents/matrix_rows.h"

namespace station {
namespace {

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

rig::DrawPicture make_bench_picture(const RigFile& rig, const std::optional<Spool>& spool) {
  if (!rig.simulation)
    throw std::runtime_error("rig \"" + rig.name + "\" has no \"simulation\" part; there is no bench to draw");
  auto painter = std::make_shared<Painter>(Painter{.rig = rig, .spool = spool, .fibers = {}});
  return [painter](const rig::BenchState& state) { return painter->paint(state); };
}

}  // namespace station
