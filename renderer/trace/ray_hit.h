// Rays, and what they meet.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <variant>

#include "renderer/scene/scene.h"

namespace renderer {

// How far below the surface scattered rays start, in radii of the curve or fiber: well above rounding of positions, far
// below a radius.
inline constexpr float kStartDepth = 1e-3f;

struct Ray {
  Eigen::Vector3f origin;
  Eigen::Vector3f direction;  // unit
};

// The axis of a curve, before and behind the place where the curve was met.
class CurveAxis {
 public:
  CurveAxis() = default;  // of no curve
  // Met at parameter u of the segment, where the axis is at `met` in the curves' frame; the curves must outlive it.
  // `linear`: from their frame to the world, there.
  CurveAxis(const CurveSet& curves, std::uint32_t segment, float u, const Eigen::Vector3f& met,
            const Eigen::Matrix3f& linear);
  // The same with another way from the curves' frame to the world.
  CurveAxis placed(const Eigen::Matrix3f& linear) const {
    CurveAxis axis = *this;
    axis.linear_ = linear;
    return axis;
  }

  struct Place {
    Eigen::Vector3f offset;      // mm, from the axis where the curve was met
    Eigen::Vector3f derivative;  // of it by t
  };
  // The axis at t segments from there. Beyond the curve's ends it goes on straight.
  Place at(float t) const;

 private:
  const CurveSet* curves_ = nullptr;
  std::uint32_t segment_ = 0;
  float u_ = 0;
  Eigen::Vector3f met_ = Eigen::Vector3f::Zero();  // in the curves' frame
  Eigen::Matrix3f linear_ = Eigen::Matrix3f::Identity();
};

struct CurvePoint {
  std::uint32_t curve_set;   // number of the scattering model, as in scattering_models()
  Eigen::Vector3f position;  // just below the surface, where scattered rays start: they cannot meet the same spot again
  Eigen::Vector3f tangent, normal;  // unit, perpendicular to each other; normal points outwards
  // The section across the tangent is the ellipse of all points axis + x side + y out with x^2 + y^2 = 1, mm; `out`
  // leads from the axis to `position`, `side` along the surface there. On a round yarn both are as long as the radius.
  Eigen::Vector3f side, out;
  CurveAxis axis{};
  FiberAt fiber{};                        // the thread itself, where no fibers are seen
  const cv::Vec3f* absorption = nullptr;  // texel of the cloth's AbsorptionTexture there, if it has one
};

struct MeshPoint {
  std::uint32_t mesh;
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  // unit, towards the ray's origin
  Eigen::Array3f albedo;
  const ReflectanceFactor* reflectance_factor;  // null: Lambertian
};

struct SurfaceHit {
  float distance;  // mm
  std::variant<CurvePoint, MeshPoint> point;
};

// What a cloth knows about a hit, in the frame of the patch's cell [0, period). It is valid after a query whose nearest
// hit is on a cloth.
struct ClothHit {
  // Number of the shell's cell, of the curves in it (ClothGeometry) and of their segment; parameter on the segment.
  std::uint32_t cell = 0, yarns = 0, segment = 0;
  float u = 0;
  Eigen::Vector3f hit_normal = Eigen::Vector3f::Zero();
  Ray ray{};                                       // in that frame; its direction is not unit
  float distance = 0;                              // along `ray`
  Eigen::Vector3d tile = Eigen::Vector3d::Zero();  // place in the endless patch = place in that frame + tile
};

}  // namespace renderer
