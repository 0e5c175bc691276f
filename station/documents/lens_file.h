// Lens calibrations in documents: a part of calibration.json, and files of their own (kind "lens") from existing
// pictures. They keep the corners they were solved from, with every digit.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibration/lens.h"
#include "station/documents/reader.h"

namespace station {

nlohmann::json lens_json(const calibration::LensFit& fit);
calibration::LensFit parse_lens_fit(ObjectReader reader);

nlohmann::json matrix_json(const Eigen::MatrixXd& matrix);
Eigen::MatrixXd read_matrix(ObjectReader& reader, const std::string& key, Eigen::Index rows, Eigen::Index columns);

struct LensFile {
  calibration::LensFit fit;
  std::string board, utc, software;
  std::vector<std::string> pictures, picture_sha256;  // in the order of the fit's views
};

nlohmann::json to_json(const LensFile& lens);
LensFile parse_lens_file(const nlohmann::json& document, const std::string& source);

// The lens for mrcal's own tools, next to its document.
void write_cameramodel_beside(const calibration::LensFit& fit, const std::filesystem::path& document);

// A few lines for people.
std::string describe(const calibration::LensFit& fit);

}  // namespace station
