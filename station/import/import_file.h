// Pictures taken by hand, listed for import (kind "import"): which file shows what. fixtures/imports/README.md has the keys.
//
// Errors: those of reader.h; no view, a dark that names no lamp is fine, a picture file that is not there.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "station/capture/plan.h"

namespace station {

struct ImportedPicture {
  std::filesystem::path file;
  StepKind kind = StepKind::view;  // view, pose or dark
  rig::Mounting mounting = rig::Mounting::horizontal;
  rig::Lamp lamp = rig::Lamp::front;
  double platform_angle_rad = 0.0;
};

struct ImportFile {
  std::filesystem::path rig, spool;
  std::filesystem::path calibration;  // a folder that calibrate made; empty: the rig's tape measures
  std::filesystem::path lens;  // a lens file, without calibration; empty: the focal length by EXIF or engraving
  std::optional<Eigen::Vector3d> lamp_intensity_mm2;  // without calibration, required
  std::string person;
  std::vector<ImportedPicture> pictures;
};

// Paths in the file are relative to it.
ImportFile read_import_file(const std::filesystem::path& file);

}  // namespace station
