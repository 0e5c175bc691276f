// A cloth as U3M 1.1, the open container of the fabric industry (Vizoo's specification, github.com/vizoogmbh/u3m):
// cloth.u3m, a JSON document, with the pictures of both sides under textures/.
//
// Its shader is a "principled" one without a colour for light that is let through. Sheen and highlight are given by
// their strengths and by how far they have the cloth's own hue, and light that comes through has the base colour's hue:
// these are nearest equivalents.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "renderer/weave/patch.h"
#include "station/cloth/export/gltf_brdf.h"
#include "station/cloth/export/pbr_maps.h"

namespace station {

struct U3mCloth {
  std::string name, description;
  std::string utc;  // time of its making, ISO 8601
  const renderer::YarnPatch& patch;
  const PbrMaps &front, &back;
  GltfMaterial material;
  cv::Mat3b preview;  // sRGB picture of the face, `preview_periods` across
  int preview_periods = 1;
  nlohmann::json custom = nlohmann::json::object();  // this program's own section
};

// Writes the document and its pictures. Errors: std::runtime_error, one line, when a file cannot be written.
void write_u3m(const std::filesystem::path& folder, const U3mCloth& cloth);

// A version 4 UUID made of the first digits of a SHA-256, so that equal cloths have equal ones.
std::string uuid_of(const std::string& sha256);

}  // namespace station
