// Benches drawn at random by a seed: a camera somewhere before the platform, with a lens that distorts, and a platform
// that turns by more or less than it says, or the other way.
#include "calibration/geometry/bench_sketch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <random>

#include "calibration/geometry/targets.h"
#include "calibration/sensor/degree.h"
#include "tests/calibration/geometry/synthetic_views.h"
#include "tests/support/message_of.h"

namespace calibration {
namespace {

using Eigen::Vector3d;

constexpr double kNoise_px = 0.1, kRingOff_mm = 1;

struct DrawnBench {
  Lens lens;
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();  // origin on the platform's top
  double turned_per_reading = 1, first_tag_rad = 0;
};

DrawnBench drawn_bench(std::mt19937& random) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  DrawnBench bench;
  const double distance = between(400, 900), elevation = between(25, 60) * kDegree;
  const int width = random() % 2 ? 6024 : 600;
  // The platform, 140 mm wide, fills 40 to 80 % of the picture's width.
  const double f = between(0.4, 0.8) * width * distance / 140;
  bench.lens = {width,
                2 * width / 3,
                f,
                f,
                (0.5 + between(-0.01, 0.01)) * width,
                (0.333 + between(-0.01, 0.01)) * width,
                {between(-0.2, 0.1), 0, 0, 0, 0}};
  const Vector3d eye = distance * Vector3d(std::cos(elevation), 0, std::sin(elevation));
  const Vector3d aim(between(-10, 10), between(-10, 10), between(-10, 30)), forward = (aim - eye).normalized();
  const Vector3d right =
      Eigen::AngleAxisd(between(-3, 3) * kDegree, forward) * forward.cross(Vector3d::UnitZ()).normalized();
  bench.world_from_camera.linear() << right, forward.cross(right), forward;
  bench.world_from_camera.translation() = eye;
  bench.turned_per_reading = (random() % 3 ? 1 : -1) * between(0.6, 1.5);
  bench.first_tag_rad = between(-40, 40) * kDegree;
  return bench;
}

TagObservation picture_of(const DrawnBench& bench, const TagLayout& ring, double reading_rad, std::mt19937& random) {
  std::normal_distribution<double> noise(0, kNoise_px);
  const double angle = bench.first_tag_rad + bench.turned_per_reading * reading_rad;
  const Eigen::Isometry3d camera_from_ring = bench.world_from_camera.inverse() *
                                             Eigen::AngleAxisd(angle, Vector3d::UnitZ()) *
                                             Eigen::Translation3d(kRingOff_mm, 0, 0);
  TagObservation seen;
  for (const Tag& tag : ring.tags) {
    TagDetection detection{.id = tag.id, .corners_px = {}};
    const auto corners = corners_in_object(tag);
    for (std::size_t i = 0; i < corners.size(); ++i)
      detection.corners_px[i] =
          synthetic::project(bench.lens, camera_from_ring * corners[i]) + Eigen::Vector2d(noise(random), noise(random));
    seen.push_back(detection);
  }
  return seen;
}

TEST(BenchSketch, RandomBenchesAreFoundAsWellAsByTape) {
  const TagLayout ring = make_platform_ring(12, 60, 14, 300);
  double worst_f = 0, worst_mm = 0, worst_ratio = 0;
  constexpr unsigned kFirstSeed = 4000, kBenches = 20;
  for (unsigned seed = kFirstSeed; seed < kFirstSeed + kBenches; ++seed) {
    std::mt19937 random(seed);
    const DrawnBench bench = drawn_bench(random);
    std::vector<RingSighting> sightings;
    for (const double reading_deg : {0, 10, 45, 90, 135})
      sightings.push_back({reading_deg * kDegree, picture_of(bench, ring, reading_deg * kDegree, random)});
    const BenchSketch sketch = sketch_bench(ring, {bench.lens.width_px, bench.lens.height_px}, sightings);
    const Vector3d eye = bench.world_from_camera.translation();
    const double off_f = std::abs(sketch.focal_length_px / bench.lens.fx_px - 1);
    const double off_mm = (sketch.camera_mm - eye).norm() / eye.norm();
    worst_f = std::max(worst_f, off_f);
    worst_mm = std::max(worst_mm, off_mm);
    worst_ratio = std::max(worst_ratio, std::abs(sketch.turned_per_reading - bench.turned_per_reading));
    EXPECT_LT(off_f, 0.1) << "seed " << seed;
    EXPECT_LT(off_mm, 0.1) << "seed " << seed;
    EXPECT_NEAR(sketch.turned_per_reading, bench.turned_per_reading, 0.005) << "seed " << seed;
    EXPECT_NEAR(sketch.first_tag_rad, bench.first_tag_rad, 2 * kDegree) << "seed " << seed;
  }
  std::printf(
      "seeds %u to %u: focal length off by up to %.1f %%, the camera's place by %.1f %% of its distance, the "
      "platform's scale by %.4f\n",
      kFirstSeed, kFirstSeed + kBenches - 1, 100 * worst_f, 100 * worst_mm, worst_ratio);
}

TEST(BenchSketch, APictureWithoutTheRingIsNamedByItsAngle) {
  const TagLayout ring = make_platform_ring(12, 60, 14, 300);
  std::mt19937 random(1);
  const DrawnBench bench = drawn_bench(random);
  std::vector<RingSighting> sightings{{0, picture_of(bench, ring, 0, random)}, {45 * kDegree, {}}};
  EXPECT_THAT(station::message_of([&] {
                sketch_bench(ring, {600, 400}, sightings);
              }),
              testing::HasSubstr("at 45 degrees 0 of the 12 tags"));
}

}  // namespace
}  // namespace calibration
