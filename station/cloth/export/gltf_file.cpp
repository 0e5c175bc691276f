#include "station/cloth/export/gltf_file.h"

#include <cstring>
#include <span>
#include <vector>

#include "renderer/picture/image_file.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"

namespace station {
namespace {

using nlohmann::json;

// The specification's constants.
constexpr int kFloat = 5126, kUnsignedShort = 5123, kVertices = 34962, kIndices = 34963;
constexpr int kLinear = 9729, kLinearMipmapLinear = 9987, kRepeat = 10497;
constexpr int kBaseColor = 0, kNormal = 1, kTransmission = 2, kSpecular = 3, kSheen = 4;  // textures and images

// A buffer's bytes with the views and accessors that describe them.
class Buffer {
 public:
  template <class T>
  int add(const std::vector<T>& values, const char* type, int component, int width, int target) {
    const std::size_t size = values.size() * sizeof(T), offset = bytes_.size();
    bytes_.resize(offset + size);
    std::memcpy(bytes_.data() + offset, values.data(), size);
    views_.push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}, {"target", target}});
    accessors_.push_back({{"bufferView", views_.size() - 1},
                          {"componentType", component},
                          {"count", values.size() / static_cast<std::size_t>(width)},
                          {"type", type}});
    return static_cast<int>(accessors_.size()) - 1;
  }
  json& accessor(int index) { return accessors_[static_cast<std::size_t>(index)]; }
  const json& views() const { return views_; }
  const json& accessors() const { return accessors_; }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
  json views_ = json::array(), accessors_ = json::array();
};

// The square's corners go from the lower left counter-clockwise; textures begin at the upper left and go down.
json square(Buffer& buffer, const GltfSwatch& swatch) {
  constexpr auto kHalf = static_cast<float>(kGltfSwatch_mm / 2000);  // m
  const auto u = static_cast<float>(kGltfSwatch_mm / swatch.period_x_mm),
             v = static_cast<float>(kGltfSwatch_mm / swatch.period_y_mm);
  const int position = buffer.add<float>({-kHalf, -kHalf, 0, kHalf, -kHalf, 0, kHalf, kHalf, 0, -kHalf, kHalf, 0},
                                         "VEC3", kFloat, 3, kVertices);
  buffer.accessor(position)["min"] = {-kHalf, -kHalf, 0.0};
  buffer.accessor(position)["max"] = {kHalf, kHalf, 0.0};
  const int normal = buffer.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", kFloat, 3, kVertices);
  const int tangent = buffer.add<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4", kFloat, 4, kVertices);
  const int texture = buffer.add<float>({0, v, u, v, u, 0, 0, 0}, "VEC2", kFloat, 2, kVertices);
  const int indices = buffer.add<unsigned short>({0, 1, 2, 0, 2, 3}, "SCALAR", kUnsignedShort, 1, kIndices);
  return {{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"TANGENT", tangent}, {"TEXCOORD_0", texture}}},
          {"indices", indices},
          {"material", 0}};
}

json grey(double value) {
  return {value, value, value};
}

json texture(int index) {
  return {{"index", index}};
}

json material_json(const GltfSwatch& swatch) {
  const GltfMaterial& material = swatch.material;
  const bool opaque = cv::countNonZero(swatch.maps.opacity != 255) == 0;
  return {{"name", swatch.name},
          {"doubleSided", true},
          {"alphaMode", opaque ? "OPAQUE" : "BLEND"},
          {"pbrMetallicRoughness",
           {{"baseColorTexture", texture(kBaseColor)}, {"metallicFactor", 0}, {"roughnessFactor", material.roughness}}},
          {"normalTexture", {{"index", kNormal}, {"scale", material.normal_scale}}},
          {"extensions",
           {{"KHR_materials_specular",
             {{"specularFactor", material.specular},
              {"specularTexture", texture(kSpecular)},
              {"specularColorFactor", grey(material.specular_level)},
              {"specularColorTexture", texture(kSpecular)}}},
            {"KHR_materials_sheen",
             {{"sheenColorFactor", grey(material.sheen)},
              {"sheenColorTexture", texture(kSheen)},
              {"sheenRoughnessFactor", material.sheen_roughness}}},
            {"KHR_materials_diffuse_transmission",
             {{"diffuseTransmissionFactor", swatch.maps.transmission_factor},
              {"diffuseTransmissionTexture", texture(kTransmission)},
              {"diffuseTransmissionColorTexture", texture(kTransmission)}}}}},
          {"extras", swatch.extras}};
}

}  // namespace

void write_gltf(const std::filesystem::path& folder, const GltfSwatch& swatch) {
  const char* const images[] = {"base_color.png", "normal.png", "transmission.png", "specular.png", "sheen.png"};
  renderer::write_png(folder / images[kBaseColor], with_alpha(swatch.maps.base_color, swatch.maps.opacity));
  renderer::write_png(folder / images[kNormal], swatch.maps.normal);
  renderer::write_png(folder / images[kTransmission],
                      with_alpha(swatch.maps.transmission_color, swatch.maps.transmission));
  renderer::write_png(folder / images[kSpecular], with_alpha(swatch.maps.specular_color, swatch.maps.gloss));
  renderer::write_png(folder / images[kSheen], swatch.maps.sheen_color);
  Buffer buffer;
  const json primitive = square(buffer, swatch);
  FileSystem disk;
  store_file(disk, folder / "cloth.bin", buffer.bytes());
  const auto only = [](json entry) { return json::array({std::move(entry)}); };
  json document{
      {"asset", {{"version", "2.0"}, {"generator", software_version()}}},
      {"extensionsUsed", {"KHR_materials_specular", "KHR_materials_sheen", "KHR_materials_diffuse_transmission"}},
      {"scene", 0},
      {"scenes", only({{"name", swatch.name}, {"nodes", only(0)}})},
      {"nodes", only({{"name", "swatch"}, {"mesh", 0}})},
      {"meshes", only({{"name", "swatch"}, {"primitives", only(primitive)}})},
      {"materials", only(material_json(swatch))},
      {"samplers",
       only({{"magFilter", kLinear}, {"minFilter", kLinearMipmapLinear}, {"wrapS", kRepeat}, {"wrapT", kRepeat}})},
      {"buffers", only({{"uri", "cloth.bin"}, {"byteLength", buffer.bytes().size()}})},
      {"bufferViews", buffer.views()},
      {"accessors", buffer.accessors()}};
  for (const char* image : images) {
    document["images"].push_back({{"uri", image}, {"mimeType", "image/png"}});
    document["textures"].push_back({{"sampler", 0}, {"source", document["images"].size() - 1}});
  }
  write_json_file(folder / "cloth.gltf", document);
}

}  // namespace station
