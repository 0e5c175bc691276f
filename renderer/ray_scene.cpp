#include "renderer/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace renderer {
namespace {

using Eigen::Vector3f;

// How far below the surface scattered rays start, in curve radii: well above rounding of positions, far below a
// radius.
constexpr float kStartDepth = 1e-3f;
// How far above a mesh they start, relative to its coordinates.
constexpr float kMeshLift = 1e-5f;

// Embree calls this for each candidate hit of a curve: 0 refuses it.
void refuse_back_sides(const RTCFilterFunctionNArguments* arguments) {
  const auto* ray = reinterpret_cast<const RTCRay*>(arguments->ray);
  const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
  if (hit->Ng_x * ray->dir_x + hit->Ng_y * ray->dir_y + hit->Ng_z * ray->dir_z > 0) arguments->valid[0] = 0;
}

RTCRay embree_ray(const Ray& ray, float distance) {
  RTCRay r{};
  r.org_x = ray.origin.x(), r.org_y = ray.origin.y(), r.org_z = ray.origin.z();
  r.dir_x = ray.direction.x(), r.dir_y = ray.direction.y(), r.dir_z = ray.direction.z();
  r.tnear = 0;
  r.tfar = distance;
  r.mask = ~0u;
  return r;
}

RTCRayHit nearest(RTCScene scene, const Ray& ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray = embree_ray(ray, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene, &context, &query);
  return query;
}

Vector3f across(const Vector3f& v, const Vector3f& unit_axis) {
  return v - v.dot(unit_axis) * unit_axis;
}

// Embree's iteration for round curves stops up to 0.002 radii early. This finishes it on the cylinder that touches
// the curve there: the outward normal where a ray, already close to the surface at `point` (relative to the axis),
// enters it.
std::optional<Vector3f> cylinder_normal(const Vector3f& point, const Vector3f& direction, const Vector3f& axis,
                                        float radius) {
  const Vector3f o = across(point, axis), d = across(direction, axis);
  const float a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - radius * radius;
  const float root2 = b * b - a * c;
  if (!(root2 >= 0 && a > 0)) return std::nullopt;  // rounding at the silhouette, or a ray along the axis
  const float step = (-b - std::sqrt(root2)) / a;
  if (std::abs(step) > 0.5f * radius) return std::nullopt;
  return (o + step * d).normalized();
}

void attach(RTCScene scene, RTCGeometry geometry) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

}  // namespace

RayScene::RayScene(Scene scene) : scene_(std::move(scene)) {
  device_ = {rtcNewDevice(nullptr), rtcReleaseDevice};
  if (!device_)
    throw std::runtime_error("ray tracing: Embree could not start on this processor; it needs SSE2 or better");
  embree_ = {rtcNewScene(device_.get()), rtcReleaseScene};
  rtcSetSceneBuildQuality(embree_.get(), RTC_BUILD_QUALITY_HIGH);
  for (const CurveSet& curves : scene_.curves) add_curves(curves);
  for (const TriangleMesh& mesh : scene_.meshes) add_mesh(mesh);
  rtcCommitScene(embree_.get());
  if (rtcGetDeviceError(device_.get()) != RTC_ERROR_NONE) {
    throw std::runtime_error(
        "ray tracing: Embree refused the scene; check its control points, triangles and free memory");
  }
  RTCBounds b;
  rtcGetSceneBounds(embree_.get(), &b);
  if (b.lower_x <= b.upper_x) {
    bounds_ = {Eigen::Vector3d(b.lower_x, b.lower_y, b.lower_z), Eigen::Vector3d(b.upper_x, b.upper_y, b.upper_z)};
  }
}

void RayScene::add_curves(const CurveSet& curves) {
  const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, curves.control_points.data(), 0,
                             sizeof(Eigen::Vector4f), curves.control_points.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, curves.segments.data(), 0,
                             sizeof(std::uint32_t), curves.segments.size());
  rtcSetGeometryIntersectFilterFunction(geometry, refuse_back_sides);
  rtcSetGeometryOccludedFilterFunction(geometry, refuse_back_sides);
  attach(embree_.get(), geometry);
}

void RayScene::add_mesh(const TriangleMesh& mesh) {
  const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  // Copied, because Embree may read 16 bytes at the last vertex of a shared buffer.
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vector3f),
                                           mesh.vertices.size());
  std::copy(mesh.vertices.begin(), mesh.vertices.end(), static_cast<Vector3f*>(vertices));
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             sizeof(std::array<std::uint32_t, 3>), mesh.triangles.size());
  attach(embree_.get(), geometry);
}

std::optional<SurfaceHit> RayScene::intersect(const Ray& ray) const {
  const RTCRayHit found = nearest(embree_.get(), ray);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const auto curve_sets = static_cast<std::uint32_t>(scene_.curves.size());
  if (found.hit.geomID < curve_sets) {
    const Vector3f normal(found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z);
    return SurfaceHit{found.ray.tfar,
                      curve_point(found.hit.geomID, found.hit.primID, found.hit.u, normal, ray, found.ray.tfar)};
  }
  return SurfaceHit{found.ray.tfar,
                    mesh_point(found.hit.geomID - curve_sets, found.hit.primID, found.hit.u, found.hit.v, ray)};
}

bool RayScene::occluded(const Ray& ray, float distance) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay query = embree_ray(ray, distance);
  rtcOccluded1(embree_.get(), &context, &query);
  return query.tfar < 0;
}

bool RayScene::meets_curve_first(const Ray& ray) const {
  const RTCRayHit found = nearest(embree_.get(), ray);
  return found.hit.geomID != RTC_INVALID_GEOMETRY_ID && found.hit.geomID < scene_.curves.size();
}

CurvePoint RayScene::curve_point(std::uint32_t set, std::uint32_t segment, float u, const Vector3f& hit_normal,
                                 const Ray& ray, float distance) const {
  const CurveSet& curves = scene_.curves[set];
  const Eigen::Vector4f* p = &curves.control_points[curves.segments[segment]];
  const float w = 1 - u;
  const Eigen::Vector4f center =
      (w * w * w * p[0] + (4 + 3 * u * u * (u - 2)) * p[1] + (4 + 3 * w * w * (w - 2)) * p[2] + u * u * u * p[3]) / 6;
  const Vector3f derivative =
      (-w * w * p[0] + u * (3 * u - 4) * p[1] - w * (3 * w - 4) * p[2] + u * u * p[3]).head<3>();
  CurvePoint point;
  point.curve_set = set;
  point.tangent = derivative.normalized();
  point.normal = across(hit_normal, point.tangent).normalized();
  const Vector3f from_center = ray.origin + distance * ray.direction - center.head<3>();
  if (const auto exact = cylinder_normal(from_center, ray.direction, point.tangent, center.w()))
    point.normal = *exact;
  point.position = center.head<3>() + center.w() * (1 - kStartDepth) * point.normal;
  return point;
}

MeshPoint RayScene::mesh_point(std::uint32_t mesh_index, std::uint32_t triangle, float u, float v,
                               const Ray& ray) const {
  const TriangleMesh& mesh = scene_.meshes[mesh_index];
  const auto& corner = mesh.triangles[triangle];
  const Vector3f &a = mesh.vertices[corner[0]], &b = mesh.vertices[corner[1]], &c = mesh.vertices[corner[2]];
  MeshPoint point;
  point.mesh = mesh_index;
  point.normal = (b - a).cross(c - a).normalized();
  if (point.normal.dot(ray.direction) > 0) point.normal = -point.normal;
  const Vector3f surface = (1 - u - v) * a + u * b + v * c;
  point.position = surface + kMeshLift * (1 + surface.cwiseAbs().maxCoeff()) * point.normal;
  Eigen::Vector2f texture(0, 0);
  if (!mesh.texture_coordinates.empty()) {
    const auto& t = mesh.texture_coordinates;
    texture = (1 - u - v) * t[corner[0]] + u * t[corner[1]] + v * t[corner[2]];
  }
  const auto texel = [](float position, int size) {
    return std::clamp(static_cast<int>(position * static_cast<float>(size)), 0, size - 1);
  };
  const cv::Vec3f& albedo = mesh.albedo(texel(texture.y(), mesh.albedo.rows), texel(texture.x(), mesh.albedo.cols));
  point.albedo = {albedo[0], albedo[1], albedo[2]};
  return point;
}

}  // namespace renderer
