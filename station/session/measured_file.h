// The measurement file (kind "measurement"): views of a wrapped thread that another lab measured, as linear pictures
// and a table of the directions in which they were seen and lit. fixtures/imports/README.md has the keys.
//
// Directions are those from the middle of the sheet, in the holder's frame (inversion/view/wrapped_spool.h): azimuth
// from the normal of its front (x) towards the threads' axis (y), elevation from there upwards (z, across the threads).
// An upright camera sees the threads run from left to right.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "station/documents/views_file.h"

namespace station {

struct MeasuredFile {
  std::filesystem::path spool;
  std::string person;  // who measured them; may be empty
  // One for each row of the table. Image and mask files are absolute or relative to the working folder, masks empty
  // where the table has none. The cameras have a size of 0 until the pictures are read; brightness is the lamp's
  // strength.
  DevelopedViews views;
  // The principal point; nothing: the middle of each picture.
  std::optional<Eigen::Vector2d> principal_point_px{};
};

// Errors: those of reader.h and number_table.h, for the file and its table; a view from behind the sheet, lamps in its
// plane, two views of one name, picture files that are not there.
MeasuredFile read_measured_file(const std::filesystem::path& file);

}  // namespace station
