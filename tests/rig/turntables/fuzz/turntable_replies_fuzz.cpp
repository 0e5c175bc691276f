// Any bytes as what a turntable says: the same lines come out however they are split, and reading them never fails.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "rig/turntables/grbl_reply.h"
#include "rig/turntables/line_frames.h"
#include "rig/turntables/zaber_reply.h"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

std::vector<std::string> lines_of(std::string_view bytes, std::size_t piece) {
  rig::LineFrames frames;
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < bytes.size(); begin += piece) {
    frames.add(bytes.substr(begin, piece));
    while (const auto line = frames.next()) lines.push_back(*line);
  }
  return lines;
}

void read_as_grbl(const std::string& line) {
  const rig::GrblReply reply = rig::parse_grbl_line(line);
  if (const auto* status = std::get_if<rig::GrblStatus>(&reply)) {
    require(status->machine_deg.has_value() != status->work_deg.has_value());
    require(std::isfinite(status->machine_deg.value_or(0)) && std::isfinite(status->work_deg.value_or(0)));
  }
  require(!std::holds_alternative<rig::GrblOk>(reply) || line == "ok");
}

void read_as_zaber(const std::string& line) {
  if (const auto reply = rig::parse_zaber_line(line))
    require(reply->device >= 0 && reply->device <= 99 && reply->message.value_or(0) <= 99 && !reply->data.empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::vector<std::string> lines = lines_of(bytes, 7);
  // A line longer than any that is kept may lose another part of its beginning.
  if (bytes.size() <= 1024) require(lines == lines_of(bytes, bytes.size() + 1));
  for (const std::string& line : lines) {
    read_as_grbl(line);
    read_as_zaber(line);
  }
  return 0;
}
