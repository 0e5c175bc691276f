#include "station/cloth/pattern/flat_scene.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "station/documents/scene_names.h"

namespace station {

using nlohmann::json;
namespace fs = std::filesystem;

json flat_scene(const fs::path& thread, const fs::path& draft, const Eigen::Vector2d& size_mm, const fs::path& folder) {
  constexpr double kMostSide_px = 1000, kEyeDistance = 20;  // the latter of the larger side: hardly any perspective
  const double larger_mm = size_mm.maxCoeff(), px_per_mm = kMostSide_px / larger_mm, eye_mm = kEyeDistance * larger_mm;
  const auto pixels = [&](double mm) { return std::max(1, static_cast<int>(std::lround(mm * px_per_mm))); };
  return {{"format", "threadstation/scene"},
          {"version", 1},
          {"name", "a picture in cloth"},
          {"threads", {name_from(folder, thread)}},
          {"cloths",
           {{{"draft", name_from(folder, draft)},
             {"shape", {{"kind", "swatch"}, {"width_mm", size_mm.x()}, {"height_mm", size_mm.y()}}}}}},
          {"lights", {{{"kind", "environment"}, {"radiance", {1, 1, 1}}}}},
          {"camera",
           {{"width_px", pixels(size_mm.x())},
            {"height_px", pixels(size_mm.y())},
            {"focal_length_px", px_per_mm * eye_mm},
            {"eye_mm", {0, 0, eye_mm}},
            {"target_mm", {0, 0, 0}},
            {"up", {0, 1, 0}}}},
          {"samples_per_pixel", 32},
          {"exposure", 1}};
}

}  // namespace station
