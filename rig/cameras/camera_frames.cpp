#include "rig/cameras/camera_frames.h"

#include <stdexcept>

#include "rig/cameras/ptp_bytes.h"

namespace rig {
namespace {

constexpr std::string_view kMark = "TSC1";
constexpr std::size_t kHeader = 12;
constexpr std::size_t kLongestText = 1 << 20, kMostBytes = std::size_t{1} << 28;

[[noreturn]] void refuse() {
  throw std::runtime_error(
      "the camera process said something that is no frame; start the program again, the session can be resumed");
}

}  // namespace

void CameraFrames::add(std::string_view piece) {
  waiting_.append(piece);
}

bool CameraFrames::next(CameraFrame& frame) {
  if (waiting_.compare(0, std::min(kMark.size(), waiting_.size()), kMark, 0, std::min(kMark.size(), waiting_.size())) !=
      0)
    refuse();
  if (waiting_.size() < kHeader) return false;
  const std::size_t text = *ptp_number<std::uint32_t>(waiting_, 4), bytes = *ptp_number<std::uint32_t>(waiting_, 8);
  if (text > kLongestText || bytes > kMostBytes) refuse();
  if (waiting_.size() < kHeader + text + bytes) return false;
  const std::string_view whole = waiting_;
  frame.text = nlohmann::json::parse(whole.substr(kHeader, text), nullptr, false);
  if (!frame.text.is_object()) refuse();
  const auto* data = reinterpret_cast<const std::byte*>(waiting_.data()) + kHeader + text;
  frame.bytes.assign(data, data + bytes);
  waiting_.erase(0, kHeader + text + bytes);
  return true;
}

std::string encode_frame(const CameraFrame& frame) {
  const std::string text = frame.text.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  PtpWriter out;
  out.bytes(kMark).put(static_cast<std::uint32_t>(text.size())).put(static_cast<std::uint32_t>(frame.bytes.size()));
  out.bytes(text).bytes({reinterpret_cast<const char*>(frame.bytes.data()), frame.bytes.size()});
  return out.take();
}

nlohmann::json settings_to_json(const CameraSettings& settings) {
  return {{"exposure_s", settings.exposure_s}, {"iso", settings.iso}, {"f_number", settings.f_number}};
}

CameraSettings settings_from_json(const nlohmann::json& document) {
  return {.exposure_s = document.at("exposure_s").get<double>(),
          .iso = document.at("iso").get<int>(),
          .f_number = document.at("f_number").get<double>()};
}

}  // namespace rig
