// The import file (kind "import") lists pictures that were taken by hand: which file shows what.
// fixtures/imports/README.md has the keys.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "station/documents/plan.h"

namespace station {

struct ImportedPicture {
  std::filesystem::path file;
  StepKind kind = StepKind::view;  // view, pose or dark
  rig::Mounting mounting = rig::Mounting::horizontal;
  rig::Lamp lamp = rig::Lamp::front;  // off for a dark and a pose
  double platform_angle_rad = 0.0;
};

struct ImportFile {
  std::filesystem::path rig, spool;
  std::filesystem::path calibration;  // a folder that calibrate made; empty: the rig's tape measures
  std::filesystem::path lens;         // a lens file, without calibration; empty: the focal length by EXIF or engraving
  std::optional<Eigen::Vector3d> lamp_intensity_mm2;  // without calibration, required
  std::string person;                                 // who took them
  std::vector<ImportedPicture> pictures;
};

// Paths in the file are relative to it. Errors: those of reader.h, also for a picture file that is not there, a list
// without a view, a lens or lamp intensity beside a calibration, and no lamp intensity without one.
ImportFile read_import_file(const std::filesystem::path& file);

}  // namespace station
