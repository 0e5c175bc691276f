#include "station/cloth/export/u3m_file.h"

#include <algorithm>

#include "renderer/picture/image_file.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/reader.h"

namespace station {
namespace {

using Eigen::Array3d;
using nlohmann::json;

constexpr double kInch_mm = 25.4;
constexpr double kMostSpecular = 0.08;  // reflectance at normal incidence that specular_value 1 stands for
constexpr double kIor = 1.5;            // of glTF's dielectric

struct Measure {
  double width_mm, height_mm;
};

json placed_image(const std::string& path, const cv::Size& size, const Measure& measure) {
  return {
      {"path", path},
      {"width", measure.width_mm},
      {"height", measure.height_mm},
      {"dpi", {{"x", size.width * kInch_mm / measure.width_mm}, {"y", size.height * kInch_mm / measure.height_mm}}}};
}

json repeated_image(const std::string& path, const cv::Size& size, const Measure& measure) {
  json image = placed_image(path, size, measure);
  image["repeat"] = {{"rotation", 0}, {"mode", "normal"}};
  return image;
}

json constant(const json& value) {
  return {{"constant", value}, {"texture", nullptr}};
}

json rgb(const Array3d& color) {
  return {{"r", std::clamp(color[0], 0.0, 1.0)},
          {"g", std::clamp(color[1], 0.0, 1.0)},
          {"b", std::clamp(color[2], 0.0, 1.0)}};
}

json up() {
  return {{"x", 0}, {"y", 0}, {"z", 1}};
}

json scalar(double mean, double factor, const json& image) {
  return {{"constant", std::clamp(mean, 0.0, 1.0)}, {"texture", {{"factor", factor}, {"offset", 0}, {"image", image}}}};
}

double saturation(const Array3d& color) {
  const double most = color.maxCoeff();
  return most > 0 ? 1 - std::max(0.0, color.minCoeff()) / most : 0;
}

// How far a colour has the base colour's hue: 0 grey, 1 as saturated.
double tint(const Array3d& color, const Array3d& base) {
  const double own = saturation(base);
  return own > 0 ? std::min(1.0, saturation(color) / own) : 0;
}

json side_json(const std::filesystem::path& folder, const std::string& side, const PbrMaps& maps,
               const U3mCloth& cloth) {
  const Measure measure{cloth.patch.period_x_mm, cloth.patch.period_y_mm};
  const cv::Size size = maps.opacity.size();
  const auto image = [&](const std::string& name, const auto& pixels) {
    const std::string path = "textures/" + side + "_" + name + ".png";
    renderer::write_png(folder / path, pixels);
    return repeated_image(path, size, measure);
  };
  const GltfMaterial& material = cloth.material;
  const Array3d base = mean_color(maps.base_color), specular = mean_color(maps.specular_color),
                sheen = material.sheen * mean_color(maps.sheen_color);
  const double f0 = std::min(1.0, 0.04 * material.specular_level);
  const cv::Size preview = cloth.preview.size();
  const double periods = cloth.preview_periods;
  return {
      {"shader", "principled"},
      {"basecolor",
       {{"constant", rgb(base)},
        {"texture",
         {{"mode", "multiply"}, {"factor", rgb(Array3d::Ones())}, {"image", image("base_color", maps.base_color)}}}}},
      {"alpha", scalar(cv::mean(maps.opacity)[0] / 255, 1, image("alpha", maps.opacity))},
      {"normal",
       {{"constant", up()}, {"texture", {{"scale", material.normal_scale}, {"image", image("normal", maps.normal)}}}}},
      {"transmission", scalar(maps.transmission_factor * cv::mean(maps.transmission)[0] / 255, maps.transmission_factor,
                              image("transmission", maps.transmission))},
      {"roughness", constant(material.roughness)},
      {"metalness", constant(0)},
      {"specular_value", scalar(material.specular * f0 / kMostSpecular * cv::mean(maps.gloss)[0] / 255,
                                material.specular * f0 / kMostSpecular, image("specular", maps.gloss))},
      {"specular_tint", constant(tint(specular, base))},
      {"sheen_value", constant(sheen.maxCoeff())},
      {"sheen_tint", constant(tint(sheen, base))},
      {"ior", constant(kIor)},
      {"anisotropy_value", constant(0)},
      {"anisotropy_rotation", constant(0)},
      {"clearcoat_value", constant(0)},
      {"clearcoat_roughness", constant(0)},
      {"clearcoat_normal", constant(up())},
      {"displacement", constant(0)},
      {"subsurface_value", constant(0)},
      {"subsurface_radius", constant(0)},
      {"subsurface_color", constant(rgb(base))},
      {"preview", side == "front"
                      ? placed_image("preview.png", preview, {periods * measure.width_mm, periods * measure.height_mm})
                      : json()}};
}

json physics_json(const renderer::YarnPatch& patch) {
  return {{"thickness", patch.thickness_mm},
          {"weight", patch.areal_mass_g_m2 > 0 ? json(patch.areal_mass_g_m2) : json()},
          {"composition", nullptr},
          {"devices", {{"fab", "null"}}},
          {"material_type", {{"type", "Woven"}, {"name", nullptr}}},
          {"construction", {{"type", "other"}, {"name", patch.name}}}};
}

std::string bytes_of(const cv::Mat& picture) {
  return {reinterpret_cast<const char*>(picture.data), picture.total() * picture.elemSize()};
}

}  // namespace

std::string uuid_of(const std::string& sha256) {
  std::string digits = sha256.substr(0, 32);
  digits[12] = '4';
  constexpr char kVariant[] = "89ab";
  digits[16] = kVariant[digits[16] % 4];
  for (const std::size_t place : {20u, 16u, 12u, 8u}) digits.insert(place, "-");
  return digits;
}

void write_u3m(const std::filesystem::path& folder, const U3mCloth& cloth) {
  make_folder(folder / "textures");
  renderer::write_png(folder / "preview.png", cloth.preview);
  std::string content = cloth.name;
  for (const PbrMaps* maps : {&cloth.front, &cloth.back})
    content += bytes_of(maps->base_color) + bytes_of(maps->normal) + bytes_of(maps->opacity);
  write_json_file(folder / "cloth.u3m", {{"schema", "1.1"},
                                         {"material",
                                          {{"id", uuid_of(sha256_hex(content))},
                                           {"name", cloth.name},
                                           {"description", cloth.description},
                                           {"created", cloth.utc},
                                           {"modified", cloth.utc},
                                           {"front", side_json(folder, "front", cloth.front, cloth)},
                                           {"back", side_json(folder, "back", cloth.back, cloth)},
                                           {"side", nullptr},
                                           {"physics", physics_json(cloth.patch)},
                                           {"metadata", nullptr}}},
                                         {"custom", cloth.custom}});
}

}  // namespace station
