#include "station/documents/disk/whole_file.h"

#include <fstream>
#include <stdexcept>

namespace station {
namespace {

template <class Content>
Content content_of(const std::filesystem::path& file) {
  constexpr std::size_t kBlock = std::size_t{1} << 16U;
  std::ifstream in(file, std::ios::binary);
  Content content;
  for (std::size_t size = 0; in; content.resize(size)) {
    content.resize(size + kBlock);
    in.read(reinterpret_cast<char*>(content.data()) + size, kBlock);
    size += static_cast<std::size_t>(in.gcount());
  }
  if (!in.eof())
    throw std::runtime_error("cannot read " + file.string() + ": " +
                             (std::filesystem::exists(file) ? "not a readable file" : "no such file") +
                             "; check the path");
  return content;
}

}  // namespace

std::string text_of_file(const std::filesystem::path& file) {
  return content_of<std::string>(file);
}

std::vector<std::byte> bytes_of_file(const std::filesystem::path& file) {
  return content_of<std::vector<std::byte>>(file);
}

}  // namespace station
