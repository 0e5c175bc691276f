// Lens calibrations in documents: a part of calibration.json, or a file of its own (kind "lens") when it was made from
// existing pictures. Both keep, with every digit, the corners that the lens was solved from.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibration/geometry/lens_fit.h"
#include "station/documents/reader.h"

namespace station {

nlohmann::json lens_json(const calibration::LensFit& fit);
calibration::LensFit parse_lens_fit(ObjectReader reader);

// A matrix as a list of rows; read_matrix refuses any other size.
nlohmann::json matrix_json(const Eigen::MatrixXd& matrix);
Eigen::MatrixXd read_matrix(ObjectReader& reader, const std::string& key, Eigen::Index rows, Eigen::Index columns);

struct LensFile {
  calibration::LensFit fit;
  std::string board, utc, software;
  std::vector<std::string> pictures, picture_sha256;  // in the order of the fit's views
};

nlohmann::json to_json(const LensFile& lens);
LensFile parse_lens_file(const nlohmann::json& document, const std::string& source);

// Writes the lens for mrcal's own tools as a .cameramodel file next to its document.
void write_cameramodel_beside(const calibration::LensFit& fit, const std::filesystem::path& document);

// The lens and its errors in a few lines for people.
std::string describe(const calibration::LensFit& fit);

}  // namespace station
