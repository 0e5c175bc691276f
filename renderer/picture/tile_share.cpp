#include "renderer/picture/tile_share.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace renderer {
namespace {

// SplitMix64 [Steele, Lea and Flood 2014].
std::uint64_t scattered(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30u)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27u)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31u);
}

// work(pixel of the record, row, column) for each pixel of the tile.
template <class Work>
void for_each_pixel_of(const Film& film, int tile, const Work& work) {
  const cv::Rect part = tile_of(film.counts.size(), tile);
  for (int row = 0; row < part.height; ++row)
    for (int column = 0; column < part.width; ++column)
      work(static_cast<std::size_t>(row * kTile + column), part.y + row, part.x + column);
}

}  // namespace

std::vector<int> tiles_in(const TileShare& share, int tiles) {
  std::vector<int> order(static_cast<std::size_t>(tiles)), mine;
  std::iota(order.begin(), order.end(), 0);
  if (share.of == 1) return order;
  std::ranges::sort(order, {}, [](int tile) { return scattered(static_cast<std::uint64_t>(tile)); });
  for (std::size_t i = static_cast<std::size_t>(share.number); i < order.size();
       i += static_cast<std::size_t>(share.of))
    mine.push_back(order[i]);
  std::ranges::sort(mine);
  return mine;
}

TileRecord record_of(const Film& film, int tile) {
  TileRecord record{.tile = tile, .goal = film.goals(tile)};
  for_each_pixel_of(film, tile, [&](std::size_t pixel, int row, int column) {
    for (int c = 0; c < 3; ++c) record.sums[3 * pixel + static_cast<std::size_t>(c)] = film.sums(row, column)[c];
    record.squares[pixel] = film.squares(row, column);
    record.counts[pixel] = film.counts(row, column);
  });
  return record;
}

void put(const TileRecord& record, Film& film) {
  film.goals(record.tile) = std::max(film.goals(record.tile), record.goal);
  for_each_pixel_of(film, record.tile, [&](std::size_t pixel, int row, int column) {
    if (record.counts[pixel] < film.counts(row, column)) return;
    for (int c = 0; c < 3; ++c) film.sums(row, column)[c] = record.sums[3 * pixel + static_cast<std::size_t>(c)];
    film.squares(row, column) = record.squares[pixel];
    film.counts(row, column) = record.counts[pixel];
  });
}

}  // namespace renderer
