#include "tests/renderer/trace/light_tracer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <thread>

#include "renderer/scattering/exit_offsets.h"
#include "renderer/trace/path_vertex.h"
#include "renderer/trace/ray_scene.h"

namespace renderer {
namespace {

using Eigen::Array3d;
using Eigen::Matrix3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

// The least |n . wi| at which particles are traced. Rays in float lose particles that only graze a curve, |n . wi|
// below 0.005, which count most: when they were left out, direct light on scene a was 0.4 % too dark in red. What
// arrives below this cosine is taken to be what arrives between it and its double, because the density over the cosine
// is smooth.
constexpr float kGrazing = 0.01f;
constexpr int kMostCopies = 64;
constexpr int kBatches = 32;  // batches of particles, from which the error is found

void refuse_front_sides(const RTCFilterFunctionNArguments* arguments) {
  const auto* ray = reinterpret_cast<const RTCRay*>(arguments->ray);
  const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
  if (hit->Ng_x * ray->dir_x + hit->Ng_y * ray->dir_y + hit->Ng_z * ray->dir_z < 0) arguments->valid[0] = 0;
}

// The places where rays leave curves: the surfaces that RayScene lets pass.
class ExitScene {
 public:
  explicit ExitScene(const CurveSet& curves)
      : curves_(curves),
        device_(rtcNewDevice(nullptr), rtcReleaseDevice),
        scene_(rtcNewScene(device_.get()), rtcReleaseScene) {
    const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, curves.control_points.data(), 0,
                               sizeof(Eigen::Vector4f), curves.control_points.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, curves.segments.data(), 0,
                               sizeof(std::uint32_t), curves.segments.size());
    rtcSetGeometryIntersectFilterFunction(geometry, refuse_front_sides);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_.get());
  }

  // Farther than `after` along the ray.
  std::optional<SurfaceHit> first_exit(const Ray& ray, float after = 0) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray.org_x = ray.origin.x(), query.ray.org_y = ray.origin.y(), query.ray.org_z = ray.origin.z();
    query.ray.dir_x = ray.direction.x(), query.ray.dir_y = ray.direction.y(), query.ray.dir_z = ray.direction.z();
    query.ray.tnear = after;
    query.ray.tfar = std::numeric_limits<float>::infinity();
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return SurfaceHit{query.ray.tfar, point_at(query, ray)};
  }

  // For light that leaves a curve at `start`, just below the curve's surface: how far along wo that surface is.
  float own_surface(const CurvePoint& start, const Vector3f& wo) const {
    const Vector3f across = wo - wo.dot(start.tangent) * start.tangent;
    const float outer = start.out.norm() / (1 - 1e-3f), b = start.out.dot(across);
    const float a = across.squaredNorm(), c = start.out.squaredNorm() - outer * outer;
    const float expected = (-b + std::sqrt(b * b - a * c)) / a;  // of a straight curve
    const std::optional<SurfaceHit> exit = first_exit({start.position, wo});
    return exit && exit->distance < 1.5f * expected ? exit->distance : 0;
  }

 private:
  CurvePoint point_at(const RTCRayHit& query, const Ray& ray) const {
    const Eigen::Vector4f* p = &curves_.control_points[curves_.segments[query.hit.primID]];
    const float u = query.hit.u, w = 1 - u;
    const Eigen::Vector4f center =
        (w * w * w * p[0] + (4 + 3 * u * u * (u - 2)) * p[1] + (4 + 3 * w * w * (w - 2)) * p[2] + u * u * u * p[3]) / 6;
    CurvePoint point{};
    point.tangent =
        (-w * w * p[0] + u * (3 * u - 4) * p[1] - w * (3 * w - 4) * p[2] + u * u * p[3]).head<3>().normalized();
    const Vector3f from_center = ray.origin + query.ray.tfar * ray.direction - center.head<3>();
    point.normal = (from_center - from_center.dot(point.tangent) * point.tangent).normalized();
    point.out = center.w() * (1 - 1e-3f) * point.normal;
    point.side = point.out.cross(point.tangent);
    point.position = center.head<3>() + point.out;
    return point;
  }

  const CurveSet& curves_;
  std::shared_ptr<RTCDeviceTy> device_;
  std::shared_ptr<RTCSceneTy> scene_;
};

struct Particle {
  Vector3f origin, direction;
  Array3d weight;   // power
  int vertices;     // scattering events so far
  float after = 0;  // the origin lies below the curve that it has left; exits count from this distance on
};

struct Film {
  double width_mm, height_mm, distance_mm;  // of the frame at z = 0
  Vector3d eye;
};

class LightTracer {
 public:
  LightTracer(const Scene& scene, const Camera& camera, const Eigen::Vector2d& aim_mm, int most_vertices)
      : rays_(scene),
        exits_(rays_.scene().curves.front()),
        models_(prepare_curve_models(scattering_models(scene))),
        light_(scene.lights.front()),
        aim_mm_(aim_mm),
        most_vertices_(most_vertices) {
    film_.eye = camera.world_from_camera.translation();
    film_.distance_mm = film_.eye.z();
    film_.width_mm = camera.width * film_.distance_mm / camera.fx;
    film_.height_mm = camera.height * film_.distance_mm / camera.fy;
  }

  // Adds what one particle brings to the picture, by the number of vertices of its path less one.
  void add_particle(Sampler& sampler, std::vector<Array3d>& sums) const {
    std::vector<Particle> open{emitted(sampler)};
    const double reference = open.front().weight.maxCoeff();
    while (!open.empty()) {
      const Particle particle = open.back();
      open.pop_back();
      scatter(particle, reference, sampler, open, sums);
    }
  }

 private:
  Particle emitted(Sampler& sampler) const {
    const Eigen::Vector2d u = sampler.next_2d().cast<double>(), v = sampler.next_2d().cast<double>();
    const Eigen::AlignedBox3d& bounds = rays_.bounds();
    const Vector3d at(aim_mm_.x() * (2 * u.x() - 1), aim_mm_.y() * (2 * u.y() - 1), bounds.max().z() + 0.01);
    const Vector3d axis = (light_.center - at).normalized();
    const double sin2 = light_.radius_mm * light_.radius_mm / (light_.center - at).squaredNorm();
    const double one_minus_cos_most = sin2 / (1 + std::sqrt(1 - sin2)), one_minus_cos = v.x() * one_minus_cos_most;
    const double sine = std::sqrt(one_minus_cos * (2 - one_minus_cos)), phi = 2 * std::numbers::pi * v.y();
    const Vector3d side = axis.unitOrthogonal();
    const Vector3d towards =
        axis * (1 - one_minus_cos) + sine * (std::cos(phi) * side + std::sin(phi) * axis.cross(side));
    const double measure = 4 * aim_mm_.prod() * std::abs(towards.z()) * 2 * std::numbers::pi * one_minus_cos_most;
    return {at.cast<float>(), (-towards).cast<float>(), light_.radiance.array() * measure, 0};
  }

  // The places where the particle can be scattered.
  std::vector<SurfaceHit> places(const Particle& particle) const {
    const Ray ray{particle.origin, particle.direction};
    const std::optional<SurfaceHit> exit = exits_.first_exit(ray, particle.after);
    std::vector<SurfaceHit> found;
    Ray rest = ray;
    float gone = 0;
    for (;;) {
      const std::optional<SurfaceHit> entry = rays_.intersect(rest);
      if (!entry) break;
      gone += entry->distance;
      if (exit && gone > exit->distance) break;
      found.push_back(*entry);
      // Just below the surface that it entered: the way on from there meets other surfaces only.
      rest.origin = std::get<CurvePoint>(entry->point).position;
      if (found.size() > 16) break;
    }
    if (exit) found.push_back(*exit);
    return found;
  }

  static const CurvePoint& point(const SurfaceHit& hit) { return std::get<CurvePoint>(hit.point); }

  // From where on what leaves `at` along wo is outside of it.
  float after_leaving(const CurvePoint& at, const Vector3f& wo) const {
    return exits_.own_surface(at, wo) * (1 + 1e-5f) + 1e-6f;
  }

  // 1 / |n . wi|, with the part of those that only graze.
  static float arriving(const CurvePoint& at, const Vector3f& wi) {
    const float cosine = std::abs(at.normal.dot(wi));
    if (cosine < kGrazing) return 0;
    return (cosine < 2 * kGrazing ? 2 : 1) / cosine;
  }

  // f_cos |n . wo| / |n . wi| for light that leaves along wo.
  Array3d adjoint(const CurvePoint& at, const Vector3f& wo, const Vector3f& wi) const {
    const float leaving = at.normal.dot(wo);
    if (!(leaving > 0) || arriving(at, wi) == 0) return Array3d::Zero();
    const Matrix3f local = local_from_world(at);
    const Vector3f wo_local = local * wo;
    const auto lobes =
        std::visit([&](const auto& model) { return model.lobes_at(viewing_offset(wo_local), wo_local); }, models_[0]);
    return lobes.evaluate(local * wi).f_cos.template cast<double>() * static_cast<double>(leaving * arriving(at, wi));
  }

  void connect(const Particle& particle, const std::vector<SurfaceHit>& hits, std::vector<Array3d>& sums) const {
    for (const SurfaceHit& hit : hits) {
      const CurvePoint& at = point(hit);
      const Vector3d position = at.position.cast<double>(), to_eye = film_.eye - position;
      const double scale = film_.distance_mm / to_eye.z();
      if (std::abs(position.x() * scale) > film_.width_mm / 2 || std::abs(position.y() * scale) > film_.height_mm / 2)
        continue;
      const double distance = to_eye.norm(), cosine = to_eye.z() / distance;
      const Vector3f wo = (to_eye / distance).cast<float>();
      const Array3d scattered = adjoint(at, wo, -particle.direction);
      // Seen from the eye first: that way a ray enters no yarn before, so this way it leaves none.
      if (!(scattered.maxCoeff() > 0) || exits_.first_exit({at.position, wo}, after_leaving(at, wo))) continue;
      const double importance = film_.distance_mm * film_.distance_mm /
                                (film_.width_mm * film_.height_mm * distance * distance * cosine * cosine * cosine);
      sums[static_cast<std::size_t>(particle.vertices)] += particle.weight * scattered * importance;
    }
  }

  // Density of inclinations that the lobes draw, per sine.
  static float inclination_pdf(const CurveLobes<float>& lobes, const Vector3f& wo_local) {
    return (longitudinal_density(*lobes.widths, lobes.angles(wo_local)) * lobes.probability).sum();
  }

  // Of a place's normal, what is across the local x: where a yarn bends its tangents differ.
  static Vector3f outward_across(const SurfaceHit& hit, const Matrix3f& local) {
    Vector3f outward = local * point(hit).normal;
    outward.x() = 0;
    return outward.normalized();
  }

  // Of azimuths that are drawn evenly over the widths of the places, per angle.
  static double width_pdf(const std::vector<SurfaceHit>& hits, const Matrix3f& local, const Vector3f& wo_local) {
    const float radial = std::hypot(wo_local.y(), wo_local.z());
    if (!(radial > 0)) return 0;
    double sum = 0;
    for (const SurfaceHit& hit : hits) {
      const Vector3f outward = outward_across(hit, local);
      sum +=
          0.5 * std::max(0.0, static_cast<double>((outward.y() * wo_local.y() + outward.z() * wo_local.z()) / radial));
    }
    return sum / static_cast<double>(hits.size());
  }

  // A place of the thread that a particle has met at `from`, where the thread's section is `angle` away from the entry.
  static CurvePoint turned(const CurvePoint& from, float angle) {
    CurvePoint place = from;
    place.out = std::cos(angle) * from.out + std::sin(angle) * from.side;
    place.side = std::cos(angle) * from.side - std::sin(angle) * from.out;
    place.normal = place.out.normalized();
    place.position = from.position - from.out + place.out;
    return place;
  }

  // Moves the place of entry of a viewing ray along the thread to where light that meets the thread at `from` leaves it
  // along wo.
  static void move_along(const CurvePoint& from, const Vector3f& wo, CurvePoint& place) {
    constexpr float kMostSlope = 0.5f;
    const float along = -wo.dot(place.tangent), cosine = std::sqrt(std::max(1e-12f, 1 - along * along));
    const float slope = std::clamp(along / cosine, -kMostSlope, kMostSlope);
    place.position -= slope * (from.out - place.out).norm() * place.tangent;
  }

  // f_cos times the density of the offset at which the viewing ray would have left, over the cosine of wi's
  // inclination.
  Array3d wandering_adjoint(const CurvePoint& from, const CurvePoint& place, const Vector3f& wo,
                            const Vector3f& wi) const {
    const float cosine = place.tangent.cross(wi).norm();
    if (!(cosine > 1e-3f)) return Array3d::Zero();
    const float azimuth =
        std::atan2(wi.dot(place.out), wi.dot(place.side)) - std::atan2(wo.dot(place.out), wo.dot(place.side));
    const float density =
        simulated_exit_offsets().density(offset_in_section(place, wo), azimuth, -offset_in_section(from, wi));
    const Matrix3f local = local_from_world(place);
    const CurveLobes<float> lobes = lobes_at(models_[0], place, local, wo);
    return lobes.evaluate(local * wi).f_cos.template cast<double>() * static_cast<double>(density / cosine);
  }

  // Scattering of threads in which light wanders (light_exit.h): the particle enters a thread once, at the place where
  // a viewing ray would leave it, and leaves where that ray would come in. With |n . wo| per radian of the section
  // being cos theta_o per offset, nothing here is unbounded.
  void wander(const Particle& particle, double reference, Sampler& sampler, std::vector<Particle>& open,
              std::vector<Array3d>& sums) const {
    const std::optional<SurfaceHit> hit = rays_.intersect({particle.origin, particle.direction});
    if (!hit) return;
    const CurvePoint& from = point(*hit);
    const Vector3f wi = -particle.direction;
    const auto place_of = [&](const Vector3f& wo, float offset) {  // facing wo
      const float middle = std::atan2(wo.dot(from.side), wo.dot(from.out));
      return turned(from, middle + std::asin(offset));
    };
    connect_wandering(particle, from, place_of, sampler, sums);
    if (particle.vertices + 1 == most_vertices_) return;
    const double copies = std::min(particle.weight.maxCoeff() / reference, double{kMostCopies});
    const int count = static_cast<int>(copies + static_cast<double>(sampler.next_1d()));
    const Matrix3f local = local_from_world(from);
    const CurveLobes<float> lobes = lobes_at(models_[0], from, local, wi);
    for (int copy = 0; copy < count; ++copy) {
      const Eigen::Vector2f choose = sampler.next_2d(), u = sampler.next_2d(), v = sampler.next_2d();
      Vector3f wo_local = lobes.sample(choose.y(), u.x(), u.y(), v.x());
      const float cos_theta = std::hypot(wo_local.y(), wo_local.z()), phi = 2 * std::numbers::pi_v<float> * v.x();
      wo_local = {wo_local.x(), cos_theta * std::cos(phi), cos_theta * std::sin(phi)};
      const Vector3f wo = (local.transpose() * wo_local).normalized();
      CurvePoint place = place_of(wo, 2 * v.y() - 1);
      const double pdf = static_cast<double>(inclination_pdf(lobes, wo_local)) / (2 * std::numbers::pi) / 2;
      const Array3d scattered = wandering_adjoint(from, place, wo, wi) * static_cast<double>(cos_theta);
      if (!(scattered.maxCoeff() > 0)) continue;
      move_along(from, wo, place);
      open.push_back({place.position, wo, particle.weight * scattered / (pdf * copies), particle.vertices + 1});
    }
  }

  template <class PlaceOf>
  void connect_wandering(const Particle& particle, const CurvePoint& from, const PlaceOf& place_of, Sampler& sampler,
                         std::vector<Array3d>& sums) const {
    const Vector3f about = (film_.eye - from.position.cast<double>()).normalized().cast<float>();
    const float offset = 2 * sampler.next_1d() - 1;
    CurvePoint place = place_of(about, offset);
    const float facing = std::sqrt(std::max(0.0f, 1 - offset * offset));
    move_along(from, about, place);
    const Vector3d position = place.position.cast<double>(), to_eye = film_.eye - position;
    const double scale = film_.distance_mm / to_eye.z();
    if (std::abs(position.x() * scale) > film_.width_mm / 2 || std::abs(position.y() * scale) > film_.height_mm / 2)
      return;
    const double distance = to_eye.norm(), cosine = to_eye.z() / distance;
    const Vector3f wo = (to_eye / distance).cast<float>();
    const float leaving = place.normal.dot(wo);
    if (!(leaving > 0) || rays_.occluded({place.position, wo}, static_cast<float>(distance))) return;
    const double importance = film_.distance_mm * film_.distance_mm /
                              (film_.width_mm * film_.height_mm * distance * distance * cosine * cosine * cosine);
    sums[static_cast<std::size_t>(particle.vertices)] += particle.weight *
                                                         wandering_adjoint(from, place, wo, -particle.direction) *
                                                         (static_cast<double>(leaving / (0.5f * facing)) * importance);
  }

  void scatter(const Particle& particle, double reference, Sampler& sampler, std::vector<Particle>& open,
               std::vector<Array3d>& sums) const {
    if (exit_of(models_[0]) == ThreadExit::wandering) return wander(particle, reference, sampler, open, sums);
    const std::vector<SurfaceHit> hits = places(particle);
    if (hits.empty()) return;
    connect(particle, hits, sums);
    if (particle.vertices + 1 == most_vertices_) return;
    const Vector3f wi = -particle.direction;
    CurvePoint facing = point(hits.front());
    if (facing.normal.dot(wi) < 0) facing.normal = -facing.normal;
    const Matrix3f local = local_from_world(facing);
    const Vector3f wi_local = local * wi;
    const auto lobes =
        std::visit([&](const auto& model) { return model.lobes_at(viewing_offset(wi_local), wi_local); }, models_[0]);
    double most = 0;
    for (const SurfaceHit& hit : hits) most = std::max(most, static_cast<double>(arriving(point(hit), wi)));
    if (most == 0) return;
    const double copies = std::min(particle.weight.maxCoeff() / reference * most, double{kMostCopies});
    const int count = static_cast<int>(copies + static_cast<double>(sampler.next_1d()));
    for (int copy = 0; copy < count; ++copy) {
      const Eigen::Vector2f choose = sampler.next_2d(), u = sampler.next_2d(), v = sampler.next_2d();
      // Half of the directions are drawn as the model would draw them from the other end; half have the same
      // inclinations and are spread evenly over the width that the viewer sees of one of the places.
      Vector3f wo_local = lobes.sample(choose.y(), u.x(), u.y(), v.x());
      if (choose.x() < 0.5f) {
        const float which = v.y() * static_cast<float>(hits.size()), share = which - std::floor(which);
        const SurfaceHit& seen = hits[std::min(static_cast<std::size_t>(which), hits.size() - 1)];
        const Vector3f outward = outward_across(seen, local), side = Vector3f::UnitX().cross(outward);
        const float h = 2 * share - 1, cos_theta = std::sqrt(std::max(0.0f, 1 - wo_local.x() * wo_local.x()));
        const Vector3f across = std::sqrt(std::max(0.0f, 1 - h * h)) * outward + h * side;
        wo_local = (wo_local.x() * Vector3f::UnitX() + cos_theta * across.normalized()).normalized();
      }
      const Vector3f wo = local.transpose() * wo_local;
      const double pdf = 0.5 * static_cast<double>(lobes.evaluate(wo_local).pdf) +
                         0.5 * static_cast<double>(inclination_pdf(lobes, wo_local)) * width_pdf(hits, local, wo_local);
      Array3d all = Array3d::Zero();
      std::vector<Array3d> each;
      for (const SurfaceHit& hit : hits) all += each.emplace_back(adjoint(point(hit), wo, wi));
      if (!(all.sum() > 0)) continue;
      double left = static_cast<double>(sampler.next_1d()) * all.sum();
      std::size_t chosen = 0;
      while (chosen + 1 < each.size() && (left -= each[chosen].sum()) >= 0) ++chosen;
      if (!(each[chosen].sum() > 0)) continue;  // rounding
      const double chance = each[chosen].sum() / all.sum();
      const CurvePoint& from = point(hits[chosen]);
      open.push_back({from.position, wo, particle.weight * each[chosen] / (chance * pdf * copies),
                      particle.vertices + 1, after_leaving(from, wo)});
    }
  }

  RayScene rays_;
  ExitScene exits_;
  std::vector<CurveModel> models_;
  SphereLight light_;
  Eigen::Vector2d aim_mm_;
  int most_vertices_;
  Film film_;
};

}  // namespace

TracedLight trace_light(const Scene& scene, const Camera& camera, const Eigen::Vector2d& aim_mm, int most_vertices,
                        std::int64_t particles, std::uint64_t seed) {
  const LightTracer tracer(scene, camera, aim_mm, most_vertices);
  const auto lengths = static_cast<std::size_t>(most_vertices);
  std::vector<std::vector<Array3d>> batches(kBatches, std::vector<Array3d>(lengths, Array3d::Zero()));
  const std::int64_t each = particles / kBatches;
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int batch = next++; batch < kBatches; batch = next++) {
      auto& sums = batches[static_cast<std::size_t>(batch)];
      Sampler sampler(seed, static_cast<std::uint64_t>(batch));
      for (std::int64_t i = 0; i < each; ++i) {
        sampler.start_sample(static_cast<std::uint32_t>(i));
        tracer.add_particle(sampler, sums);
      }
      for (std::size_t k = 0; k < lengths; ++k) {
        sums[k] /= static_cast<double>(each);
        if (k > 0) sums[k] += sums[k - 1];
      }
    }
  };
  {
    std::vector<std::jthread> workers;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i) workers.emplace_back(work);
  }
  TracedLight result{.mean = std::vector<Array3d>(lengths, Array3d::Zero()), .standard_error = {}};
  for (std::size_t k = 0; k < lengths; ++k) {
    Array3d squares = Array3d::Zero();
    for (const auto& batch : batches) result.mean[k] += batch[k] / kBatches, squares += batch[k].square() / kBatches;
    result.standard_error.push_back(((squares - result.mean[k].square()).max(0.0) / (kBatches - 1)).sqrt());
  }
  return result;
}

}  // namespace renderer
