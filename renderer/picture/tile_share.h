// A picture that several processes draw together: each has a share of its tiles, and hands them over as records.
#pragma once

#include <array>
#include <vector>

#include "renderer/picture/film.h"

namespace renderer {

// One of `of` shares of a picture's tiles. Shares have as many tiles as the others, one more or less, scattered over
// the picture, so that all take about as long.
struct TileShare {
  int number = 0, of = 1;  // 0 <= number < of
};

// The numbers of the share's tiles among `tiles` (tiles_of), in rising order: every tile is in one share.
std::vector<int> tiles_in(const TileShare& share, int tiles);

// A tile of a film, the pixels by rows; those that a tile at the picture's edge lacks are 0. Its bytes may be stored
// and sent.
struct TileRecord {
  static constexpr std::size_t kPixels = std::size_t{kTile} * kTile;
  std::array<double, 3 * kPixels> sums{};
  std::array<double, kPixels> squares{};
  std::array<int, kPixels> counts{};
  int tile = 0, goal = 0;
};

TileRecord record_of(const Film& film, int tile);
// Puts the record's pixels into the film unless it has more samples there, and the higher of both goals.
void put(const TileRecord& record, Film& film);

}  // namespace renderer
