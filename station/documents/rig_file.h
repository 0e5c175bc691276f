// Rig files (kind "rig"): which devices there are, the printed targets in use, rough tape measures, the capture plan's
// angles, and for a simulated rig the truth of its bench.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/tags.h"
#include "rig/cameras/gphoto_camera.h"
#include "rig/simulated_bench.h"
#include "rig/turntables/controllers.h"
#include "rig/turntables/serial_line.h"
#include "rig/turntables/stepper_turntable.h"
#include "station/documents/board_file.h"
#include "station/reference_patch.h"

namespace station {

struct SpectralonPanel {
  double albedo = 0.99;  // of the white square
  double white_mm = 50;  // its edge
  double plate_mm = 90;  // edge of the black plate that carries the tags
  calibration::TagLayout tags;
};

// 24 patches, 4 rows of 6, on a black plate with a tag at each corner (calibration/colour_chart.h).
struct ColourChart {
  double patch_mm = 8, pitch_mm = 9.5;
  double plate_mm = 88;
  calibration::TagLayout tags;
};

inline constexpr std::size_t kChartColumns = 6, kChartRows = 4;
// Centre of patch 0 ... 23 in the chart's frame (mm): the first at the top left, along rows.
Eigen::Vector3d chart_patch_centre(const ColourChart& chart, std::size_t patch);

struct SimulatedRig {
  rig::BenchTruth truth;
  double board_bow_mm = 0;            // how far the board's middle stands out
  double spectralon_droop = 0;        // calibration/spectralon.h
  int samples_per_pixel = 32;         // of the path tracer that draws the spool
  int target_samples_per_pixel = 12;  // and of pictures without threads
};

// How a motorised turntable is reached; only for the drivers "grbl" and "zaber".
struct TurntableWire {
  enum class Line { serial, pty, simulated };  // simulated: this program starts the firmware too, on its bench
  Line line = Line::serial;
  rig::SerialPortChoice port;
  rig::ControllerSetup controller;
  rig::StepperSetup stepper;
};

// How a camera is reached; only for the driver "gphoto2".
struct CameraWire {
  bool simulated = false;  // this program starts the camera too, on its bench; the port comes with it
  rig::GphotoSetup setup;
};

struct RigFile {
  std::string name;
  std::string camera_driver;     // "simulated", "gphoto2"
  std::string turntable_driver;  // "simulated", "grbl", "zaber", "manual"
  std::string operator_driver;   // "simulated", "console"
  std::optional<TurntableWire> turntable_wire;
  std::optional<CameraWire> camera_wire;
  std::array<double, 9> linear_srgb_from_camera{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major; for display only
  std::string lens_name, focus;                                              // as people tell them apart
  double calibration_valid_days = 0;
  double focal_length_guess_px = 0;                                             // from the lens's engraving
  Eigen::Isometry3d world_from_camera_by_tape = Eigen::Isometry3d::Identity();  // OpenCV axes; roughly
  TagBoardGrid board_grid;                                                      // as drawn
  calibration::TagLayout board;
  double board_thickness_mm = 0;
  double platform_height_mm = 0, platform_radius_mm = 0;
  double control_bar_mm = 100;           // measured on the prints; the layouts here are already scaled by it
  calibration::TagLayout platform_ring;  // platform frame: origin where the axis meets the platform's top
  calibration::TagLayout table_tags;     // world frame, roughly; relative positions as printed
  calibration::TagLayout lamp_tags;      // lamp frame: origin at the bright face, +z along the beam
  calibration::TagLayout holder_tags;
  std::optional<ReferencePatch> reference_patch;
  SpectralonPanel spectralon;
  std::optional<ColourChart> colour_chart;
  Eigen::Vector3d front_lamp_mm, back_lamp_mm;  // by tape, world frame
  Eigen::Vector3d front_left_lamp_mm;           // for cloth on the cylinder; known by tape only
  Eigen::Vector3d lamp_aim_mm;                  // what both are pointed at
  double lamp_radius_mm = 0;                    // of its bright face
  std::vector<double> reflection_angles_deg, transmission_angles_deg;
  bool brackets_if_needed = false;    // further exposures only where a view's range needs them
  double lamp_watch_s = 0;            // between two readings of a lamp that was switched on; 0: it is not watched
  double target_level = 0.6;          // of full scale that the brightest thread pixels should reach
  std::vector<double> bracket_stops;  // of the further exposures of each view, from the metered one
  std::optional<SimulatedRig> simulation;
};

RigFile parse_rig(const nlohmann::json& document, const std::string& source);
RigFile read_rig(const std::filesystem::path& file);

}  // namespace station
