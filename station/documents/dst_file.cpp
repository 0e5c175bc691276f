#include "station/documents/dst_file.h"

#include <stdexcept>

#include "station/documents/text_pieces.h"

namespace station {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kHeader = 512, kRecord = 3;
constexpr double kDstUnit_mm = 0.1;
constexpr int kJumpsThatCut = 3;

int digit(unsigned char byte, int plus_bit, int minus_bit) {
  return ((byte >> plus_bit) & 1) - ((byte >> minus_bit) & 1);
}

Eigen::Vector2d move_mm(unsigned char a, unsigned char b, unsigned char c) {
  const int x = digit(a, 0, 1) + 3 * digit(b, 0, 1) + 9 * digit(a, 2, 3) + 27 * digit(b, 2, 3) + 81 * digit(c, 2, 3);
  const int y = digit(a, 7, 6) + 3 * digit(b, 7, 6) + 9 * digit(a, 5, 4) + 27 * digit(b, 5, 4) + 81 * digit(c, 5, 4);
  return kDstUnit_mm * Eigen::Vector2d(x, y);
}

std::string label_of(std::string_view header) {
  const std::size_t from = 3, end = header.find_first_of("\r\n\x1a", from);
  return trimmed(header.substr(from, end == std::string_view::npos ? 16 : end - from), " \0"sv);
}

}  // namespace

renderer::Motif parse_dst(std::string_view bytes, const std::string& source) {
  if (bytes.size() < kHeader || !bytes.starts_with("LA:"))
    throw std::runtime_error(source + ": no Tajima DST file (found " + std::to_string(bytes.size()) +
                             " bytes, expected a header of 512 that begins with \"LA:\"); export the motif again");
  renderer::MotifRecorder recorder;
  int jumps = 0;
  bool ended = false;
  for (std::size_t at = kHeader; at + kRecord <= bytes.size() && !ended; at += kRecord) {
    const auto a = static_cast<unsigned char>(bytes[at]), b = static_cast<unsigned char>(bytes[at + 1]),
               c = static_cast<unsigned char>(bytes[at + 2]);
    const bool jump = (c & 0x80) != 0, stop = (c & 0x40) != 0;
    const Eigen::Vector2d move = move_mm(a, b, c);
    ended = (c & 0xF3) == 0xF3;
    if (ended) break;
    jumps = jump && !stop ? jumps + 1 : 0;
    if (jumps == kJumpsThatCut) recorder.trim();
    if (jump && stop) {
      recorder.jump(move);
      recorder.next_thread();
    } else if (jump) {
      recorder.jump(move);
    } else {
      recorder.stitch(move);
    }
  }
  if (!ended)
    throw std::runtime_error(source + ": ends without its end record after " +
                             std::to_string((bytes.size() - kHeader) / kRecord) +
                             " records; the file is cut short, copy it again");
  recorder.motif().name = label_of(bytes.substr(0, kHeader));
  if (renderer::measure(recorder.motif()).stitches == 0)
    throw std::runtime_error(source + ": has no stitch; give a motif with at least one");
  return recorder.motif();
}

}  // namespace station
