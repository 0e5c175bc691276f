// Board files (kind "board"): the printed board of a lens calibration, tags or chessboard.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "calibration/lattice.h"
#include "calibration/tags.h"
#include "station/documents/reader.h"

namespace station {

struct BoardFile {
  std::string name;
  std::variant<calibration::TagLayout, calibration::Lattice> pattern;  // lattice: a chessboard's inner corners
};

// A regular tag board as drawn.
struct TagBoardGrid {
  int rows = 0, columns = 0;
  double tag_mm = 0, pitch_mm = 0;
  int first_id = 0;

  calibration::TagLayout layout() const;
};
TagBoardGrid parse_tag_board(ObjectReader& board);

// Lengths are those of the print: scaled by the control bar.
BoardFile parse_board(const nlohmann::json& document, const std::string& source);
BoardFile read_board(const std::filesystem::path& file);

}  // namespace station
