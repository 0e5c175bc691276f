// A rig file (kind "rig"): which devices there are, the printed targets in use, rough tape measures, the capture plan's
// angles, and for a simulated rig the truth of its bench.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/tags.h"
#include "rig/cameras/gphoto_camera.h"
#include "rig/simulated/simulated_bench.h"
#include "rig/turntables/controllers.h"
#include "rig/turntables/serial_line.h"
#include "rig/turntables/stepper_turntable.h"
#include "station/documents/board_file.h"

namespace station {

// The white panel that the lamp is measured with: a square of Spectralon on a black plate with tags.
struct SpectralonPanel {
  double albedo = 0.99;  // certified, of the white square
  double white_mm = 50;  // edge of the white square
  double plate_mm = 90;  // edge of the black plate that carries the tags
  calibration::TagLayout tags;
};

// The colour chart: 24 squares, 4 rows of 6, on a black plate with a tag at each corner
// (calibration/light/colour_chart.h).
struct ColourChart {
  double square_mm = 8, pitch_mm = 9.5;
  double plate_mm = 88;
  calibration::TagLayout tags;
};

inline constexpr std::size_t kChartColumns = 6, kChartRows = 4;
// The centre of square 0 ... 23 in the chart's frame (mm); square 0 is at the top left, and numbers go along the rows.
Eigen::Vector3d chart_square_centre(const ColourChart& chart, std::size_t square);

// The truth of a simulated rig's bench, and how its pictures are drawn.
struct SimulatedRig {
  rig::BenchTruth truth;
  rig::CameraMake camera_make = rig::CameraMake::sony;
  double board_bow_mm = 0;            // how far the middle of the calibration board stands out
  double spectralon_droop = 0;        // the panel's droop (calibration/light/spectralon.h)
  int samples_per_pixel = 32;         // for pictures of the spool, which are path-traced
  int target_samples_per_pixel = 12;  // for pictures without threads
};

// The connection to a motorised turntable; only for the drivers "grbl" and "zaber".
struct TurntableWire {
  enum class Line { serial, pty, simulated };  // simulated: firmware in this program, on its bench
  Line line = Line::serial;
  rig::SerialPortChoice port;
  rig::ControllerSetup controller;
  rig::StepperSetup stepper;
};

// The connection to a camera; only for the driver "gphoto2".
struct CameraWire {
  bool simulated = false;  // this program starts a simulated camera on its bench, which gives the port
  rig::GphotoSetup setup;
};

// The small grey diffuser on the holder that shows how bright the lamp is (bench/reference_chip.h).
struct ReferenceChip {
  double edge_mm = 8;
  double albedo = 0.4;  // grey: white would saturate beside dark threads
};

struct RigFile {
  std::string name;
  std::string camera_driver;     // "simulated", "gphoto2"
  std::string turntable_driver;  // "simulated", "grbl", "zaber", "manual"
  std::string operator_driver;   // "simulated", "console"
  std::optional<TurntableWire> turntable_wire;
  std::optional<CameraWire> camera_wire;
  std::array<double, 9> linear_srgb_from_camera{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major; for display only
  std::string lens_name, focus;                                              // the names that people give them
  double calibration_valid_days = 0;
  double focal_length_guess_px = 0;  // from the focal length engraved on the lens
  Eigen::Isometry3d world_from_camera_by_tape = Eigen::Isometry3d::Identity();  // OpenCV axes; by tape, so roughly
  TagBoardGrid board_grid;                                                      // the calibration board as drawn
  calibration::TagLayout board;
  double board_thickness_mm = 0;
  double platform_height_mm = 0, platform_radius_mm = 0;
  double control_bar_mm = 100;           // measured on the prints; all layouts here are already scaled by it
  calibration::TagLayout platform_ring;  // platform frame: origin where the axis meets the platform's top
  calibration::TagLayout table_tags;     // world frame, roughly; relative positions as printed
  calibration::TagLayout lamp_tags;      // lamp frame: origin at the bright face, +z along the beam
  calibration::TagLayout holder_tags;
  std::optional<ReferenceChip> reference_chip;
  SpectralonPanel spectralon;
  std::optional<ColourChart> colour_chart;
  Eigen::Vector3d front_lamp_mm, back_lamp_mm;  // by tape, world frame
  Eigen::Vector3d front_left_lamp_mm;           // for cloth on the cylinder; known by tape only
  Eigen::Vector3d lamp_aim_mm;                  // the point that the lamps are aimed at
  double lamp_radius_mm = 0;                    // radius of the lamp's bright face
  std::vector<double> reflection_angles_deg, transmission_angles_deg;
  bool brackets_if_needed = false;    // take further exposures only where a view's range needs them
  double lamp_watch_s = 0;            // between two readings of a lamp that warms up; 0: it is not watched
  double target_level = 0.6;          // part of full scale that the brightest thread pixels should reach
  std::vector<double> bracket_stops;  // further exposures of each view, in stops from the metered one
  std::optional<SimulatedRig> simulation;
};

RigFile parse_rig(const nlohmann::json& document, const std::string& source);
RigFile read_rig(const std::filesystem::path& file);

}  // namespace station
