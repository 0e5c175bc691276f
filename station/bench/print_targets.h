// Printable calibration targets: the boards and tags of a rig file, and the stands that hold them, drawn to scale.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "calibration/geometry/tags.h"
#include "station/bench/paper_page.h"
#include "station/documents/rig_file.h"

namespace station {

// One sheet of paper: tags, the outlines to cut along, and a word on what to do with it. Millimetres from the sheet's
// own origin, +x right, +y up; `centre` of the drawing comes to the middle of the page.
struct TargetSheet {
  std::string file;  // name without extension
  std::string title, advice;
  std::vector<calibration::Tag> tags;  // object_from_tag in the sheet's plane, +z towards the viewer
  std::vector<double> circles_mm;      // radii about the origin, to cut along
  std::vector<double> squares_mm;      // edges about the origin, to cut along
};

// The rig's targets as they must be drawn: a control bar that was measured on an earlier print is taken out again.
std::vector<TargetSheet> target_sheets(const RigFile& rig);

// Writes <file>.pdf (vectors) and <file>.png (300 dpi) of each sheet, stand_N.pdf and .svg of each stand, and
// board.json. Returns the files. Throws std::runtime_error when a sheet does not fit on the paper or a file cannot be
// written.
std::vector<std::filesystem::path> print_targets(const RigFile& rig, Paper paper, const std::filesystem::path& folder);

// Where the drawing's origin lies on the page, mm from its top left corner.
Eigen::Vector2d origin_on_page_mm(const TargetSheet& sheet, Paper paper);

}  // namespace station
