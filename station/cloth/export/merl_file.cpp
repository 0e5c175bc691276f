#include "station/cloth/export/merl_file.h"

#include <bit>
#include <cstdint>

namespace station {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian");

template <class Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

}  // namespace

std::string merl_bytes(const renderer::MerlGrid& grid, const Eigen::Matrix3d& colours) {
  using renderer::MerlGrid;
  std::string bytes;
  bytes.reserve(12 + 3 * sizeof(double) * MerlGrid::kCells);
  for (int size : {MerlGrid::kThetaH, MerlGrid::kThetaD, MerlGrid::kPhiD}) append(bytes, std::int32_t{size});
  for (int c = 0; c < 3; ++c)
    for (const Eigen::Array3d& value : grid.brdf) {
      const double colour = colours.row(c).dot(value.matrix());
      append(bytes,
             MerlGrid::above_horizon(value) ? std::max(0.0, colour) / kMerlScale[static_cast<std::size_t>(c)] : -1.0);
    }
  return bytes;
}

}  // namespace station
