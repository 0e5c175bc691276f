// A bundle file (kind "bundle", bundle.json): a digitized thread that is described by its fibers
// (renderer/scattering/bundle.h), and where that comes from; keys in station/data/bundles/README.md. Cloths take it
// wherever they take a thread file.
//
// Errors: those of reader.h; also refused are fibers that fill more than a thread can hold.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "renderer/scene/scene.h"
#include "station/documents/thread_file.h"

namespace station {

using BundleFile = DigitizedThread<renderer::BundleParameters>;

BundleFile parse_bundle(const nlohmann::json& document, const std::string& source);
BundleFile read_bundle(const std::filesystem::path& file);
nlohmann::json to_json(const BundleFile& bundle);

// What a cloth asks of a digitized thread.
struct ClothThread {
  renderer::ScatteringModel scattering;
  double diameter_mm;
  std::array<double, 9> linear_srgb_from_camera;
};
// A thread file or a bundle file.
ClothThread read_cloth_thread(const std::filesystem::path& file);
// A file of any fitted model: a thread, a bundle, or a baseline's fiber or yarn.
renderer::ScatteringModel read_model(const std::filesystem::path& file);

}  // namespace station
