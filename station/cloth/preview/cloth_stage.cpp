#include "station/cloth/preview/cloth_stage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "station/data/data_folder.h"
#include "station/documents/reader.h"

namespace station {
namespace {

using Eigen::Vector3d;
using nlohmann::json;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMostTurn_deg = 360, kLeastZoom = 0.25, kMostZoom = 20;

Vector3d vector_of(const json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}

struct Turning {
  Vector3d middle, up;
  bool above_floor;  // z = 0

  Vector3d turned(const Vector3d& place, double turn_deg, double tilt_deg) const {
    constexpr double kSteepest = 88 * kDegree, kAboveFloor_mm = 20;
    if (turn_deg == 0 && tilt_deg == 0) return place;
    const Vector3d offset = place - middle;
    const double distance = offset.norm(), height = offset.dot(up);
    const double floor = std::asin(std::clamp((kAboveFloor_mm - middle.z()) / distance, -1.0, 1.0));
    const double lowest = above_floor ? std::max(floor, -kSteepest) : -kSteepest;
    const double elevation = std::clamp(std::asin(height / distance) + tilt_deg * kDegree, lowest, kSteepest);
    const Vector3d ahead = Eigen::AngleAxisd(turn_deg * kDegree, up) * (offset - height * up).normalized();
    return middle + distance * (std::cos(elevation) * ahead + std::sin(elevation) * up);
  }
};

// All lengths of the stage times `factor`, about the origin; what is lit stays as bright.
void enlarge(json& scene, double factor) {
  const auto times = [](json& part, const char* key, double by) {
    if (!part.contains(key)) return;
    json& value = part[key];
    if (value.is_number()) value = value.get<double>() * by;
    if (value.is_array())
      for (json& number : value) number = number.get<double>() * by;
  };
  for (const char* key : {"eye_mm", "target_mm", "aperture_mm", "focus_mm"}) times(scene["camera"], key, factor);
  for (json& lamp : scene["lights"]) {
    for (const char* key : {"position_mm", "target_mm", "radius_mm", "width_mm", "height_mm"}) times(lamp, key, factor);
    times(lamp, "intensity_mm2", factor * factor);
  }
  for (json& object : scene["objects"])
    for (const char* key : {"radius_mm", "height_mm", "bend_mm", "width_mm"}) times(object, key, factor);
  times(scene["white_card"], "position_mm", factor);
}

void put_mesh(json& scene, const StagedMesh& mesh) {
  constexpr double kOwn_mm = 1000;  // the diagonal of the cloth that the stage was made for
  const Vector3d middle = mesh.box_mm.center();
  enlarge(scene, mesh.box_mm.diagonal().norm() / kOwn_mm);
  json& cloth = scene["cloths"].at(0);
  cloth["shape"] = {{"kind", "mesh"}, {"file", mesh.file}, {"unit_mm", mesh.unit_mm}};
  Eigen::Isometry3d on_floor = Eigen::Isometry3d::Identity();
  on_floor.translation() = Vector3d(-middle.x(), -middle.y(), -mesh.box_mm.min().z());
  cloth["world_from_cloth"] = to_json(on_floor);
  scene["camera"]["target_mm"] = to_json(Vector3d(0, 0, mesh.box_mm.sizes().z() / 2));
}

// The scene's first lamp alone, moved to where it lights from the asked side; or none but the surroundings.
void light(json& scene, const std::string& lights) {
  json& lamps = scene["lights"];
  if (lights == "even") {
    lamps = {{{"kind", "environment"}, {"radiance", 1}, {"visible", false}}};
    return;
  }
  if (!std::ranges::count(cloth_lights(), lights)) {
    lamps = {{{"kind", "environment"}, {"file", lights}}};
    return;
  }
  const json& camera = scene["camera"];
  const Vector3d middle = vector_of(camera["target_mm"]),
                 up = vector_of(camera.value("up", json{0, 0, 1})).normalized(),
                 towards_eye = (vector_of(camera["eye_mm"]) - middle).normalized(),
                 right = up.cross(towards_eye).normalized();
  const auto placed = std::ranges::find_if(lamps, [](const json& lamp) { return lamp.contains("position_mm"); });
  json lamp = placed == lamps.end() ? json() : *placed;
  if (lamp.is_null()) throw std::logic_error("a stage without a lamp that stands somewhere");
  const double distance = (vector_of(lamp["position_mm"]) - middle).norm();
  Vector3d direction = towards_eye + 0.3 * up;
  if (lights == "side") direction = right + 0.25 * towards_eye + 0.2 * up;
  if (lights == "behind") direction = -towards_eye + 0.5 * up;
  lamp["position_mm"] = to_json(Vector3d(middle + distance * direction.normalized()));
  lamp["visible"] = false;
  lamps = json::array({lamp});
  scene.erase("white_card");  // the lamp may not shine on its face; whoever shows the picture knows the studio's
}

bool is_floor(const json& object) {
  return object["kind"] == "plane" || object["kind"] == "backdrop";
}

}  // namespace

const std::vector<ClothStage>& cloth_stages() {
  static const std::vector<ClothStage> stages{
      {"swatch", "twill_swatch.json", 720, 720, 32}, {"cylinder", "satin_cylinder.json", 480, 720, 32},
      {"skirt", "satin_skirt.json", 617, 720, 64},   {"pleats", "twill_pleats.json", 540, 720, 64},
      {"drape", "satin_drape.json", 720, 540, 64},   {"sari", "satin_sari.json", 360, 720, 64}};
  return stages;
}

std::vector<std::string> cloth_shapes() {
  std::vector<std::string> shapes;
  for (const ClothStage& stage : cloth_stages()) shapes.push_back(stage.shape);
  return shapes;
}

const ClothStage& cloth_stage(const std::string& shape) {
  static const ClothStage of_meshes{kMeshShape, "satin_drape.json", 720, 540, 64};
  if (shape == kMeshShape) return of_meshes;
  const auto found = std::ranges::find(cloth_stages(), shape, &ClothStage::shape);
  if (found == cloth_stages().end())
    throw std::runtime_error("there is no shape '" + shape +
                             "' for cloth; take swatch, cylinder, skirt, pleats, drape or sari");
  return *found;
}

double scale_to(const ClothStage& stage, int longer_side_px) {
  return static_cast<double>(longer_side_px) / std::max(stage.width_px, stage.height_px);
}

json to_json(const ClothView& view) {
  return {{"turn_deg", view.turn_deg},
          {"tilt_deg", view.tilt_deg},
          {"light_turn_deg", view.light_turn_deg},
          {"light_tilt_deg", view.light_tilt_deg},
          {"zoom", view.zoom}};
}

ClothView cloth_view_of(const json& document) {
  const auto number = [&](const char* key, double otherwise) {
    const auto found = document.find(key);
    if (found == document.end()) return otherwise;
    return found->is_number() ? found->get<double>() : std::numeric_limits<double>::quiet_NaN();
  };
  return {number("turn_deg", 0), number("tilt_deg", 0), number("light_turn_deg", 0), number("light_tilt_deg", 0),
          number("zoom", 1)};
}

std::optional<std::string> problem_of(const ClothView& view) {
  for (const double angle : {view.turn_deg, view.tilt_deg, view.light_turn_deg, view.light_tilt_deg})
    if (!(std::abs(angle) <= kMostTurn_deg))
      return "cannot turn view or light by more than 360 degrees; give -360 to 360";
  if (!(view.zoom >= kLeastZoom && view.zoom <= kMostZoom)) return "cannot zoom so far; give 0.25 to 20";
  return std::nullopt;
}

const std::vector<std::string>& cloth_lights() {
  static const std::vector<std::string> lights{"studio", "front", "side", "behind", "even"};
  return lights;
}

json scene_on_stage(const ClothStage& stage, const OnStage& shown, const ClothView& view, double scale) {
  json scene = read_json_file(data_folder() / "scenes" / stage.scene);
  scene["name"] = "the thread as a " + stage.shape;
  scene["threads"] = shown.threads;
  if (shown.mesh) put_mesh(scene, *shown.mesh);
  if (shown.lights != "studio") light(scene, shown.lights);
  for (json& cloth : scene["cloths"]) {
    for (const char* key : {"draft", "warp_threads", "weft_threads"}) cloth.erase(key);
    cloth["patch"] = "patch.json";
    if (!shown.fibers.empty()) cloth["fibers"] = shown.fibers;
  }
  json& camera = scene["camera"];
  const Turning turning{.middle = vector_of(camera["target_mm"]),
                        .up = vector_of(camera.value("up", json{0, 0, 1})).normalized(),
                        .above_floor = scene.contains("objects") && std::ranges::any_of(scene["objects"], is_floor)};
  camera["eye_mm"] = to_json(turning.turned(vector_of(camera["eye_mm"]), view.turn_deg, view.tilt_deg));
  for (json& light : scene["lights"])
    if (light.contains("position_mm"))
      light["position_mm"] =
          to_json(turning.turned(vector_of(light["position_mm"]), view.light_turn_deg, view.light_tilt_deg));
  const double enlarged = scale * stage.width_px / camera["width_px"].get<double>();
  camera["width_px"] = std::max(1, static_cast<int>(std::lround(scale * stage.width_px)));
  camera["height_px"] = std::max(1, static_cast<int>(std::lround(scale * stage.height_px)));
  camera["focal_length_px"] = camera["focal_length_px"].get<double>() * enlarged * view.zoom;
  scene["samples_per_pixel"] = stage.samples_per_pixel;
  return scene;
}

}  // namespace station
