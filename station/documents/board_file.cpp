#include "station/documents/board_file.h"

#include "calibration/geometry/targets.h"

namespace station {

calibration::TagLayout TagBoardGrid::layout() const {
  return calibration::make_tag_board("board", rows, columns, tag_mm, pitch_mm, first_id);
}

TagBoardGrid parse_tag_board(ObjectReader& board) {
  TagBoardGrid grid;
  grid.rows = board.integer("rows", 1, 100);
  grid.columns = board.integer("columns", 1, 100);
  grid.tag_mm = board.number("tag_mm", 0.5, 500);
  grid.pitch_mm = board.number("pitch_mm", grid.tag_mm * 1.25, 1000);
  grid.first_id = board.integer("first_id", 0, 586 - grid.rows * grid.columns + 1);
  return grid;
}

BoardFile parse_board(const nlohmann::json& document, const std::string& source) {
  ObjectReader reader(document, source, "board");
  BoardFile board;
  board.name = reader.text("name");
  const bool tags = reader.choice("pattern", {"tags", "chessboard"}) == "tags";
  const double bar_mm =
      reader.has("control_bar_mm") ? reader.number("control_bar_mm", 80, 125) : calibration::kControlBar_mm;
  if (tags) {
    board.pattern = calibration::scaled(parse_tag_board(reader).layout(), bar_mm);
    if (reader.has("thickness_mm")) reader.number("thickness_mm", 0, 100);  // for rigs; a lens does not ask
    if (reader.has("sheets"))  // where the tags of all targets were drawn, for people who make them in other ways
      for (ObjectReader& sheet : reader.objects("sheets")) {
        sheet.text("file");
        if (sheet.numbers("tags").size() % 5 != 0) sheet.refuse("tags", "expected id, edge, x, y, angle of each tag");
        sheet.finish();
      }
  } else {
    calibration::Lattice lattice;
    lattice.rows = reader.integer("rows", 3, 200);
    lattice.columns = reader.integer("columns", 3, 200);
    lattice.spacing_mm = reader.number("square_mm", 0.1, 1000) * bar_mm / calibration::kControlBar_mm;
    board.pattern = lattice;
  }
  reader.finish();
  return board;
}

BoardFile read_board(const std::filesystem::path& file) {
  return parse_board(read_json_file(file), file.string());
}

}  // namespace station
