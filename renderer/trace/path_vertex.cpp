#include "renderer/trace/path_vertex.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace renderer {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;
constexpr float kInvPi = static_cast<float>(1 / std::numbers::pi);

Matrix3f frame_rows(const Vector3f& x, const Vector3f& y, const Vector3f& z) {
  Matrix3f rows;
  rows.row(0) = x, rows.row(1) = y, rows.row(2) = z;
  return rows;
}

// The cosine of the azimuth between two directions about z; 1 where one of them is z.
float cos_azimuth(const Vector3f& a, const Vector3f& b) {
  const float product = a.head<2>().norm() * b.head<2>().norm();
  return product > 0 ? std::clamp(a.head<2>().dot(b.head<2>()) / product, -1.0f, 1.0f) : 1.0f;
}

FiberModel<float> prepare(const FiberParameters& p) {
  return FiberModel<float>(in_scalar<float>(p));
}

ThreadModel<float> prepare(const ThreadParameters& p) {
  return ThreadModel<float>(in_scalar<float>(p));
}

BundleModel prepare(const BundleParameters& p) {
  return BundleModel(p);
}

YarnModel<float> prepare(const YarnParameters& p) {
  return YarnModel<float>(in_scalar<float>(p));
}

}  // namespace

std::vector<CurveModel> prepare_curve_models(const std::vector<ScatteringModel>& scattering) {
  std::vector<CurveModel> models;
  for (const ScatteringModel& model : scattering)
    models.push_back(std::visit([](const auto& parameters) { return CurveModel(prepare(parameters)); }, model));
  return models;
}

std::vector<CurveModel> prepare_curve_models(const std::vector<CurveSet>& curves) {
  std::vector<ScatteringModel> scattering;
  for (const CurveSet& set : curves) scattering.push_back(set.scattering);
  return prepare_curve_models(scattering);
}

Matrix3f local_from_world(const CurvePoint& point) {
  const Vector3f across = point.normal.cross(point.tangent);
  const auto [turn, lift, shade] = point.fiber;
  if (turn == 0 && lift == 0) return frame_rows(point.tangent, across, point.normal);
  const float cosine = std::cos(lift), sine = std::sin(lift);
  const Vector3f flat = std::cos(turn) * point.tangent + std::sin(turn) * across,
                 fiber = cosine * flat + sine * point.normal, normal = cosine * point.normal - sine * flat;
  return frame_rows(fiber, normal.cross(fiber), normal);
}

float viewing_offset(const Vector3f& wo) {
  const float radial = std::hypot(wo.y(), wo.z());
  return radial > 0 ? std::clamp(-wo.y() / radial, -1.0f, 1.0f) : 0.0f;
}

ThreadExit exit_of(const CurveModel& model) {
  const auto* thread = std::get_if<ThreadModel<float>>(&model);
  return thread ? thread->exit() : ThreadExit::entry_point;
}

CurveLobes<float> lobes_at(const CurveModel& model, const CurvePoint& curve, const Matrix3f& frame,
                           const Vector3f& wo) {
  const Vector3f wo_local = frame * wo;
  const auto* thread = std::get_if<ThreadModel<float>>(&model);
  const float h = thread ? offset_in_section(curve, wo) : viewing_offset(wo_local);
  if (thread && (curve.absorption || curve.fiber.shade != 1)) {
    const auto& texel = curve.absorption;
    const Vector3f own = texel ? Vector3f((*texel)[0], (*texel)[1], (*texel)[2]) : thread->absorption();
    return thread->lobes_at(h, wo_local, curve.fiber.shade * own);
  }
  return std::visit([&](const auto& of) { return of.lobes_at(h, wo_local); }, model);
}

PathVertex::PathVertex(const SurfaceHit& hit, const Vector3f& wo, const std::vector<CurveModel>& models) {
  if (const auto* curve = std::get_if<CurvePoint>(&hit.point)) {
    is_curve_ = true;
    position_ = curve->position;
    local_from_world_ = local_from_world(*curve);
    const CurveModel& model = models[curve->curve_set];
    lobes_ = lobes_at(model, *curve, local_from_world_, wo);
    if (const ThreadExit rule = exit_of(model); rule != ThreadExit::entry_point) exits_.emplace(rule, *curve, wo);
  } else {
    const auto& mesh = std::get<MeshPoint>(hit.point);
    is_curve_ = false;
    position_ = mesh.position;
    albedo_ = mesh.albedo;
    const Vector3f side = mesh.normal.unitOrthogonal();
    local_from_world_ = frame_rows(side, mesh.normal.cross(side), mesh.normal);
    reflectance_factor_ = mesh.reflectance_factor;
    if (reflectance_factor_) wo_local_ = local_from_world_ * wo;
  }
}

ScatteringValue<float> PathVertex::evaluate(const Vector3f& wi) const {
  if (is_curve_) return lobes_.evaluate(local_from_world_ * wi);
  const float cosine = std::max(0.0f, local_from_world_.row(2).dot(wi)) * kInvPi;
  if (!reflectance_factor_ || cosine == 0.0f) return {albedo_ * cosine, cosine};
  const Vector3f wi_local = local_from_world_ * wi;
  const auto factor =
      static_cast<float>((*reflectance_factor_)(wi_local.z(), wo_local_.z(), cos_azimuth(wi_local, wo_local_)));
  return {albedo_ * (cosine * factor), cosine};
}

Vector3f PathVertex::sample(Sampler& sampler) const {
  const Eigen::Vector2f u = sampler.next_2d();
  Vector3f local;
  if (is_curve_) {
    const Eigen::Vector2f u_angles = sampler.next_2d();
    local = lobes_.sample(u.x(), u.y(), u_angles.x(), u_angles.y());
  } else {
    const float radius = std::sqrt(u.x()), phi = 2 * std::numbers::pi_v<float> * u.y();
    local = {radius * std::cos(phi), radius * std::sin(phi), std::sqrt(1 - u.x())};
  }
  return (local_from_world_.transpose() * local).normalized();
}

}  // namespace renderer
