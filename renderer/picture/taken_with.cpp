#include "renderer/picture/taken_with.h"

#include <OpenImageIO/imageio.h>

namespace renderer {

TakenWith taken_with(const std::filesystem::path& file) {
  const auto input = OIIO::ImageInput::open(file.string());
  if (!input) {
    OIIO::geterror();  // which it would write to standard error otherwise
    return {};
  }
  const OIIO::ImageSpec& spec = input->spec();
  const auto text = [&](const char* name) {
    return std::string(OIIO::Strutil::strip(spec.get_string_attribute(name)));
  };
  TakenWith with{.camera = text("Make"), .lens = text("Exif:LensModel")};
  for (const char* name : {"Model", "Exif:BodySerialNumber"})
    if (const std::string more = text(name); !more.empty()) with.camera += (with.camera.empty() ? "" : " ") + more;
  with.focal_length_mm = static_cast<double>(spec.get_float_attribute("Exif:FocalLength"));
  return with;
}

}  // namespace renderer
