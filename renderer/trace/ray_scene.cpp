#include "renderer/trace/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "renderer/trace/cloth_geometry.h"
#include "renderer/trace/cloth_query.h"
#include "renderer/trace/curve_geometry.h"

namespace renderer {
namespace {

using Eigen::Vector3f;

// How far above a mesh scattered rays start, relative to its coordinates.
constexpr float kMeshLift = 1e-5f;

// Share of the radius up to which yarns that lie in each other only touch: relaxation leaves less.
constexpr double kTouching = 0.02;

double overlap_of_yarns(const YarnPatch& patch) {
  double thinnest = std::numeric_limits<double>::infinity();
  for (const Yarn& yarn : patch.yarns) thinnest = std::min(thinnest, yarn.radius_mm);
  return -patch.least_gap_mm / thinnest;
}

constexpr float kEndless = std::numeric_limits<float>::infinity();

RTCRayHit nearest(RTCScene scene, const Ray& ray, ClothQuery& query, float distance) {
  RTCRayHit found{};
  found.ray = embree_ray(ray, distance);
  found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene, &query.context, &found);
  return found;
}

template <class Element>
std::size_t bytes_of(const std::vector<Element>& elements) {
  return elements.size() * sizeof(Element);
}

// Numbers of the segments with which a curve begins: segments that go on share control points.
std::vector<std::uint32_t> first_segments(const CurveSet& curves) {
  std::vector<std::uint32_t> first;
  for (std::uint32_t i = 0; i < curves.segments.size(); ++i)
    if (i == 0 || curves.segments[i] != curves.segments[i - 1] + 1) first.push_back(i);
  return first;
}

}  // namespace

RayScene::RayScene(Scene scene)
    : scene_(std::move(scene)), embree_bytes_(std::make_shared<std::atomic<std::int64_t>>(0)) {
  device_ = {rtcNewDevice(nullptr), rtcReleaseDevice};
  if (!device_)
    throw std::runtime_error("ray tracing: Embree could not start on this processor; it needs SSE2 or better");
  rtcSetDeviceMemoryMonitorFunction(
      device_.get(),
      [](void* bytes, ssize_t change, bool) {
        *static_cast<std::atomic<std::int64_t>*>(bytes) += change;
        return true;
      },
      embree_bytes_.get());
  embree_ = {rtcNewScene(device_.get()), rtcReleaseScene};
  rtcSetSceneBuildQuality(embree_.get(), RTC_BUILD_QUALITY_HIGH);
  for (const CurveSet& curves : scene_.curves) first_segments_.push_back(first_segments(curves));
  trees_ = curve_trees(device_.get(), scene_.curves);
  for (const TriangleMesh& mesh : scene_.meshes) add_mesh(mesh);
  auto curve_set = static_cast<std::uint32_t>(scene_.curves.size());
  for (const Cloth& cloth : scene_.cloths) {
    cloths_.push_back(std::make_shared<ClothGeometry>(cloth, curve_set));
    cloths_.back()->attach_to(device_.get(), embree_.get());
    curve_set += static_cast<std::uint32_t>(cloth.threads.size() + (cloth.flyaways ? 1 : 0));
    yarns_overlap_ |= overlap_of_yarns(cloth.patch) > kTouching;
  }
  rtcCommitScene(embree_.get());
  if (rtcGetDeviceError(device_.get()) != RTC_ERROR_NONE) {
    throw std::runtime_error(
        "ray tracing: Embree refused the scene; check its control points, triangles and free memory");
  }
  RTCBounds b;
  rtcGetSceneBounds(embree_.get(), &b);
  if (b.lower_x <= b.upper_x)
    bounds_ = {Eigen::Vector3d(b.lower_x, b.lower_y, b.lower_z), Eigen::Vector3d(b.upper_x, b.upper_y, b.upper_z)};
  for (const CurveTree& tree : trees_) curve_bounds_.extend(tree.bounds().cast<double>());
  bounds_.extend(curve_bounds_);
  if (!cloths_.empty()) curve_bounds_ = bounds_;
}

void RayScene::add_mesh(const TriangleMesh& mesh) {
  const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  // Copied, because Embree may read 16 bytes at the last vertex of a shared buffer.
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vector3f),
                                           mesh.vertices.size());
  std::copy(mesh.vertices.begin(), mesh.vertices.end(), static_cast<Vector3f*>(vertices));
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             sizeof(std::array<std::uint32_t, 3>), mesh.triangles.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(embree_.get(), geometry);
  rtcReleaseGeometry(geometry);
}

std::optional<CurveTree::Hit> RayScene::nearest_curve(const Ray& ray, float distance) const {
  std::optional<CurveTree::Hit> nearest;
  for (const CurveTree& tree : trees_)
    if (const auto hit = tree.nearest(ray, distance)) nearest = hit, distance = hit->distance;
  return nearest;
}

std::optional<RTCRayHit> RayScene::nearest_surface(const Ray& ray, float distance, ClothQuery& query) const {
  if (!has_surfaces()) return std::nullopt;
  const RTCRayHit found = nearest(embree_.get(), ray, query, distance);
  return found.hit.geomID == RTC_INVALID_GEOMETRY_ID ? std::optional<RTCRayHit>() : found;
}

std::optional<SurfaceHit> RayScene::intersect(const Ray& ray, float distance) const {
  const std::optional<CurveTree::Hit> curve = nearest_curve(ray, distance);
  ClothQuery query;
  if (const auto found = nearest_surface(ray, curve ? curve->distance : distance, query)) {
    const std::uint32_t geometry = found->hit.geomID;
    if (is_cloth(geometry))
      return SurfaceHit{found->ray.tfar, cloths_[number_of_cloth(geometry)]->point_at(query.cloth)};
    return SurfaceHit{found->ray.tfar, mesh_point(geometry, found->hit.primID, found->hit.u, found->hit.v, ray)};
  }
  if (!curve) return std::nullopt;
  CurvePoint point =
      point_on_curve(scene_.curves[curve->set], curve->segment, curve->u, curve->normal, ray, curve->distance);
  point.curve_set = curve->set;
  return SurfaceHit{curve->distance, point};
}

bool RayScene::occluded(const Ray& ray, float distance) const {
  for (const CurveTree& tree : trees_)
    if (tree.occluded(ray, distance)) return true;
  if (!has_surfaces()) return false;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay query = embree_ray(ray, distance);
  rtcOccluded1(embree_.get(), &context, &query);
  return query.tfar < 0;
}

std::optional<YarnPlace> RayScene::yarn_at(const Ray& ray) const {
  const std::optional<CurveTree::Hit> curve = nearest_curve(ray, kEndless);
  ClothQuery query;
  if (const auto found = nearest_surface(ray, curve ? curve->distance : kEndless, query)) {
    if (!is_cloth(found->hit.geomID)) return std::nullopt;
    const std::size_t cloth = number_of_cloth(found->hit.geomID);
    YarnPlace place = cloths_[cloth]->yarn_at(query.cloth);
    place.group = static_cast<std::uint32_t>(scene_.curves.size() + cloth);
    return place;
  }
  if (!curve) return std::nullopt;
  const std::vector<std::uint32_t>& first = first_segments_[curve->set];
  const auto after = std::upper_bound(first.begin(), first.end(), curve->segment);
  return YarnPlace{.group = curve->set, .number = static_cast<int>(after - first.begin()) - 1};
}

bool RayScene::meets_curve_first(const Ray& ray) const {
  const std::optional<CurveTree::Hit> curve = nearest_curve(ray, kEndless);
  ClothQuery query;
  const auto found = nearest_surface(ray, curve ? curve->distance : kEndless, query);
  return found ? is_cloth(found->hit.geomID) : curve.has_value();
}

std::size_t RayScene::yarn_bytes() const {
  std::size_t bytes = 0;
  for (const CurveSet& curves : scene_.curves) bytes += bytes_of(curves);
  for (const auto& cloth : cloths_) bytes += cloth->yarn_bytes();
  return bytes;
}

SceneMemory RayScene::memory() const {
  SceneMemory memory{.yarns = yarn_bytes(), .trees = static_cast<std::size_t>(embree_bytes_->load())};
  for (const CurveTree& tree : trees_) memory.trees += tree.bytes();
  for (const auto& cloth : cloths_) memory.surfaces += cloth->shell_bytes(), memory.trees += cloth->grid_bytes();
  for (const Cloth& cloth : scene_.cloths) {
    const ClothSurface& s = cloth.surface;
    memory.surfaces += bytes_of(s.vertices) + bytes_of(s.normals) + bytes_of(s.patch_mm) + bytes_of(s.triangles);
    if (cloth.absorption) memory.surfaces += cloth.absorption->sigma_a.total() * sizeof(cv::Vec3f);
  }
  for (const TriangleMesh& mesh : scene_.meshes)
    memory.surfaces += bytes_of(mesh.vertices) + bytes_of(mesh.triangles) + bytes_of(mesh.texture_coordinates) +
                       mesh.albedo.total() * mesh.albedo.elemSize();
  return memory;
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
  point.reflectance_factor = mesh.reflectance_factor ? &mesh.reflectance_factor : nullptr;
  return point;
}

}  // namespace renderer
