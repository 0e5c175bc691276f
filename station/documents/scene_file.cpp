#include "station/documents/scene_file.h"

#include <algorithm>
#include <numbers>
#include <set>
#include <stdexcept>

#include "renderer/picture/image_file.h"
#include "renderer/scene/mesh_file.h"
#include "renderer/scene/patch_curves.h"
#include "renderer/scene/studio.h"
#include "station/documents/bundle_file.h"
#include "station/documents/degree.h"
#include "station/documents/draft_file.h"
#include "station/documents/motif_file.h"
#include "station/documents/patch_file.h"
#include "station/documents/reader.h"

namespace station {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using nlohmann::json;

constexpr double kLeastSize = 0.01, kMostSize = 1e4;  // mm
constexpr double kMostCoordinate = 1e6;               // mm
constexpr double kSurroundings_mm = 1e7;              // radius of the sphere that an environment is
constexpr double kLeastTexel = 1e-4;                  // mm
constexpr double kMostDiameter = 10;                  // mm, of a sewing thread
constexpr double kMostAbsorption = 1000;              // per thread radius
constexpr int kMostSide = 16384;                      // pixels

Isometry3d pose(ObjectReader& reader, const std::string& key) {
  if (!reader.has(key)) return Isometry3d::Identity();
  const Isometry3d found = reader.transform(key);
  if (found.translation().cwiseAbs().maxCoeff() > kMostCoordinate)
    reader.refuse(key, "moves by more than a kilometre; lengths are millimetres");
  return found;
}

Vector3d point(ObjectReader& reader, const std::string& key) {
  const Vector3d found = reader.vector3(key);
  if (found.cwiseAbs().maxCoeff() > kMostCoordinate)
    reader.refuse(key, "lies more than a kilometre away; lengths are millimetres");
  return found;
}

void read_length(ObjectReader& reader, const char* key, double least, double& value) {
  if (reader.has(key)) value = reader.number(key, least, kMostSize);
}

double turn_rad(ObjectReader& reader) {
  return reader.has("turn_deg") ? reader.number("turn_deg", -360, 360) * kDegree : 0;
}

// What the file that "file" names holds; its errors name the scene as well.
template <class Read>
auto named_file(ObjectReader& reader, const std::filesystem::path& folder, const Read& read) {
  const std::filesystem::path file = folder / reader.text("file");
  try {
    return read(file);
  } catch (const std::runtime_error& problem) {
    reader.refuse("file", problem.what());
  }
}

renderer::MeshShape parse_mesh(ObjectReader& reader, const std::filesystem::path& folder) {
  renderer::MeshShape shape = named_file(reader, folder, [](const std::filesystem::path& file) {
    return renderer::MeshShape{.mesh = std::make_shared<renderer::UvMesh>(renderer::read_mesh(file)),
                               .name = file.string()};
  });
  shape.placement.unit_mm = reader.number("unit_mm", 1e-6, 1e6);
  if (reader.has("uv_mm")) shape.placement.uv_mm = reader.number("uv_mm", 1e-3, 1e6);
  return shape;
}

renderer::GarmentShape parse_garment(ObjectReader& reader, const std::string& kind) {
  constexpr double kLeastGarment = 10, kMostHem = 300;
  const auto read_hem = [&](double& hem_mm) {
    if (reader.has("hem_mm")) hem_mm = reader.number("hem_mm", 0, kMostHem);
  };
  if (kind == "skirt") {
    renderer::SkirtShape s;
    read_length(reader, "waist_radius_mm", kLeastGarment, s.waist_radius_mm);
    read_length(reader, "length_mm", kLeastGarment, s.length_mm);
    if (reader.has("flare_deg")) s.flare_deg = reader.number("flare_deg", 60, 360);
    if (reader.has("folds")) s.folds = reader.integer("folds", 3, 40);
    read_hem(s.hem_mm);
    return s;
  }
  if (kind == "pleats") {
    renderer::PleatedShape s;
    read_length(reader, "width_mm", kLeastGarment, s.width_mm);
    read_length(reader, "height_mm", kLeastGarment, s.height_mm);
    if (reader.has("pleats")) s.pleats = reader.integer("pleats", 2, 40);
    if (reader.has("gathered")) s.gathered = reader.number("gathered", 0.3, 0.9);
    read_hem(s.hem_mm);
    return s;
  }
  if (kind == "sari") {
    renderer::SariShape s;
    read_length(reader, "length_mm", kLeastGarment, s.length_mm);
    read_length(reader, "width_mm", kLeastGarment, s.width_mm);
    read_length(reader, "front_mm", kLeastGarment, s.front_mm);
    read_length(reader, "shoulder_radius_mm", kLeastGarment, s.shoulder_radius_mm);
    if (reader.has("pleats")) s.pleats = reader.integer("pleats", 2, 20);
    if (reader.has("gathered")) s.gathered = reader.number("gathered", 0.4, 0.9);
    if (reader.has("slope_deg")) s.slope_deg = reader.number("slope_deg", 0, 30);
    read_hem(s.hem_mm);
    return s;
  }
  renderer::DrapeShape s;
  read_length(reader, "side_mm", kLeastGarment, s.side_mm);
  read_length(reader, "ball_radius_mm", kLeastGarment, s.ball_radius_mm);
  return s;
}

renderer::MeshShape parse_backdrop(ObjectReader& reader) {
  renderer::BackdropShape s;
  read_length(reader, "radius_mm", kLeastSize, s.radius_mm);
  read_length(reader, "height_mm", kLeastSize, s.height_mm);
  read_length(reader, "bend_mm", kLeastSize, s.bend_mm);
  try {
    return {.mesh = std::make_shared<renderer::UvMesh>(renderer::backdrop_mesh(s)), .name = "the backdrop"};
  } catch (const std::runtime_error& problem) {
    reader.refuse("bend_mm", problem.what());
  }
}

renderer::MeshShape parse_form(ObjectReader& reader) {
  renderer::FormShape s;
  read_length(reader, "radius_mm", kLeastSize, s.radius_mm);
  read_length(reader, "height_mm", kLeastSize, s.height_mm);
  return {.mesh = std::make_shared<renderer::UvMesh>(renderer::form_mesh(s)), .name = "the dress form"};
}

SceneShape parse_shape(ObjectReader& reader, std::initializer_list<const char*> kinds,
                       const std::filesystem::path& folder) {
  const std::string kind = reader.choice("kind", kinds);
  if (kind == "cylinder") {
    const double radius_mm = reader.number("radius_mm", kLeastSize, kMostSize);
    return renderer::CylinderShape{radius_mm, reader.number("height_mm", kLeastSize, kMostSize)};
  }
  if (kind == "swatch" || kind == "plane") {
    const double width_mm = reader.number("width_mm", kLeastSize, kMostSize);
    return renderer::SwatchShape{width_mm, reader.number("height_mm", kLeastSize, kMostSize)};
  }
  if (kind == "backdrop") return parse_backdrop(reader);
  if (kind == "form") return parse_form(reader);
  if (kind != "mesh") {
    const renderer::GarmentShape garment = parse_garment(reader, kind);
    return SceneGarment{garment, turn_rad(reader)};
  }
  renderer::MeshShape shape = parse_mesh(reader, folder);
  shape.placement.turn_rad = turn_rad(reader);
  return shape;
}

std::variant<renderer::Draft, renderer::YarnPatch> parse_weave(ObjectReader& cloth,
                                                               const std::filesystem::path& folder) {
  if (cloth.has("patch") == cloth.has("draft"))
    cloth.refuse("draft", "give either a draft or a patch, not both and not none");
  if (cloth.has("patch")) return read_patch(folder / cloth.text("patch"));
  renderer::Draft draft = read_draft(folder / cloth.text("draft"));
  replace_threads(cloth, "warp_threads", draft.warp);
  replace_threads(cloth, "weft_threads", draft.weft);
  if (const auto problem = renderer::check_draft(draft)) cloth.refuse("draft", *problem);
  return draft;
}

renderer::AbsorptionTexture parse_absorption(ObjectReader reader, const std::filesystem::path& folder) {
  renderer::AbsorptionTexture texture;
  texture.sigma_a = named_file(reader, folder, [](const std::filesystem::path& file) {
    cv::Mat3f read = renderer::read_exr(file);
    for (const cv::Vec3f& texel : read)
      for (int c = 0; c < 3; ++c)
        if (!(texel[c] >= 0 && texel[c] <= static_cast<float>(kMostAbsorption)))
          throw std::runtime_error(file.string() + ": found an absorption of " + std::to_string(texel[c]) +
                                   ", expected 0 to " + std::to_string(static_cast<int>(kMostAbsorption)) +
                                   " per thread radius; make it with threadstation pattern");
    return read;
  });
  const std::vector<double> size = reader.numbers("texel_mm", 2, {kLeastTexel, kMostSize});
  texture.texel_mm = {size[0], size[1]};
  reader.finish();
  return texture;
}

// A draft's shades are drawn when it is woven: woven_cloth() checks them.
void check_threads(const ObjectReader& reader, const SceneCloth& cloth, std::size_t listed) {
  std::optional<std::string> problem;
  if (const auto* patch = std::get_if<renderer::YarnPatch>(&cloth.weave))
    problem = missing_thread(patch->name, renderer::threads_of(*patch), listed);
  else if (const auto& draft = std::get<renderer::Draft>(cloth.weave); draft.unevenness.shades == 1) {
    std::set<int> threads(draft.warp.threads.begin(), draft.warp.threads.end());
    threads.insert(draft.weft.threads.begin(), draft.weft.threads.end());
    problem = missing_thread(draft.name, {threads.begin(), threads.end()}, listed);
  }
  if (problem) reader.refuse("draft", *problem);
}

bool is_thread(const renderer::ScatteringModel& model) {
  return std::holds_alternative<renderer::ThreadParameters>(model);
}

SceneCloth parse_cloth(ObjectReader reader, const std::filesystem::path& folder,
                       const std::vector<renderer::ScatteringModel>& threads) {
  SceneCloth cloth{.weave = parse_weave(reader, folder)};
  check_threads(reader, cloth, threads.size());
  ObjectReader shape = reader.object("shape");
  cloth.shape = parse_shape(shape, {"swatch", "cylinder", "mesh", "skirt", "pleats", "drape", "sari"}, folder);
  shape.finish();
  cloth.world_from_cloth = pose(reader, "world_from_cloth");
  if (reader.has("method")) cloth.two_scale = reader.choice("method", {"two_scale", "brute_force"}) == "two_scale";
  if (reader.has("absorption")) {
    if (!cloth.two_scale) reader.refuse("absorption", "is for cloth in two scales; leave the method out");
    if (!std::ranges::all_of(threads, is_thread))
      reader.refuse("absorption", "is that of threads, and the scene lists a bundle file; list thread files");
    cloth.absorption = parse_absorption(reader.object("absorption"), folder);
  }
  if (reader.has("fibers")) {
    if (!cloth.two_scale) reader.refuse("fibers", "are for cloth in two scales; leave the method out");
    cloth.fibers = parse_cloth_fibers(reader, "fibers");
  }
  reader.finish();
  return cloth;
}

Eigen::Vector3d absorption_of(ObjectReader& reader, const json& rgb) {
  const bool numbers = rgb.is_array() && rgb.size() == 3 &&
                       std::all_of(rgb.begin(), rgb.end(), [](const json& value) { return value.is_number(); });
  Eigen::Vector3d found(-1, -1, -1);
  for (int c = 0; numbers && c < 3; ++c) found[c] = rgb[static_cast<std::size_t>(c)].get<double>();
  if (!(found.minCoeff() >= 0 && found.maxCoeff() <= kMostAbsorption))
    reader.refuse("sigma_a", "found " + rgb.dump() + ", expected R, G, B from 0 to 1000 per thread radius");
  return found;
}

SceneEmbroidery parse_embroidery(ObjectReader reader, const std::filesystem::path& folder, const SceneFile& scene) {
  SceneEmbroidery made;
  if (scene.cloths.empty()) reader.refuse("cloth", "the scene has no cloth to sew on; add one");
  if (scene.threads.empty()) reader.refuse("thread", "the scene lists no threads; add the one to sew with");
  made.cloth = reader.integer("cloth", 0, static_cast<int>(scene.cloths.size()) - 1);
  made.motif = read_motif(folder / reader.text("motif"));
  const int thread = reader.integer("thread", 0, static_cast<int>(scene.threads.size()) - 1);
  const auto* sewn = std::get_if<renderer::ThreadParameters>(&scene.threads[static_cast<std::size_t>(thread)]);
  if (!sewn)
    reader.refuse("thread", "is a bundle file; stitches are coloured by a thread's absorption, list its thread file");
  made.diameter_mm = reader.number("diameter_mm", kLeastSize, kMostDiameter);
  const json& absorptions = reader.raw("sigma_a");
  if (!absorptions.is_array() || absorptions.size() != made.motif.threads.size())
    reader.refuse("sigma_a", "expected a list with R, G, B for each of the motif's " +
                                 std::to_string(made.motif.threads.size()) + " threads");
  for (const json& rgb : absorptions) {
    made.threads.push_back(*sewn);
    made.threads.back().sigma_a = absorption_of(reader, rgb);
  }
  if (reader.has("at_mm")) {
    const std::vector<double> at = reader.numbers("at_mm", 2, {-kMostCoordinate, kMostCoordinate});
    made.at_mm = Eigen::Vector2d(at[0], at[1]);
  }
  made.turn_rad = turn_rad(reader);
  reader.finish();
  return made;
}

Vector3d at_least_zero(ObjectReader& reader, const std::string& key, double most) {
  const Vector3d found = reader.vector3(key);
  if (!(found.minCoeff() >= 0 && found.maxCoeff() <= most))
    reader.refuse(key, "found " + to_json(found).dump() + ", expected R, G, B from 0 to " + json(most).dump());
  return found;
}

SceneBody parse_object(ObjectReader reader, const std::filesystem::path& folder) {
  SceneBody body;
  body.shape = parse_shape(reader, {"plane", "cylinder", "mesh", "backdrop", "form"}, folder);
  body.world_from_object = pose(reader, "world_from_object");
  const Vector3d albedo = at_least_zero(reader, "albedo", 1);
  for (int c = 0; c < 3; ++c) body.albedo[c] = static_cast<float>(albedo[c]);
  reader.finish();
  return body;
}

constexpr double kMostRadiance = 1e12;

// A plain number is a white light's.
Vector3d white_or_rgb(ObjectReader& reader, const std::string& key) {
  return reader.is_number(key) ? Vector3d::Constant(reader.number(key, 0, kMostRadiance))
                               : at_least_zero(reader, key, kMostRadiance);
}

// Given as such, or as the intensity of a light that is seen head-on with that area.
Vector3d parse_radiance(ObjectReader& reader, double area_mm2) {
  if (reader.has("radiance") == reader.has("intensity_mm2"))
    reader.refuse("radiance", "give either radiance or intensity_mm2, not both and not none");
  if (reader.has("radiance")) return white_or_rgb(reader, "radiance");
  return white_or_rgb(reader, "intensity_mm2") / area_mm2;
}

renderer::SphereLight parse_sphere(ObjectReader& reader) {
  renderer::SphereLight light;
  light.center = point(reader, "position_mm");
  light.radius_mm = reader.number("radius_mm", 1e-3, kMostCoordinate);
  light.radiance = parse_radiance(reader, std::numbers::pi * light.radius_mm * light.radius_mm);
  return light;
}

renderer::RectangleLight parse_rectangle(ObjectReader& reader) {
  renderer::RectangleLight light;
  light.center = point(reader, "position_mm");
  const Vector3d toward = point(reader, "target_mm") - light.center;
  const Vector3d up = reader.has("up") ? reader.vector3("up") : Vector3d::UnitZ();
  if (!(toward.norm() > 0)) reader.refuse("target_mm", "is where the light is; let it shine somewhere else");
  if (!(up.cross(toward).norm() > 1e-6 * up.norm() * toward.norm()))
    reader.refuse("up", "points along the light's axis (its default is [0, 0, 1]); give the direction of its height");
  const double width_mm = reader.number("width_mm", 1e-3, kMostCoordinate),
               height_mm = reader.number("height_mm", 1e-3, kMostCoordinate);
  const Vector3d across = up.cross(toward).normalized();
  light.edge_x = width_mm * across;
  light.edge_y = height_mm * toward.cross(across).normalized();
  light.radiance = parse_radiance(reader, width_mm * height_mm);
  return light;
}

void parse_light(ObjectReader reader, SceneFile& scene) {
  const std::string kind = reader.choice("kind", {"sphere", "rectangle", "environment"});
  const bool visible = !reader.has("visible") || reader.flag("visible");
  if (kind == "rectangle") {
    scene.rectangles.push_back(parse_rectangle(reader));
    scene.rectangles.back().visible = visible;
  } else {
    scene.lights.push_back(kind == "sphere" ? parse_sphere(reader)
                                            : renderer::SphereLight{.radius_mm = kSurroundings_mm});
    if (kind == "environment") scene.lights.back().radiance = white_or_rgb(reader, "radiance");
    scene.lights.back().visible = visible;
  }
  reader.finish();
}

// An environment that has a file is a picture, of which there can be one.
void parse_surroundings(ObjectReader reader, const std::filesystem::path& folder, SceneFile& scene) {
  reader.choice("kind", {"environment"});
  if (scene.surroundings) reader.refuse("file", "there are surroundings already; give one picture of them");
  renderer::EnvironmentLight light = named_file(reader, folder, [](const std::filesystem::path& file) {
    renderer::EnvironmentLight read{.radiance = renderer::read_exr(file)};
    try {
      renderer::check_radiances(read.radiance);
    } catch (const std::runtime_error& problem) {
      throw std::runtime_error(file.string() + ": " + problem.what());
    }
    return read;
  });
  if (reader.has("scale")) light.radiance *= reader.number("scale", 1e-9, 1e9);
  light.turn_rad = turn_rad(reader);
  if (reader.has("visible")) light.visible = reader.flag("visible");
  reader.finish();
  scene.surroundings = std::move(light);
}

renderer::Camera parse_scene_camera(ObjectReader reader) {
  const Vector3d eye = point(reader, "eye_mm"), target = point(reader, "target_mm");
  const Vector3d up = reader.has("up") ? reader.vector3("up") : Vector3d::UnitZ();
  if (!((target - eye).norm() > 0)) reader.refuse("target_mm", "is where the eye is; look at something else");
  if (!(up.cross(target - eye).norm() > 1e-6 * up.norm() * (target - eye).norm()))
    reader.refuse("up", "points along the view (its default is [0, 0, 1]); give a direction that is up in the picture");
  renderer::Camera camera = renderer::look_at(eye, target, up);
  camera.width = reader.integer("width_px", 1, kMostSide);
  camera.height = reader.integer("height_px", 1, kMostSide);
  if (static_cast<double>(camera.width) * camera.height > renderer::kMostPicturePixels)
    reader.refuse("width_px", "the picture has more than 100 million pixels; make it smaller");
  camera.fx = camera.fy = reader.number("focal_length_px", 1, 1e7);
  camera.cx = (camera.width - 1) / 2.0, camera.cy = (camera.height - 1) / 2.0;
  camera.focus_mm = (target - eye).norm();
  if (reader.has("aperture_mm")) camera.aperture_mm = reader.number("aperture_mm", 0, kMostSize);
  if (reader.has("focus_mm")) camera.focus_mm = reader.number("focus_mm", 1, kMostCoordinate);
  reader.finish();
  return camera;
}

WhiteCard parse_white_card(ObjectReader reader) {
  const WhiteCard card{.position_mm = point(reader, "position_mm"), .normal = reader.vector3("normal")};
  if (!(card.normal.norm() > 0)) reader.refuse("normal", "has no direction; give one that the card faces");
  reader.finish();
  return card;
}

void read_threads(ObjectReader& reader, const std::filesystem::path& folder, SceneFile& scene) {
  const json& names = reader.raw("threads");
  if (!names.is_array()) reader.refuse("threads", "expected a list of thread files");
  for (const json& name : names) {
    if (!name.is_string()) reader.refuse("threads", "found " + name.dump() + ", expected the name of a thread file");
    const ClothThread thread = read_cloth_thread(folder / name.get<std::string>());
    if (scene.threads.empty()) scene.linear_srgb_from_camera = thread.linear_srgb_from_camera;
    scene.threads.push_back(thread.scattering);
  }
}

}  // namespace

std::optional<std::string> missing_thread(const std::string& cloth, const std::vector<int>& threads,
                                          std::size_t listed) {
  for (const int thread : threads)
    if (static_cast<std::size_t>(thread) >= listed)
      return "\"" + cloth + "\" has a yarn of thread " + std::to_string(thread) + ", but the scene lists " +
             std::to_string(listed) + " threads (counted from 0); add the thread or change the order of threads";
  return std::nullopt;
}

SceneFile parse_scene(const json& document, const std::string& source, const std::filesystem::path& folder) {
  ObjectReader reader(document, source, "scene");
  SceneFile scene{.source = source};
  scene.name = reader.text("name");
  read_threads(reader, folder, scene);
  for (const ObjectReader& cloth : reader.objects("cloths"))
    scene.cloths.push_back(parse_cloth(cloth, folder, scene.threads));
  if (reader.has("embroideries"))
    for (const ObjectReader& embroidery : reader.objects("embroideries"))
      scene.embroideries.push_back(parse_embroidery(embroidery, folder, scene));
  if (reader.has("objects"))
    for (const ObjectReader& object : reader.objects("objects")) scene.objects.push_back(parse_object(object, folder));
  for (const ObjectReader& light : reader.objects("lights"))
    if (light.has("file"))
      parse_surroundings(light, folder, scene);
    else
      parse_light(light, scene);
  if (scene.lights.empty() && scene.rectangles.empty() && !scene.surroundings)
    reader.refuse("lights", "the list is empty and the picture would be black; add a light");
  scene.camera = parse_scene_camera(reader.object("camera"));
  if (reader.has("samples_per_pixel")) scene.samples_per_pixel = reader.integer("samples_per_pixel", 1, 1 << 20);
  if (reader.has("exposure")) scene.brightness = reader.number("exposure", 1e-12, 1e12);
  if (reader.has("white_card")) scene.white_card = parse_white_card(reader.object("white_card"));
  reader.finish();
  return scene;
}

SceneFile read_scene(const std::filesystem::path& file) {
  return parse_scene(read_json_file(file), file.string(), file.parent_path());
}

}  // namespace station
