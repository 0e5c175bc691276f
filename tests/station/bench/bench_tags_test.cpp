// The printed tags of the simulated bench lie where its camera sees them.
#include <gtest/gtest.h>

#include "renderer/trace/ray_scene.h"
#include "station/bench/bench_objects.h"
#include "station/bench/camera_adapter.h"
#include "station/documents/degree.h"
#include "station/documents/rig_file.h"
#include "station/documents/spool.h"
#include "tests/places.h"

namespace station {
namespace {

// The spool on the turned platform, and who can see what of it.
struct Bench {
  renderer::Camera camera;
  renderer::RayScene things;

  bool sees(const Eigen::Vector3d& point) const {
    const Eigen::Vector2d pixel = renderer::project(camera, point);
    constexpr double kMargin_px = 3;
    if (pixel.minCoeff() < kMargin_px || pixel.x() > camera.width - 1 - kMargin_px ||
        pixel.y() > camera.height - 1 - kMargin_px)
      return false;
    const Eigen::Vector3d way = camera.world_from_camera.translation() - point;
    const Eigen::Vector3d start = point + 0.05 * Eigen::Vector3d::UnitZ();
    return !things.occluded({start.cast<float>(), way.normalized().cast<float>()}, static_cast<float>(way.norm()));
  }

  // Edge lengths in the picture of the tags that are seen with their white borders.
  std::vector<double> seen_edges_px(const calibration::TagLayout& layout,
                                    const Eigen::Isometry3d& world_from_layout) const {
    std::vector<double> edges;
    for (const calibration::Tag& tag : layout.tags) {
      calibration::Tag bordered = tag;
      bordered.size_mm *= 1.25;
      const auto outline = calibration::corners_in_object(bordered), corners = calibration::corners_in_object(tag);
      bool seen = true;
      double shortest = 1e9;
      for (std::size_t c = 0; c < 4; ++c) {
        for (const double part : {0.0, 0.25, 0.5, 0.75})
          seen = seen && sees(world_from_layout * ((1 - part) * outline[c] + part * outline[(c + 1) % 4]).eval());
        shortest = std::min(shortest, (renderer::project(camera, world_from_layout * corners[c]) -
                                       renderer::project(camera, world_from_layout * corners[(c + 1) % 4]))
                                          .norm());
      }
      if (seen) edges.push_back(shortest);
    }
    return edges;
  }
};

Bench bench_at(const RigFile& rig, const Spool& spool, const Eigen::Isometry3d& turned) {
  renderer::Scene scene;
  scene.meshes = table_and_platform(rig.platform_height_mm, rig.platform_radius_mm);
  const Eigen::Isometry3d holder =
      turned * Eigen::Translation3d(0, 0, rig.platform_height_mm + spool.wrapping.frame_height_mm / 2);
  // Drawn without its window: a table tag behind it would shine through the threads.
  renderer::TriangleMesh plate;
  const auto w = static_cast<float>(spool.wrapping.frame_width_mm / 2),
             h = static_cast<float>(spool.wrapping.frame_height_mm / 2);
  plate.vertices = {{0, -w, -h}, {0, w, -h}, {0, w, h}, {0, -w, h}};
  plate.triangles = {{0, 1, 2}, {0, 2, 3}};
  plate.albedo = cv::Mat3f(1, 1, cv::Vec3f(0, 0, 0));
  transform(plate, holder);
  scene.meshes.push_back(plate);
  const rig::TrueLens& lens = rig.simulation->truth.lens;
  return {camera_of(lens_of(lens), lens.world_from_camera, false), renderer::RayScene(scene)};
}

TEST(BenchTags, ThreeRingTagsAndFourTableTagsAreSeenBesideTheHolderAtEveryAngle) {
  const RigFile rig = read_rig(std::string(DATA_DIR) + "/rigs/simulated.json");
  const Spool spool = read_spool(std::string(DATA_DIR) + "/spools/silk_gold.json");
  for (int angle_deg = -60; angle_deg <= 60; angle_deg += 3) {
    const Eigen::Isometry3d turned(Eigen::AngleAxisd(angle_deg * kDegree, Eigen::Vector3d::UnitZ()));
    const Bench bench = bench_at(rig, spool, turned);
    const auto ring =
        bench.seen_edges_px(rig.platform_ring, turned * Eigen::Translation3d(0, 0, rig.platform_height_mm));
    const auto table = bench.seen_edges_px(rig.table_tags, Eigen::Isometry3d::Identity());
    EXPECT_GE(ring.size(), 3U) << angle_deg;
    EXPECT_GE(table.size(), 4U) << angle_deg;
    // smaller ones are still found, but their corners are no longer better than 0.1 px
    for (const double edge : ring) EXPECT_GE(edge, 25) << angle_deg;
    for (const double edge : table) EXPECT_GE(edge, 25) << angle_deg;
  }
}

TEST(BenchTags, RingTagsStayOnThePlatformAndOutsideOfTheHolder) {
  const RigFile rig = read_rig(std::string(DATA_DIR) + "/rigs/simulated.json");
  const Spool spool = read_spool(std::string(DATA_DIR) + "/spools/silk_gold.json");
  for (const calibration::Tag& tag : rig.platform_ring.tags) {
    calibration::Tag bordered = tag;
    bordered.size_mm *= 1.25;
    for (const Eigen::Vector3d& corner : calibration::corners_in_object(bordered))
      EXPECT_LT(corner.norm(), rig.platform_radius_mm);
    EXPECT_GT(tag.object_from_tag.translation().norm() - bordered.size_mm / 2, spool.wrapping.frame_width_mm / 2);
  }
}

}  // namespace
}  // namespace station
