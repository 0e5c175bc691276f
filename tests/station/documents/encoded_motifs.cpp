#include "tests/station/documents/encoded_motifs.h"

#include <array>
#include <utility>

namespace station_test {
namespace {

// Balanced ternary, digit by digit.
void put_digits(int value, const std::array<std::pair<int, int>, 5>& bits, std::array<unsigned char, 3>& bytes) {
  for (const auto& [plus, minus] : bits) {  // bit 0 ... 23, the first byte's first; digits of 1, 3, 9, 27, 81
    const int digit = ((value % 3) + 4) % 3 - 1;
    value = (value - digit) / 3;
    if (digit > 0) bytes[static_cast<std::size_t>(plus / 8)] |= static_cast<unsigned char>(1 << plus % 8);
    if (digit < 0) bytes[static_cast<std::size_t>(minus / 8)] |= static_cast<unsigned char>(1 << minus % 8);
  }
}

void put_coordinate(int value, int flags, std::string& file) {
  if (flags == 0 && value >= -64 && value < 64) {
    file += static_cast<char>(value & 0x7F);
    return;
  }
  file += static_cast<char>(0x80 | flags | ((value >> 8) & 0x0F));
  file += static_cast<char>(value & 0xFF);
}

}  // namespace

std::string dst(const std::vector<Record>& records) {
  std::string file = "LA:rose            \rST:  12345\r";
  file.resize(512, ' ');
  for (const Record& record : records) {
    std::array<unsigned char, 3> bytes{0, 0, 0x03};
    put_digits(record.x, {{{0, 1}, {8, 9}, {2, 3}, {10, 11}, {18, 19}}}, bytes);
    put_digits(record.y, {{{7, 6}, {15, 14}, {5, 4}, {13, 12}, {21, 20}}}, bytes);
    if (record.step == Step::jump) bytes[2] |= 0x80;
    if (record.step == Step::colour) bytes[2] |= 0xC0;
    file.append(bytes.begin(), bytes.end());
  }
  return file + std::string("\x00\x00\xF3", 3);
}

std::string pes(const std::vector<Record>& records, const std::vector<int>& colours) {
  std::string file = "#PES0001";
  const std::size_t section = 40;
  file += static_cast<char>(section);
  file.resize(section, '\0');
  file += "LA:rose            \r";
  file.resize(section + 48, ' ');
  file += static_cast<char>(colours.size() - 1);
  for (int colour : colours) file += static_cast<char>(colour);
  file.resize(section + 532, ' ');
  for (const Record& record : records) {
    if (record.step == Step::colour) {
      file += "\xFE\xB0\x02";
      continue;
    }
    const int flags = record.step == Step::jump ? 0x20 : 0;
    put_coordinate(record.x, flags, file);
    put_coordinate(-record.y, flags, file);
  }
  return file + std::string("\xFF\x00", 2);
}

}  // namespace station_test
