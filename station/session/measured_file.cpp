#include "station/session/measured_file.h"

#include <cmath>
#include <numbers>
#include <set>

#include "renderer/picture/camera.h"
#include "station/documents/degree.h"
#include "station/documents/disk/file_name.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/text_table.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr Range kDistance_mm{1, 1e7}, kAzimuth_deg{-180, 180}, kElevation_deg{-85, 85}, kRoll_deg{-360, 360};
constexpr double kLeastFromPlane = 0.02;  // sine of the angle of a lamp above the sheet's plane

// What holds for all views, or where the table does not say otherwise.
struct Arrangement {
  double camera_mm = 0, light_mm = 0, light_radius_mm = 0, beam_exponent = 0;
  Eigen::Vector2d focal_px = Eigen::Vector2d::Ones();
  Vector3d intensity_mm2 = Vector3d::Ones();
};

Arrangement read_arrangement(ObjectReader& reader, MeasuredFile& measured) {
  Arrangement found;
  ObjectReader camera = reader.object("camera");
  found.camera_mm = camera.number("distance_mm", kDistance_mm);
  found.focal_px.setConstant(camera.number("focal_length_px", 10, 1e7));
  if (camera.has("principal_point_px")) {
    const std::vector<double> point = camera.numbers("principal_point_px", 2);
    measured.principal_point_px = {point[0], point[1]};
  }
  camera.finish();
  ObjectReader light = reader.object("light");
  found.light_mm = light.number("distance_mm", kDistance_mm);
  found.light_radius_mm = light.number("radius_mm", 1e-3, 1000);
  if (light.has("beam_exponent")) found.beam_exponent = light.number("beam_exponent", 0, 1000);
  constexpr Range kPositive{1e-12, 1e30};
  if (light.has("intensity_mm2") == light.has("diffuser_radiance"))
    light.refuse("diffuser_radiance",
                 "give either that, the pictures' value of a white diffuser in the place of the sheet that faces the "
                 "light, or \"intensity_mm2\"");
  if (light.has("intensity_mm2"))
    found.intensity_mm2 = light.vector3("intensity_mm2", kPositive);
  else
    found.intensity_mm2 =
        light.vector3("diffuser_radiance", kPositive) * std::numbers::pi * found.light_mm * found.light_mm;
  light.finish();
  return found;
}

// One row of the table: its numbers, refused with the table's name, the line and the column.
class Row {
 public:
  Row(const std::string& file, const TextTable& table, const TextTable::Row& row)
      : file_(file), table_(table), row_(row) {}

  std::string text(const std::string& column) const { return table_.cell(row_, column); }
  double number(const std::string& column, Range range, std::optional<double> otherwise = {}) const {
    const std::string cell = text(column);
    if (cell.empty() && otherwise) return *otherwise;
    const std::optional<double> value = finite_number(cell);
    if (!value || !(*value >= range.low && *value <= range.high))
      refuse(column, "'" + cell + "' was found, expected a number from " + shortest_text(range.low) + " to " +
                         shortest_text(range.high));
    return *value;
  }
  [[noreturn]] void refuse(const std::string& column, const std::string& problem) const {
    throw std::runtime_error(file_ + ", line " + std::to_string(row_.line) + ", " + column + ": " + problem);
  }
  // The file that a cell names, from the table's folder on.
  std::string file(const std::string& column) const {
    const fs::path named = fs::path(file_).parent_path() / text(column);
    if (text(column).empty() || !fs::is_regular_file(named))
      refuse(column, "there is no file \"" + named.string() + "\"; correct the path");
    return named.string();
  }

 private:
  std::string file_;
  const TextTable& table_;
  const TextTable::Row& row_;
};

Vector3d direction(double azimuth_deg, double elevation_deg) {
  const double azimuth = azimuth_deg * kDegree, elevation = elevation_deg * kDegree;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

bool is_picture(const fs::path& file) {
  static const std::set<std::string> endings{".exr", ".tif", ".tiff", ".EXR", ".TIF", ".TIFF"};
  return endings.contains(file.extension());
}

DevelopedView view_of(const Row& row, const Arrangement& of) {
  DevelopedView made;
  made.image_file = row.file("image");
  if (!is_picture(made.image_file)) row.refuse("image", "its name does not end as that of an EXR or a TIFF; rename it");
  if (!row.text("mask").empty()) made.mask_file = row.file("mask");
  made.view.id = row.text("id").empty() ? fs::path(made.image_file).stem().string() : row.text("id");
  if (safe_name(made.view.id) != made.view.id)
    row.refuse("id", "'" + made.view.id + "' is no name for a file; take letters, digits, dashes");
  const double azimuth_deg = row.number("view_azimuth_deg", kAzimuth_deg);
  const Vector3d eye = row.number("view_distance_mm", kDistance_mm, of.camera_mm) *
                       direction(azimuth_deg, row.number("view_elevation_deg", kElevation_deg));
  if (!(eye.x() > 0))
    row.refuse("view_azimuth_deg",
               "the camera would see the sheet from behind; azimuth 0 faces its front, and a light "
               "from behind is a transmission");
  const double roll_deg = row.number("roll_deg", kRoll_deg, 0);
  renderer::Camera& camera = made.view.camera;
  camera = renderer::look_at(eye, Vector3d::Zero(),
                             Eigen::AngleAxisd(roll_deg * kDegree, eye.normalized()) * Vector3d::UnitZ());
  camera.width = camera.height = 0;
  camera.fx = of.focal_px.x(), camera.fy = of.focal_px.y();
  const Vector3d towards_light =
      direction(row.number("light_azimuth_deg", kAzimuth_deg), row.number("light_elevation_deg", kElevation_deg));
  if (std::abs(towards_light.x()) < kLeastFromPlane)
    row.refuse("light_azimuth_deg", "the light is in the plane of the sheet; it lights one of its sides");
  made.view.light = {.position = row.number("light_distance_mm", kDistance_mm, of.light_mm) * towards_light,
                     .intensity = of.intensity_mm2,
                     .radius_mm = of.light_radius_mm,
                     .beam_axis = -towards_light,
                     .beam_exponent = of.beam_exponent};
  made.view.transmission = towards_light.x() < 0;
  made.mounting =
      std::abs(std::sin(roll_deg * kDegree)) > std::sqrt(0.5) ? rig::Mounting::vertical : rig::Mounting::horizontal;
  made.platform_angle_rad = azimuth_deg * kDegree;
  made.lamp_strength = row.number("brightness", {1e-6, 1e6}, 1);
  return made;
}

}  // namespace

MeasuredFile read_measured_file(const fs::path& file) {
  const nlohmann::json document = read_json_file(file);
  ObjectReader reader(document, file.string(), "measurement");
  const fs::path folder = file.parent_path();
  MeasuredFile measured;
  measured.spool = folder / reader.text("spool");
  if (reader.has("operator")) measured.person = reader.text("operator");
  if (reader.has("linear_srgb_from_camera")) {
    const std::vector<double> colour = reader.numbers("linear_srgb_from_camera", 9);
    std::copy(colour.begin(), colour.end(), measured.views.linear_srgb_from_camera.begin());
  }
  const Arrangement of = read_arrangement(reader, measured);
  const fs::path table_file = folder / reader.text("views");
  reader.finish();
  const TextTable table = read_text_table(
      table_file, {"image", "view_azimuth_deg", "view_elevation_deg", "light_azimuth_deg", "light_elevation_deg"},
      {"id", "mask", "roll_deg", "view_distance_mm", "light_distance_mm", "brightness"});
  std::set<std::string> names;
  for (const TextTable::Row& one : table.rows) {
    const Row row(table_file.string(), table, one);
    measured.views.views.push_back(view_of(row, of));
    if (const std::string& id = measured.views.views.back().view.id; !names.insert(id).second)
      row.refuse("id", "a view '" + id + "' is there already; give each view a name of its own");
  }
  return measured;
}

}  // namespace station
