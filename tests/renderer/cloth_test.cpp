// Cloth in two scales against the same cloth as explicit curves, ray by ray, and what holds for any cloth.
#include <gtest/gtest.h>

#include <random>

#include "cloth_scenes.h"
#include "renderer/cloth_geometry.h"
#include "renderer/path_tracer.h"
#include "renderer/ray_scene.h"

namespace renderer {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Rays from everywhere round and inside a box, in all directions.
class RandomRays {
 public:
  RandomRays(const Vector3d& low, const Vector3d& high) : low_(low), high_(high) {}
  Ray next() {
    std::uniform_real_distribution<double> u(0, 1);
    std::normal_distribution<double> n;
    const Vector3d origin = low_ + Vector3d(u(random_), u(random_), u(random_)).cwiseProduct(high_ - low_);
    return {origin.cast<float>(), Vector3d(n(random_), n(random_), n(random_)).normalized().cast<float>()};
  }

 private:
  Vector3d low_, high_;
  std::mt19937 random_{7};
};

Eigen::Isometry3d tilted() {
  return Eigen::Translation3d(3, -2, 1) * Eigen::AngleAxisd(0.4, Vector3d(1, 2, 0.5).normalized());
}

struct Agreement {
  int same = 0, different = 0;
};

// Hits within 0.3 mm of the swatch's border are left out: explicit yarns end square to themselves, a swatch is cut.
bool inside(const SwatchShape& swatch, const std::optional<SurfaceHit>& hit) {
  if (!hit) return true;
  const Vector3d p = tilted().inverse() * std::get<CurvePoint>(hit->point).position.cast<double>();
  return std::abs(p.x()) < swatch.width_mm / 2 - 0.3 && std::abs(p.y()) < swatch.height_mm / 2 - 0.3;
}

bool same_hit(const std::optional<SurfaceHit>& a, const std::optional<SurfaceHit>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  const auto &p = std::get<CurvePoint>(a->point), &q = std::get<CurvePoint>(b->point);
  // Embree finds round curves to 0.002 radii along the ray, more where it only touches them.
  return std::abs(a->distance - b->distance) < 3e-3f && (p.position - q.position).norm() < 3e-3f &&
         (p.normal - q.normal).norm() < 2e-2f && std::abs(p.tangent.dot(q.tangent)) > 0.9999f &&
         p.curve_set == q.curve_set;
}

TEST(ClothTest, OnAFlatSwatchRaysMeetWhatTheyMeetOfTheExplicitYarns) {
  // Whole periods of plain (1.8 mm) and satin (2.75 x 5.5 mm), so that the explicit cloth ends where the swatch does.
  const SwatchShape plain_swatch{10.8, 9.0}, satin_swatch{11, 11};
  for (const auto& [patch, swatch] : {std::pair{plain_patch(), plain_swatch}, {satin_patch(), satin_swatch}}) {
    const RayScene two_scale(two_scale_scene(swatch, patch, red_and_blue_threads(), tilted()));
    const RayScene brute_force(brute_force_scene(swatch, patch, red_and_blue_threads(), tilted()));
    RandomRays rays({-4, -9, -5}, {9, 5, 7});
    Agreement found;
    for (int i = 0; i < 60000; ++i) {
      const Ray ray = rays.next();
      const auto a = two_scale.intersect(ray), b = brute_force.intersect(ray);
      if (!inside(swatch, a) || !inside(swatch, b)) continue;
      EXPECT_EQ(two_scale.occluded(ray, 3), a && a->distance < 3);
      if (!a && !b) continue;
      ++(same_hit(a, b) ? found.same : found.different);
    }
    EXPECT_GT(found.same, 8000) << patch.name;
    EXPECT_LE(found.different, 5) << patch.name;  // rays that only touch a yarn
  }
}

}  // namespace
}  // namespace renderer
