// A board file (kind "board"): the printed board that a lens is calibrated with, AprilTags or a chessboard.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "calibration/geometry/lattice.h"
#include "calibration/geometry/tags.h"
#include "station/documents/reader.h"

namespace station {

struct BoardFile {
  std::string name;
  std::variant<calibration::TagLayout, calibration::Lattice> pattern;  // a Lattice holds a chessboard's inner corners
};

// A regular tag board as it was drawn, before printing changed its size.
struct TagBoardGrid {
  int rows = 0, columns = 0;
  double tag_mm = 0, pitch_mm = 0;
  int first_id = 0;

  calibration::TagLayout layout() const;
};
TagBoardGrid parse_tag_board(ObjectReader& board);  // reads the grid's keys from `board`

// Read a board from its document or its file. Its lengths are those of the print: the drawn ones, scaled by the
// measured length of the control bar where the file gives one. `source` names the document in error messages; errors:
// those of reader.h.
BoardFile parse_board(const nlohmann::json& document, const std::string& source);
BoardFile read_board(const std::filesystem::path& file);

}  // namespace station
