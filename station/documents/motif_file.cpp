#include "station/documents/motif_file.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "station/documents/dst_file.h"
#include "station/documents/pes_file.h"
#include "station/documents/svg_file.h"

namespace station {

renderer::Motif read_motif(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMostBytes = 64U << 20U;
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending != ".dst" && ending != ".pes" && ending != ".svg")
    throw std::runtime_error(file.string() + ": found the ending \"" + file.extension().string() +
                             "\", expected .dst (Tajima), .pes (Brother) or .svg (line art)");
  if (!std::filesystem::is_regular_file(file))
    throw std::runtime_error(file.string() + ": no such file; check the path");
  if (std::filesystem::file_size(file) > kMostBytes)
    throw std::runtime_error(file.string() + ": is larger than 64 MiB, which no motif is; check the file");
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read; check its permissions");
  if (ending == ".svg") return parse_svg(bytes, file.string());
  return ending == ".dst" ? parse_dst(bytes, file.string()) : parse_pes(bytes, file.string());
}

}  // namespace station
