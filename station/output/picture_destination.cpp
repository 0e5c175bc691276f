#include "station/output/picture_destination.h"

#include <stdexcept>

namespace station {

void check_picture_destination(const std::filesystem::path& out) {
  const std::string ending = out.extension().string();
  if (ending != ".exr" && ending != ".png")
    throw std::runtime_error("cannot write " + out.string() + ": found the ending \"" + ending +
                             "\", expected .exr (linear) or .png (display)");
  const std::filesystem::path folder = out.has_parent_path() ? out.parent_path() : ".";
  if (!std::filesystem::is_directory(folder))
    throw std::runtime_error("cannot write " + out.string() + ": there is no folder " + folder.string() +
                             "; make it first");
}

}  // namespace station
