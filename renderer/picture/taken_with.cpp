#include "renderer/picture/taken_with.h"

#include <exception>
#include <exiv2/exiv2.hpp>

namespace renderer {
namespace {

std::string text_of(const Exiv2::ExifData& exif, const char* key) {
  const auto found = exif.findKey(Exiv2::ExifKey(key));
  const std::string text = found == exif.end() ? "" : found->toString();
  const std::size_t from = text.find_first_not_of(" \t"), to = text.find_last_not_of(" \t");
  return from == std::string::npos ? "" : text.substr(from, to - from + 1);
}

TakenWith taken_with(const Exiv2::ExifData& exif) {
  TakenWith with{.camera = text_of(exif, "Exif.Image.Make"), .lens = text_of(exif, "Exif.Photo.LensModel")};
  for (const char* key : {"Exif.Image.Model", "Exif.Photo.BodySerialNumber"})
    if (const std::string more = text_of(exif, key); !more.empty())
      with.camera += (with.camera.empty() ? "" : " ") + more;
  const auto length = exif.findKey(Exiv2::ExifKey("Exif.Photo.FocalLength"));
  if (length != exif.end() && length->count() > 0) with.focal_length_mm = static_cast<double>(length->toFloat());
  return with;
}

}  // namespace

TakenWith taken_with(const std::filesystem::path& file) {
  Exiv2::LogMsg::setLevel(Exiv2::LogMsg::mute);  // it would go to standard error
  try {
    const auto picture = Exiv2::ImageFactory::open(file.string());
    picture->readMetadata();
    return taken_with(picture->exifData());
  } catch (const std::exception&) {
    return {};
  }
}

}  // namespace renderer
