#include "station/bench/calibration_validity.h"

#include <chrono>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "station/documents/gate_list.h"
#include "station/documents/number_text.h"

namespace station {
namespace {

std::chrono::sys_time<std::chrono::microseconds> parsed(const std::string& utc) {
  std::tm parts{};
  std::istringstream text(utc);
  text >> std::get_time(&parts, "%Y-%m-%dT%H:%M:%S");
  const std::chrono::year_month_day date{std::chrono::year(parts.tm_year + 1900),
                                         std::chrono::month(static_cast<unsigned>(parts.tm_mon + 1)),
                                         std::chrono::day(static_cast<unsigned>(parts.tm_mday))};
  if (text.fail() || !date.ok())
    throw std::runtime_error("\"" + utc +
                             "\" is no date like 2026-11-21T10:20:30Z; the calibration file was edited, "
                             "calibrate again");
  double fraction_s = 0.0;
  if (text.peek() == '.') text >> fraction_s;
  return std::chrono::sys_days(date) + std::chrono::hours(parts.tm_hour) + std::chrono::minutes(parts.tm_min) +
         std::chrono::seconds(parts.tm_sec) + std::chrono::microseconds(std::llround(1e6 * fraction_s));
}

[[noreturn]] void refuse(const std::string& part, const std::string& calibrated, const std::string& found) {
  throw std::runtime_error("the calibration is for " + part + " \"" + calibrated + "\", this is \"" + found +
                           "\"; calibrate this rig");
}

std::string f_text(double f_number) {
  return "f/" + number_text(f_number, 1);
}

}  // namespace

double days_between(const std::string& utc_from, const std::string& utc_to) {
  return std::chrono::duration<double, std::ratio<86400>>(parsed(utc_to) - parsed(utc_from)).count();
}

void require_valid(const RigCalibration& calibration, const RigFile& rig, const std::string& utc_now,
                   bool accept_failed_gates) {
  if (calibration.rig_name != rig.name) refuse("rig", calibration.rig_name, rig.name);
  if (calibration.camera.lens != rig.lens_name) refuse("lens", calibration.camera.lens, rig.lens_name);
  if (calibration.camera.focus != rig.focus) refuse("focus", calibration.camera.focus, rig.focus);
  const double age_days = days_between(calibration.utc, utc_now);
  if (age_days > rig.calibration_valid_days)
    throw std::runtime_error("the calibration is " + number_text(age_days, 0) + " days old, rig \"" + rig.name +
                             "\" allows " + number_text(rig.calibration_valid_days, 0) + "; calibrate again");
  const std::string failed = failed_gates(all_gates(calibration));
  if (failed.empty() || accept_failed_gates) return;
  throw std::runtime_error("the calibration is not good enough: " + failed +
                           "; calibrate again, or accept it with --accept-calibration");
}

void require_same_camera(const RigCalibration& calibration, const calibration::SensorPicture& picture,
                         const std::string& name) {
  const CameraSetup& wanted = calibration.camera;
  const calibration::Lens& lens = calibration.lens.lens;
  if (picture.model != wanted.model || picture.serial != wanted.serial)
    refuse("camera", wanted.model + " " + wanted.serial, picture.model + " " + picture.serial + " (" + name + ")");
  if (picture.mosaic.cols != lens.width_px || picture.mosaic.rows != lens.height_px)
    refuse("pictures of", std::to_string(lens.width_px) + " x " + std::to_string(lens.height_px),
           std::to_string(picture.mosaic.cols) + " x " + std::to_string(picture.mosaic.rows) + " (" + name + ")");
  const bool told = picture.f_number > 0;  // a lens without an electronic aperture does not tell it
  if (told && std::abs(picture.f_number - wanted.f_number) > 0.01 * wanted.f_number)
    refuse("aperture", f_text(wanted.f_number), f_text(picture.f_number) + " (" + name + ")");
}

}  // namespace station
