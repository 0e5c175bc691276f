// What is seen of a cloth's fibers close by, as scene files and commands give it: a kind of thread by its name, or an
// object with the kind's keys.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "renderer/scene/scene.h"
#include "station/documents/reader.h"

namespace station {

struct ClothFibers {
  renderer::FiberDetail detail;
  std::optional<renderer::Flyaways> flyaways{};  // without their absorption, which is the threads'
};

// "filament": long smooth fibers, hardly twisted; "spun": cotton or linen; "wool".
std::vector<std::string> fiber_kinds();

// The value of `key`. Errors: those of reader.h.
ClothFibers parse_cloth_fibers(ObjectReader& cloth, const std::string& key);

}  // namespace station
