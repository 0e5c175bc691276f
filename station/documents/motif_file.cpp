#include "station/documents/motif_file.h"

#include <stdexcept>

#include "renderer/embroidery/digitise.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/dst_file.h"
#include "station/documents/pes_file.h"
#include "station/documents/svg_file.h"
#include "station/documents/text_pieces.h"

namespace station {

renderer::Motif read_motif(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMostBytes = 64U << 20U;
  const std::string ending = lower_case(file.extension().string());
  if (ending != ".dst" && ending != ".pes" && ending != ".svg")
    throw std::runtime_error(file.string() + ": found the ending \"" + file.extension().string() +
                             "\", expected .dst (Tajima), .pes (Brother) or .svg (line art)");
  if (!std::filesystem::is_regular_file(file))
    throw std::runtime_error(file.string() + ": no such file; check the path");
  if (std::filesystem::file_size(file) > kMostBytes)
    throw std::runtime_error(file.string() + ": is larger than 64 MiB, which no motif is; check the file");
  const std::string bytes = text_of_file(file);
  if (ending == ".svg") return renderer::digitise(parse_svg(bytes, file.string()), file.string());
  return ending == ".dst" ? parse_dst(bytes, file.string()) : parse_pes(bytes, file.string());
}

}  // namespace station
