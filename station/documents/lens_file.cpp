#include "station/documents/lens_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calibration/geometry/mrcal_lens.h"
#include "station/documents/gate_list.h"

namespace station {
namespace {

using nlohmann::json;
constexpr std::size_t kNumbersPerCorner = 7;  // column, row, x, y, used (1 or 0), error x, error y

json difference_json(const calibration::LensDifference& difference) {
  return {{"median_px", difference.median_px}, {"rms_px", difference.rms_px}, {"largest_px", difference.largest_px}};
}

calibration::LensDifference parse_difference(ObjectReader reader) {
  calibration::LensDifference difference;
  difference.median_px = reader.number("median_px", 0, 1e99);
  difference.rms_px = reader.number("rms_px", 0, 1e99);
  difference.largest_px = reader.number("largest_px", 0, 1e99);
  reader.finish();
  return difference;
}

json pictures_json(const calibration::LensFit& fit) {
  json pictures = json::array();
  for (std::size_t v = 0; v < fit.picture_rms_px.size(); ++v) {
    json corners = json::array();
    for (const calibration::CornerError& entry : fit.corner_errors) {
      if (entry.picture != static_cast<int>(v)) continue;
      for (const double number :
           {static_cast<double>(entry.corner.column), static_cast<double>(entry.corner.row), entry.corner.pixel.x(),
            entry.corner.pixel.y(), entry.used ? 1.0 : 0.0, entry.error_px.x(), entry.error_px.y()})
        corners.push_back(number);
    }
    json picture{{"rms_px", fit.picture_rms_px[v]}, {"corners", corners}};
    if (fit.camera_from_lattice[v]) picture["camera_from_lattice"] = to_json(*fit.camera_from_lattice[v]);
    pictures.push_back(picture);
  }
  return pictures;
}

void parse_pictures(ObjectReader& reader, calibration::LensFit& fit) {
  for (ObjectReader& picture : reader.objects("views")) {
    const int number = static_cast<int>(fit.picture_rms_px.size());
    fit.picture_rms_px.push_back(picture.number("rms_px", 0, 1e6));
    const std::vector<double> corners = picture.numbers("corners");
    if (corners.size() % kNumbersPerCorner != 0)
      picture.refuse("corners", "has " + std::to_string(corners.size()) + " numbers; expected seven for each corner");
    for (std::size_t i = 0; i < corners.size(); i += kNumbersPerCorner)
      fit.corner_errors.push_back({.picture = number,
                                   .corner = {static_cast<int>(corners[i]), static_cast<int>(corners[i + 1]),
                                              Eigen::Vector2d(corners[i + 2], corners[i + 3])},
                                   .error_px = Eigen::Vector2d(corners[i + 5], corners[i + 6]),
                                   .used = corners[i + 4] != 0.0});
    fit.camera_from_lattice.push_back(std::nullopt);
    if (picture.has("camera_from_lattice")) fit.camera_from_lattice.back() = picture.transform("camera_from_lattice");
    picture.finish();
  }
}

std::vector<std::string> texts(ObjectReader& reader, const std::string& key) {
  const json& list = reader.raw(key);
  std::vector<std::string> out;
  if (!list.is_array()) reader.refuse(key, "expected a list of text");
  for (const json& entry : list) {
    if (!entry.is_string()) reader.refuse(key, "expected a list of text");
    out.push_back(entry.get<std::string>());
  }
  return out;
}

}  // namespace

json matrix_json(const Eigen::MatrixXd& matrix) {
  json rows = json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    json row = json::array();
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) row.push_back(std::min(matrix(r, c), 1e99));  // no infinity
    rows.push_back(row);
  }
  return rows;
}

Eigen::MatrixXd read_matrix(ObjectReader& reader, const std::string& key, Eigen::Index rows, Eigen::Index columns) {
  const json& list = reader.raw(key);
  Eigen::MatrixXd matrix(rows, columns);
  const std::string expected =
      "expected a " + std::to_string(rows) + " x " + std::to_string(columns) + " matrix of numbers";
  if (!list.is_array() || list.size() != static_cast<std::size_t>(rows)) reader.refuse(key, expected);
  for (Eigen::Index r = 0; r < rows; ++r) {
    const json& row = list[static_cast<std::size_t>(r)];
    if (!row.is_array() || row.size() != static_cast<std::size_t>(columns)) reader.refuse(key, expected);
    for (Eigen::Index c = 0; c < columns; ++c) {
      const json& entry = row[static_cast<std::size_t>(c)];
      if (!entry.is_number()) reader.refuse(key, expected);
      matrix(r, c) = entry.get<double>();
    }
  }
  return matrix;
}

json lens_json(const calibration::LensFit& fit) {
  const calibration::Lens& lens = fit.lens;
  json document{
      {"width_px", lens.width_px},
      {"height_px", lens.height_px},
      {"focal_length_px", {lens.fx_px, lens.fy_px}},
      {"principal_point_px", {lens.cx_px, lens.cy_px}},
      {"distortion", lens.distortion},
      {"covariance", matrix_json(fit.covariance)},
      {"rms_px", fit.rms_px},
      {"corners_used", fit.corners_used},
      {"corners_rejected", fit.corners_rejected},
      {"converged", fit.converged},
      {"lattice",
       {{"columns", fit.lattice.columns}, {"rows", fit.lattice.rows}, {"spacing_mm", fit.lattice.spacing_mm}}},
      {"board_warp_mm", {fit.board_warp_mm.x(), fit.board_warp_mm.y()}},
      {"board_warp_sigma_mm",
       {std::min(fit.board_warp_sigma_mm.x(), 1e99), std::min(fit.board_warp_sigma_mm.y(), 1e99)}},
      {"working_distance_mm", fit.working_distance_mm},
      {"projection_sigma_px", matrix_json(fit.projection_sigma_px)},
      {"regularised", fit.regularised},
      {"regularisation", difference_json(fit.regularisation)},
      {"regularisation_sigmas", fit.regularisation_sigmas},
      {"opencv8", difference_json(fit.opencv8)},
      {"gates", to_json(fit.gates)},
      {"views", pictures_json(fit)}};
  if (fit.halves) document["halves"] = difference_json(*fit.halves);
  return document;
}

calibration::LensFit parse_lens_fit(ObjectReader reader) {
  calibration::LensFit fit;
  fit.lens.width_px = reader.integer("width_px", 1, 100000);
  fit.lens.height_px = reader.integer("height_px", 1, 100000);
  const auto focal = reader.numbers("focal_length_px", 2), centre = reader.numbers("principal_point_px", 2);
  const auto distortion = reader.numbers("distortion", 5);
  fit.lens.fx_px = focal[0];
  fit.lens.fy_px = focal[1];
  fit.lens.cx_px = centre[0];
  fit.lens.cy_px = centre[1];
  std::copy(distortion.begin(), distortion.end(), fit.lens.distortion.begin());
  fit.covariance = read_matrix(reader, "covariance", 9, 9);
  fit.rms_px = reader.number("rms_px", 0, 1e6);
  fit.corners_used = reader.integer("corners_used", 0, 1 << 30);
  fit.corners_rejected = reader.integer("corners_rejected", 0, 1 << 30);
  fit.converged = reader.flag("converged");
  ObjectReader lattice = reader.object("lattice");
  fit.lattice.columns = lattice.integer("columns", 2, 100000);
  fit.lattice.rows = lattice.integer("rows", 2, 100000);
  fit.lattice.spacing_mm = lattice.number("spacing_mm", 1e-6, 1e6);
  lattice.finish();
  const auto warp = reader.numbers("board_warp_mm", 2), warp_sigma = reader.numbers("board_warp_sigma_mm", 2);
  fit.board_warp_mm = {warp[0], warp[1]};
  fit.board_warp_sigma_mm = {warp_sigma[0], warp_sigma[1]};
  fit.working_distance_mm = reader.number("working_distance_mm", 0, 1e9);
  fit.projection_sigma_px =
      read_matrix(reader, "projection_sigma_px", calibration::kGridRows, calibration::kGridColumns);
  fit.regularised = reader.flag("regularised");
  fit.regularisation = parse_difference(reader.object("regularisation"));
  fit.regularisation_sigmas = reader.number("regularisation_sigmas", 0, 1e99);
  fit.opencv8 = parse_difference(reader.object("opencv8"));
  if (reader.has("halves")) fit.halves = parse_difference(reader.object("halves"));
  fit.gates = parse_gates(reader, "gates");
  parse_pictures(reader, fit);
  reader.finish();
  return fit;
}

json to_json(const LensFile& lens) {
  return {{"format", "threadstation/lens"},
          {"version", 1},
          {"board", lens.board},
          {"utc", lens.utc},
          {"software", lens.software},
          {"pictures", lens.pictures},
          {"picture_sha256", lens.picture_sha256},
          {"lens", lens_json(lens.fit)}};
}

LensFile parse_lens_file(const json& document, const std::string& source) {
  ObjectReader reader(document, source, "lens");
  LensFile lens;
  lens.board = reader.text("board");
  lens.utc = reader.text("utc");
  lens.software = reader.text("software");
  lens.pictures = texts(reader, "pictures");
  lens.picture_sha256 = texts(reader, "picture_sha256");
  lens.fit = parse_lens_fit(reader.object("lens"));
  reader.finish();
  return lens;
}

void write_cameramodel_beside(const calibration::LensFit& fit, const std::filesystem::path& document) {
  const calibration::Lens& lens = fit.lens;
  const auto& k = lens.distortion;
  std::filesystem::path file = document;
  calibration::write_cameramodel({calibration::LensModel::opencv5,
                                  {lens.width_px, lens.height_px},
                                  {lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, k[0], k[1], k[2], k[3], k[4]}},
                                 file.replace_extension(".cameramodel"));
}

std::string describe(const calibration::LensFit& fit) {
  const calibration::Lens& lens = fit.lens;
  const auto sigma = [&](Eigen::Index i) { return std::sqrt(fit.covariance(i, i)); };
  double nearest = 1e99, furthest = 0.0;
  int pictures = 0;
  for (const auto& pose : fit.camera_from_lattice) {
    if (!pose) continue;
    nearest = std::min(nearest, pose->translation().norm());
    furthest = std::max(furthest, pose->translation().norm());
    ++pictures;
  }
  const auto& map = fit.projection_sigma_px;
  char text[900];
  int used = std::snprintf(
      text, sizeof text,
      "lens      f %.3f / %.3f px (+-%.3f), centre %.3f / %.3f px (+-%.3f), distortion %.5f %.5f %.6f %.6f %.5f\n"
      "          %d pictures at %.0f to %.0f mm, %d corners (%d rejected), rms %.3f px per axis, board bent by "
      "%.2f / %.2f mm\n"
      "          good to +-%.3f px at %.0f mm (at the picture's edges %.3f); OPENCV8 differs by %.3f px (median)",
      lens.fx_px, lens.fy_px, sigma(0), lens.cx_px, lens.cy_px, sigma(2), lens.distortion[0], lens.distortion[1],
      lens.distortion[2], lens.distortion[3], lens.distortion[4], pictures, nearest, furthest, fit.corners_used,
      fit.corners_rejected, fit.rms_px, fit.board_warp_mm.x(), fit.board_warp_mm.y(), calibration::middle_sigma_px(fit),
      fit.working_distance_mm, map.maxCoeff(), fit.opencv8.median_px);
  std::string out(text, static_cast<std::size_t>(std::min(used, static_cast<int>(sizeof text) - 1)));
  if (fit.halves) {
    std::snprintf(text, sizeof text, ", half the pictures from the other half by %.3f px", fit.halves->median_px);
    out += text;
  }
  if (fit.regularised) out += "\n          with regularisation: without it these pictures leave the lens undetermined";
  if (fit.regularisation_sigmas > 3.0) {
    std::snprintf(text, sizeof text, "\n          regularisation would bend it by %.3f px rms, it was left out",
                  fit.regularisation.rms_px);
    out += text;
  }
  return out + "\n";
}

}  // namespace station
