#include "station/session/shown_cloth.h"

#include "renderer/picture/image_file.h"
#include "station/documents/reader.h"
#include "station/output/display.h"
#include "station/session/results.h"

namespace station {

cv::Mat3b shown_cloth(const std::filesystem::path& picture, int stops,
                      const std::array<double, 9>& linear_srgb_from_camera) {
  const cv::Mat3f linear = renderer::read_exr(picture);
  const std::filesystem::path file = picture.parent_path() / kMadeOf;
  if (std::filesystem::exists(file)) {
    const nlohmann::json made_of = read_json_file(file);
    if (const auto cards = made_of.find("white_card"); cards != made_of.end() && cards->contains(picture.stem()))
      return display(linear, Exposure{.white = cards->at(picture.stem()), .stops = stops}, linear_srgb_from_camera);
  }
  return display(linear, linear_srgb_from_camera);
}

}  // namespace station
