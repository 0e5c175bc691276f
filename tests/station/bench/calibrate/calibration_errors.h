// The errors of a rig calibration against the simulated bench that its pictures were taken on.
#pragma once

#include <array>
#include <string>

#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station_test {

// The errors; pairs are for the lamp in front and the lamp behind.
struct CalibrationErrors {
  double lens_px = 0;    // rms over the inner picture at the spool's distance, after the best rigid motion
  double points_px = 0;  // rms of points about the spool, by lens and camera pose
  // The axis at the spool's height, in the frame of the rays that the camera sees. An error of the principal point
  // turns camera, axis and lamps alike in the camera's own frame, and no picture shows it.
  double axis_deg = 0, axis_across_mm = 0, axis_along_mm = 0;
  double axis_in_frame_deg = 0;     // the same with the error of the principal point
  double angle_deg = 0;             // the worst of the platform's views
  std::array<double, 2> lamp_mm{};  // position
  // The irradiance, relative, within +-40 mm about the spool, all colours: rms and worst.
  std::array<double, 2> irradiance{}, worst_irradiance{};
  std::array<double, 2> held_out{};  // the calibration's own figure, relative
  double gain = 0;                   // DN per electron, relative
  double linearity = 0;              // the worst below 85 % of the range, relative
  double bow_mm = 0;                 // bow of the lens's board
  double droop = 0;                  // the panel's, at 60 degrees
};

// Compares; `lamp_strength` is the mean of the lamp's true strength while the panel was photographed, at which the lamp
// was calibrated.
CalibrationErrors calibration_errors(const station::RigCalibration& found, const station::SimulatedRig& simulation,
                                     double lamp_strength = 1.0);

// A line of a table of errors, and the table's heading.
std::string heading();
std::string row(const std::string& bench, const CalibrationErrors& errors);

}  // namespace station_test
