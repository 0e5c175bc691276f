#include "station/documents/pes_file.h"

#include <stdexcept>

#include "station/documents/brother_colours.h"
#include "station/documents/text_pieces.h"

namespace station {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kOffsetAt = 8, kCountAt = 48,
                      kStitchesAt = 532;  // the latter two from where the section begins
constexpr double kPesUnit_mm = 0.1;

class Bytes {
 public:
  Bytes(std::string_view bytes, const std::string& source) : bytes_(bytes), source_(source) {}

  int next() {
    if (at_ >= bytes_.size())
      throw std::runtime_error(source_ + ": ends at byte " + std::to_string(bytes_.size()) +
                               " in the middle of its stitches; the file is cut short, copy it again");
    return static_cast<unsigned char>(bytes_[at_++]);
  }
  void go_to(std::size_t at) {
    if (at > bytes_.size())
      throw std::runtime_error(source_ + ": leads to byte " + std::to_string(at) + " but has " +
                               std::to_string(bytes_.size()) + "; the file is cut short or damaged, copy it again");
    at_ = at;
  }
  std::string text(std::size_t length) {
    std::string found;
    for (std::size_t i = 0; i < length; ++i) found += static_cast<char>(next());
    return found;
  }

 private:
  std::string_view bytes_;
  const std::string& source_;
  std::size_t at_ = 0;
};

struct Coordinate {
  int value = 0;
  bool jump = false, trim = false;
};

Coordinate coordinate(Bytes& bytes, int first) {
  if ((first & 0x80) == 0) return {.value = first < 64 ? first : first - 128};
  const int bits = (first & 0x0F) << 8 | bytes.next();
  return {.value = bits < 2048 ? bits : bits - 4096, .jump = (first & 0x10) != 0, .trim = (first & 0x20) != 0};
}

}  // namespace

renderer::Motif parse_pes(std::string_view bytes, const std::string& source) {
  if (!bytes.starts_with("#PES"))
    throw std::runtime_error(source +
                             ": no Brother PES file (it does not begin with \"#PES\"); export the motif again");
  Bytes reader(bytes, source);
  reader.go_to(kOffsetAt);
  std::size_t section = 0;
  for (int shift = 0; shift < 32; shift += 8) section |= static_cast<std::size_t>(reader.next()) << shift;
  reader.go_to(section);
  const std::string label = reader.text(19);
  if (!label.starts_with("LA:"))
    throw std::runtime_error(source + ": its stitches should begin at byte " + std::to_string(section) +
                             " and do not; the file is damaged, export the motif again");
  reader.go_to(section + kCountAt);
  const int colours = (reader.next() + 1) & 0xFF;  // one less is stored, 255 for none
  std::vector<int> numbers;
  for (int i = 0; i < colours; ++i) numbers.push_back(reader.next());
  reader.go_to(section + kStitchesAt);
  renderer::MotifRecorder recorder;
  for (int first = reader.next(); first != 0xFF; first = reader.next()) {
    if (first == 0xFE) {
      reader.next(), reader.next();  // 0xB0, and 1 or 2 by turns
      recorder.next_thread();
      continue;
    }
    const Coordinate x = coordinate(reader, first), y = coordinate(reader, reader.next());
    const Eigen::Vector2d move = kPesUnit_mm * Eigen::Vector2d(x.value, -y.value);
    if (x.trim || y.trim) recorder.trim();
    if (x.jump || y.jump || x.trim || y.trim)
      recorder.jump(move);
    else
      recorder.stitch(move);
  }
  renderer::Motif& motif = recorder.motif();
  if (motif.threads.size() > numbers.size())
    throw std::runtime_error(source + ": changes to thread " + std::to_string(motif.threads.size()) + " but has " +
                             std::to_string(numbers.size()) + " colours; the file is damaged, export the motif again");
  for (std::size_t i = 0; i < motif.threads.size(); ++i) motif.threads[i] = brother_thread(numbers[i]);
  motif.name = trimmed(label.substr(3), " \r\0"sv);
  if (renderer::measure(motif).stitches == 0)
    throw std::runtime_error(source + ": has no stitch; give a motif with at least one");
  return motif;
}

}  // namespace station
