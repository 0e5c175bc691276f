// One scattering event of a path: a curve or a diffuse surface, hit by a ray, ready to be evaluated and sampled in
// world directions. It is made once per hit; light sampling and scattering sampling share its state.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "renderer/picture/sampler.h"
#include "renderer/scattering/bundle.h"
#include "renderer/scattering/fiber.h"
#include "renderer/scattering/thread.h"
#include "renderer/scattering/yarn.h"
#include "renderer/trace/light_exit.h"
#include "renderer/trace/ray_scene.h"

namespace renderer {

// How paths end by Russian roulette.
inline constexpr int kFirstRouletteVertex = 4;  // earlier vertices always go on
inline constexpr float kMostSurvival = 0.97f;   // upper bound, so that paths of light that is hardly absorbed end too
inline constexpr int kMostVertices = 1000;      // a guard; roulette ends paths long before it

// The scattering models of a scene's curves (scattering_models()), in float and with everything precomputed.
using CurveModel = std::variant<FiberModel<float>, ThreadModel<float>, YarnModel<float>, BundleModel>;
std::vector<CurveModel> prepare_curve_models(const std::vector<ScatteringModel>& scattering);
std::vector<CurveModel> prepare_curve_models(const std::vector<CurveSet>& curves);

// The rotation into the scattering models' frame at a point of a curve: x = tangent or fiber, z = outward normal.
Eigen::Matrix3f local_from_world(const CurvePoint& point);

// The offset h of the ray along which a curve was hit from outside: the angle from the surface normal (local z) to the
// direction wo back along the ray, in the normal plane, is gamma_o = asin h.
float viewing_offset(const Eigen::Vector3f& wo_local);

// Where light leaves such a curve (ThreadExit); a single fiber sends it on from where it came in.
ThreadExit exit_of(const CurveModel& model);

// The lobes of a curve that is seen from unit direction wo (world); `frame` is local_from_world(curve).
CurveLobes<float> lobes_at(const CurveModel& model, const CurvePoint& curve, const Eigen::Matrix3f& frame,
                           const Eigen::Vector3f& wo);

class PathVertex {
 public:
  // `wo`: unit direction back along the ray. The hit and the models must outlive the vertex.
  PathVertex(const SurfaceHit& hit, const Eigen::Vector3f& wo, const std::vector<CurveModel>& models);

  ScatteringValue<float> evaluate(const Eigen::Vector3f& wi) const;
  Eigen::Vector3f sample(Sampler& sampler) const;
  bool is_curve() const { return is_curve_; }
  // M_p N_p of a curve's lobes along wi.
  Lanes<float> lobe_densities(const Eigen::Vector3f& wi) const { return lobes_.lobe_densities(local_from_world_ * wi); }
  const Eigen::Vector3f& position() const { return position_; }

  // Where light leaves (light_exit.h); what is not a thread sends it on from `position`.
  LightExit exit_toward(const Eigen::Vector3f& wi, Sampler& sampler) const {
    return exits_ ? exits_->toward(wi, sampler) : LightExit{.place = position_};
  }
  LightExit exit_near(const Eigen::Vector3f& about, Sampler& sampler) const {
    return exits_ ? exits_->near(about, sampler) : LightExit{.place = position_};
  }
  float exit_share(const LightExit& exit, const Eigen::Vector3f& wi) const {
    return exits_ ? exits_->share(exit, wi) : 1.0f;
  }
  LeavingRay ray_from(const LightExit& exit, const Eigen::Vector3f& wi) const {
    return exits_ ? exits_->ray(exit, wi) : LeavingRay{.ray = {position_, wi}};
  }
  LeavingRay ray_toward(const Eigen::Vector3f& wi, Sampler& sampler) const {
    return ray_from(exit_toward(wi, sampler), wi);
  }

 private:
  Eigen::Vector3f position_;
  Eigen::Matrix3f local_from_world_;  // curve: tangent, side, normal; surface: z = normal
  Eigen::Array3f albedo_;             // matt surfaces
  const ReflectanceFactor* reflectance_factor_ = nullptr;
  Eigen::Vector3f wo_local_;  // of a surface that is not Lambertian
  bool is_curve_;
  std::optional<ThreadExits> exits_;  // of a thread
  CurveLobes<float> lobes_;           // curves
};

}  // namespace renderer
