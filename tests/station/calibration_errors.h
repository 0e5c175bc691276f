// How far a rig calibration is from the simulated bench that its pictures were taken on.
#pragma once

#include <array>
#include <string>

#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station_test {

// Pairs: lamp in front, lamp behind.
struct CalibrationErrors {
  double lens_px = 0;    // rms over the inner picture at the spool's distance, after the best rigid motion
  double points_px = 0;  // rms of points about the spool, through lens and camera pose
  // Of the axis at the spool's height, among the rays that the camera sees. An error of the principal point turns camera,
  // axis and lamps alike in the camera's own frame, and no picture shows it.
  double axis_deg = 0, axis_across_mm = 0, axis_along_mm = 0;
  double axis_in_frame_deg = 0;     // with that
  double angle_deg = 0;             // worst of the platform's views
  std::array<double, 2> lamp_mm{};  // position
  // Relative, +-40 mm about the spool, all colours.
  std::array<double, 2> irradiance{}, worst_irradiance{};
  std::array<double, 2> held_out{};  // the calibration's own figure, relative
  double gain = 0;                   // DN per electron, relative
  double linearity = 0;              // worst below 85 % of the range, relative
  double bow_mm = 0;                 // of the lens's board
  double droop = 0;                  // of the panel, at 60 degrees
};

// `lamp_strength`: mean of the lamp's true strength while the panel was photographed; the calibrated lamp is as it was then.
CalibrationErrors calibration_errors(const station::RigCalibration& found, const station::SimulatedRig& simulation,
                                     double lamp_strength = 1.0);

// One line of a table, and its heading.
std::string heading();
std::string row(const std::string& bench, const CalibrationErrors& errors);

}  // namespace station_test
