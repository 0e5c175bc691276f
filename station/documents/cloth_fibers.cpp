#include "station/documents/cloth_fibers.h"

#include <map>

#include "station/documents/degree.h"

namespace station {
namespace {

// Of yarns as textbooks draw them; no thread was measured for it.
const std::map<std::string, ClothFibers>& kinds() {
  const auto detail = [](double twist_deg, double spread_deg, double shade, double width_mm) {
    return renderer::FiberDetail{
        .twist_rad = twist_deg * kDegree, .spread_rad = spread_deg * kDegree, .shade = shade, .width_mm = width_mm};
  };
  static const std::map<std::string, ClothFibers> all{
      {"filament", {detail(4, 2.5, 0.08, 0.012)}},
      {"spun", {detail(18, 7, 0.15, 0.015), renderer::Flyaways{.per_mm = 1.2, .length_mm = 0.9, .diameter_mm = 0.013}}},
      {"wool", {detail(15, 12, 0.2, 0.022), renderer::Flyaways{.per_mm = 2, .length_mm = 1.8, .diameter_mm = 0.02}}}};
  return all;
}

}  // namespace

std::vector<std::string> fiber_kinds() {
  std::vector<std::string> names;
  for (const auto& [name, fibers] : kinds()) names.push_back(name);
  return names;
}

ClothFibers parse_cloth_fibers(ObjectReader& cloth, const std::string& key) {
  if (cloth.raw(key).is_string()) return kinds().at(cloth.choice(key, {"filament", "spun", "wool"}));
  ObjectReader reader = cloth.object(key);
  ClothFibers fibers;
  fibers.detail = {.twist_rad = reader.number("twist_deg", -60, 60) * kDegree,
                   .spread_rad = reader.number("spread_deg", 0, 45) * kDegree,
                   .shade = reader.number("shade", 0, 1),
                   .width_mm = reader.number("width_mm", 1e-3, 1)};
  if (reader.has("flyaways_per_mm")) {
    fibers.flyaways = renderer::Flyaways{.per_mm = reader.number("flyaways_per_mm", 0, 100),
                                         .length_mm = reader.number("flyaway_length_mm", 0.01, 20),
                                         .diameter_mm = reader.number("flyaway_diameter_mm", 1e-3, 0.5)};
  }
  reader.finish();
  return fibers;
}

}  // namespace station
