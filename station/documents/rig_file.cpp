#include "station/documents/rig_file.h"

#include <algorithm>
#include <cmath>

#include "calibration/geometry/targets.h"
#include "station/documents/board_file.h"
#include "station/documents/degree.h"
#include "station/documents/holder.h"
#include "station/documents/reader.h"

namespace station {
namespace {

// The pose (OpenCV camera axes) of a camera at `position` that looks at `aim` with its picture upright.
Eigen::Isometry3d looking_at(const Eigen::Vector3d& position, const Eigen::Vector3d& aim) {
  const Eigen::Vector3d forward = (aim - position).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().col(0) = right;
  pose.linear().col(1) = forward.cross(right);
  pose.linear().col(2) = forward;
  pose.translation() = position;
  return pose;
}

Eigen::Isometry3d lying_at(double x_mm, double y_mm, double turn_deg) {
  Eigen::Isometry3d pose(Eigen::Translation3d(x_mm, y_mm, 0));
  pose.rotate(Eigen::AngleAxisd(turn_deg * kDegree, Eigen::Vector3d::UnitZ()));
  return pose;
}

calibration::TagLayout corner_tags(ObjectReader tags, const std::string& name, const Eigen::Vector3d& right,
                                   const Eigen::Vector3d& up) {
  const double size_mm = tags.number("tag_mm", 0.5, 500), offset_mm = tags.number("offset_mm", 0.5, 1000);
  const int first_id = tags.integer("first_id", 0, 583);
  tags.finish();
  return calibration::make_corner_tags(name, size_mm, offset_mm, first_id, right, up);
}

calibration::TagLayout parse_ring(ObjectReader ring) {
  const int count = ring.integer("count", 3, 100);
  const double radius_mm = ring.number("radius_mm", 1, 2000), tag_mm = ring.number("tag_mm", 0.5, 500);
  const int first_id = ring.integer("first_id", 0, 587 - count);
  ring.finish();
  return calibration::make_platform_ring(count, radius_mm, tag_mm, first_id);
}

calibration::TagLayout parse_table_tags(ObjectReader table) {
  const double tag_mm = table.number("tag_mm", 0.5, 500);
  std::vector<Eigen::Vector2d> centres;
  const std::vector<double> numbers = table.numbers("centres_mm");  // x y x y ...
  if (numbers.size() < 8 || numbers.size() % 2 != 0)
    table.refuse("centres_mm", "has " + std::to_string(numbers.size()) +
                                   " numbers; expected x, y of each tag, at least four tags (eight numbers)");
  for (std::size_t i = 0; i < numbers.size(); i += 2) centres.emplace_back(numbers[i], numbers[i + 1]);
  const int first_id = table.integer("first_id", 0, 587 - static_cast<int>(centres.size()));
  table.finish();
  return calibration::make_table_sheet(centres, tag_mm, first_id);
}

// Scales every printed layout to the size in which it came out of the printer.
void scale_prints(RigFile& rig, const ObjectReader& reader) {
  for (calibration::TagLayout* layout :
       {&rig.board, &rig.platform_ring, &rig.table_tags, &rig.lamp_tags, &rig.holder_tags, &rig.spectralon.tags})
    *layout = calibration::scaled(std::move(*layout), rig.control_bar_mm);
  std::vector<calibration::TagLayout> layouts{rig.board,     rig.platform_ring, rig.table_tags,
                                              rig.lamp_tags, rig.holder_tags,   rig.spectralon.tags};
  if (rig.colour_chart) {
    rig.colour_chart->tags = calibration::scaled(std::move(rig.colour_chart->tags), rig.control_bar_mm);
    layouts.push_back(rig.colour_chart->tags);
  }
  const std::string shared = calibration::shared_ids(layouts);
  if (!shared.empty()) reader.refuse("first_id", shared + "; give each printed target ids of its own");
}

rig::SensorDefects parse_defects(ObjectReader reader) {
  rig::SensorDefects defects;
  defects.hot_fraction = reader.number("hot_fraction", 0, 0.1);
  defects.hot_dark_current_e_s = reader.number("hot_dark_current_e_s", 0, 1e7);
  defects.dead_fraction = reader.number("dead_fraction", 0, 0.1);
  defects.noisy_fraction = reader.number("noisy_fraction", 0, 0.1);
  defects.sensitivity_spread = reader.number("sensitivity_spread", 0, 0.2);
  defects.offset_spread_dn = reader.number("offset_spread_dn", 0, 100);
  defects.dust_spots = reader.integer("dust_spots", 0, 1000);
  defects.dust_depth = reader.number("dust_depth", 0, 0.9);
  defects.dust_radius_px = reader.number("dust_radius_px", 0, 1000);
  defects.nonlinearity = reader.number("nonlinearity", -0.2, 0.2);
  defects.shutter_spread = reader.number("shutter_spread", 0, 0.2);
  reader.finish();
  return defects;
}

rig::LampChanges parse_lamp_changes(ObjectReader reader) {
  rig::LampChanges changes;
  changes.drift_per_s = reader.number("drift_per_s", -0.1, 0.1);
  changes.jump = reader.number("jump", -1, 10);
  changes.jump_at_s = reader.number("jump_at_s", 0, 1e6);
  if (reader.has("warm_up")) {
    changes.warm_up = reader.number("warm_up", 0, 1);
    changes.warm_up_s = reader.number("warm_up_s", 0.1, 1e5);
  }
  changes.pwm_hz = reader.number("pwm_hz", 0, 1e6);
  changes.pwm_duty = reader.number("pwm_duty", 0.01, 1);
  reader.finish();
  return changes;
}

ColourChart parse_chart(ObjectReader reader) {
  ColourChart chart;
  chart.square_mm = reader.number("patch_mm", 1, 200);
  chart.pitch_mm = reader.number("pitch_mm", chart.square_mm, 300);
  chart.plate_mm = reader.number("plate_mm", 6 * chart.pitch_mm, 2000);
  chart.tags = corner_tags(reader.object("tags"), "colour chart", Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
  reader.finish();
  return chart;
}

rig::TrueSensor parse_sensor(ObjectReader sensor, rig::TrueLens& lens) {
  rig::TrueSensor truth;
  lens.width_px = sensor.integer("width_px", 16, 20000);
  lens.height_px = sensor.integer("height_px", 16, 20000);
  truth.black_level_dn = sensor.integer("black_level_dn", 0, 4000);
  truth.white_level_dn = sensor.integer("white_level_dn", 16383, 16383);  // what raw readers take for this camera
  truth.full_well_e = sensor.number("full_well_e", 100, 1e7);
  truth.read_noise_e = sensor.number("read_noise_e", 0, 1000);
  truth.dark_current_e_s = sensor.number("dark_current_e_s", 0, 1e5);
  truth.defects = parse_defects(sensor.object("defects"));
  sensor.finish();
  return truth;
}

void parse_lens(ObjectReader lens, rig::TrueLens& truth) {
  const std::vector<double> focal = lens.numbers("focal_length_px", 2);
  const std::vector<double> centre = lens.numbers("principal_point_px", 2);
  const std::vector<double> distortion = lens.numbers("distortion", 5);
  const std::vector<double> vignetting = lens.numbers("vignetting", 2);
  if (focal[0] <= 0 || focal[1] <= 0) lens.refuse("focal_length_px", "a focal length must be positive");
  truth.fx_px = focal[0];
  truth.fy_px = focal[1];
  truth.cx_px = centre[0];
  truth.cy_px = centre[1];
  std::copy(distortion.begin(), distortion.end(), truth.distortion.begin());
  std::copy(vignetting.begin(), vignetting.end(), truth.vignetting.begin());
  truth.blur_px = lens.number("blur_px", 0, 100);
  if (lens.has("electronic_aperture")) truth.electronic_aperture = lens.flag("electronic_aperture");
  truth.world_from_camera = looking_at(lens.vector3("position_mm"), lens.vector3("aim_mm"));
  lens.finish();
}

// The mirror image of a point in the plane of the camera and the platform's axis.
Eigen::Vector3d mirrored(const Eigen::Vector3d& point) {
  return {point.x(), -point.y(), point.z()};
}

rig::CameraMake parse_make(const std::string& make) {
  return make == "canon" ? rig::CameraMake::canon : make == "nikon" ? rig::CameraMake::nikon : rig::CameraMake::sony;
}

SimulatedRig parse_simulation(ObjectReader simulation) {
  SimulatedRig result;
  rig::BenchTruth& truth = result.truth;
  truth.seed = static_cast<std::uint64_t>(simulation.integer("seed", 0, 1 << 30));
  if (simulation.has("make")) result.camera_make = parse_make(simulation.choice("make", {"sony", "canon", "nikon"}));
  result.samples_per_pixel = simulation.integer("samples_per_pixel", 1, 100000);
  result.target_samples_per_pixel = simulation.integer("target_samples_per_pixel", 1, 100000);
  truth.sensor = parse_sensor(simulation.object("sensor"), truth.lens);
  parse_lens(simulation.object("lens"), truth.lens);
  ObjectReader turntable = simulation.object("turntable");
  truth.turntable.scale = turntable.number("scale", 0.5, 2);
  truth.turntable.step_rad = turntable.number("step_deg", 0, 10) * kDegree;
  truth.turntable.speed_rad_s = turntable.number("speed_deg_s", 0.01, 1000) * kDegree;
  turntable.finish();
  ObjectReader lamp = simulation.object("lamp");
  truth.front.position = lamp.vector3("front_position_mm");
  truth.back.position = lamp.vector3("back_position_mm");
  truth.front.intensity = truth.back.intensity = lamp.vector3("intensity_mm2");
  truth.front.radius_mm = truth.back.radius_mm = lamp.number("radius_mm", 0.1, 100);
  truth.front.aim = lamp.vector3("front_aim_mm");
  truth.back.aim = lamp.vector3("back_aim_mm");
  truth.front.beam_exponent = truth.back.beam_exponent = lamp.number("beam_exponent", 0, 100);
  if (truth.front.intensity.minCoeff() < 0) lamp.refuse("intensity_mm2", "cannot be negative");
  truth.front_left = truth.front;
  truth.front_left.position = mirrored(truth.front.position);
  truth.front_left.aim = mirrored(truth.front.aim);
  if (lamp.has("front_left_position_mm")) truth.front_left.position = lamp.vector3("front_left_position_mm");
  truth.lamp_changes = parse_lamp_changes(lamp.object("changes"));
  lamp.finish();
  ObjectReader prints = simulation.object("prints");
  const std::vector<double> ring = prints.numbers("ring_offset_mm", 2), sheet = prints.numbers("table_offset_mm", 2);
  truth.platform_from_ring = lying_at(ring[0], ring[1], prints.number("ring_turn_deg", -180, 180));
  truth.world_from_table_sheet = lying_at(sheet[0], sheet[1], prints.number("table_turn_deg", -180, 180));
  prints.finish();
  truth.room_leak = simulation.number("room_leak", 0, 1);
  truth.room_radiance = simulation.vector3("room_radiance");
  result.board_bow_mm = simulation.number("board_bow_mm", -20, 20);
  result.spectralon_droop = simulation.number("spectralon_droop_percent", 0, 30) / 100;
  truth.placement_mm = simulation.number("placement_mm", 0, 20);
  truth.placement_rad = simulation.number("placement_deg", 0, 20) * kDegree;
  if (simulation.has("stand_placement_mm")) truth.stand_placement_mm = simulation.number("stand_placement_mm", 0, 100);
  if (simulation.has("stand_placement_deg"))
    truth.stand_placement_rad = simulation.number("stand_placement_deg", 0, 90) * kDegree;
  simulation.finish();
  return result;
}

// The serial port, given by its name or by the serial number of its USB adapter.
rig::SerialPortChoice parse_port(ObjectReader& reader, TurntableWire::Line line) {
  rig::SerialPortChoice choice;
  if (line == TurntableWire::Line::simulated) return choice;
  if (line == TurntableWire::Line::serial && reader.has("usb_serial")) {
    choice.usb_serial = reader.text("usb_serial");
    if (reader.has("port")) reader.refuse("port", "stands beside \"usb_serial\"; keep one of the two");
  } else {
    choice.port = reader.text("port");
    if (!choice.port.starts_with("/dev/"))
      reader.refuse("port", "found \"" + choice.port + "\", expected a device such as /dev/ttyUSB0");
  }
  if (line == TurntableWire::Line::serial) choice.baud = reader.integer("baud", 1200, 4000000);
  return choice;
}

CameraWire parse_camera_wire(ObjectReader reader) {
  CameraWire wire;
  wire.setup.port = reader.text("port");
  wire.simulated = wire.setup.port == "simulated";
  if (!wire.simulated) {
    if (!wire.setup.port.starts_with("usb:") && !wire.setup.port.starts_with("ptpip:"))
      reader.refuse("port", "found \"" + wire.setup.port +
                                "\", expected \"usb:\" (the only camera), \"usb:001,004\", \"ptpip:192.168.1.5\" or "
                                "\"simulated\"");
    wire.setup.width_px = reader.integer("width_px", 16, 20000);
    wire.setup.height_px = reader.integer("height_px", 16, 20000);
  }
  wire.setup.shortest_shutter_s = reader.number("shortest_shutter_s", 1e-5, 1);
  wire.setup.least_battery_percent = reader.integer("least_battery_percent", 0, 100);
  reader.finish();
  return wire;
}

TurntableWire parse_turntable(ObjectReader reader, const std::string& driver) {
  TurntableWire wire;
  const std::string line = reader.choice("line", {"serial", "pty", "simulated"});
  wire.line = line == "serial" ? TurntableWire::Line::serial
              : line == "pty"  ? TurntableWire::Line::pty
                               : TurntableWire::Line::simulated;
  wire.port = parse_port(reader, wire.line);
  wire.controller.steps_per_deg = reader.number("steps_per_deg", 0.1, 40000);
  wire.controller.home_by =
      reader.choice("home", {"here", "switch"}) == "here" ? rig::HomeBy::here : rig::HomeBy::home_switch;
  wire.stepper.home_by = wire.controller.home_by;
  if (driver == "grbl" && reader.has("homing_cycle"))
    wire.controller.homes_x_alone = reader.choice("homing_cycle", {"z_first", "x_only"}) == "x_only";
  if (driver == "zaber" && wire.controller.home_by == rig::HomeBy::here)
    reader.refuse("home", "a Zaber stage finds its home by itself; expected \"switch\"");
  wire.stepper.limit_rad = reader.number("limit_deg", 90, 360) * kDegree;
  wire.stepper.backlash_rad = reader.number("backlash_deg", 0, 20) * kDegree;
  wire.controller.reply_timeout_s = reader.number("reply_timeout_s", 0.1, 30);
  wire.controller.banner_timeout_s = std::max(wire.controller.banner_timeout_s, wire.controller.reply_timeout_s);
  wire.stepper.move_timeout_s = reader.number("move_timeout_s", 1, 3600);
  if (driver == "zaber") {
    wire.controller.zaber_device = reader.integer("device", 1, 99);
    wire.controller.zaber_axis = reader.integer("axis", 1, 9);
    wire.controller.zaber_resolution = reader.integer("resolution", 1, 256);
  }
  reader.finish();
  return wire;
}

void parse_capture(ObjectReader capture, RigFile& rig) {
  rig.reflection_angles_deg = capture.numbers("reflection_angles_deg");
  rig.transmission_angles_deg = capture.numbers("transmission_angles_deg");
  rig.target_level = capture.number("target_level", 0.05, 0.9);
  rig.bracket_stops = capture.numbers("bracket_stops");
  if (capture.has("brackets"))
    rig.brackets_if_needed = capture.choice("brackets", {"always", "if_needed"}) == "if_needed";
  if (capture.has("lamp_watch_s")) rig.lamp_watch_s = capture.number("lamp_watch_s", 0, 600);
  if (rig.bracket_stops.size() > 4) capture.refuse("bracket_stops", "at most 4 further exposures");
  for (const double stops : rig.bracket_stops)
    if (!(std::abs(stops) >= 0.3 && std::abs(stops) <= 10))
      capture.refuse("bracket_stops", "found " + std::to_string(stops) + ", expected stops of 0.3 to 10 either way");
  capture.finish();
}

// The lens, its focus, and where the camera stands by tape.
void parse_camera_setup(ObjectReader& reader, RigFile& rig) {
  ObjectReader setup = reader.object("camera_setup");
  rig.lens_name = setup.text("lens");
  rig.focus = setup.text("focus");
  rig.calibration_valid_days = setup.number("calibration_valid_days", 0.01, 3650);
  setup.finish();
  rig.focal_length_guess_px = reader.number("focal_length_guess_px", 10, 1e6);
  const std::vector<double> colour = reader.numbers("linear_srgb_from_camera", 9);
  std::copy(colour.begin(), colour.end(), rig.linear_srgb_from_camera.begin());
  ObjectReader camera = reader.object("camera_by_tape");
  rig.world_from_camera_by_tape = looking_at(camera.vector3("position_mm"), camera.vector3("aim_mm"));
  camera.finish();
}

// The board, the platform and everything else that carries tags, as printed.
void parse_targets(ObjectReader& reader, RigFile& rig) {
  ObjectReader board = reader.object("board");
  rig.board_grid = parse_tag_board(board);
  rig.board = rig.board_grid.layout();
  rig.board_thickness_mm = board.number("thickness_mm", 0, 100);
  board.finish();
  ObjectReader platform = reader.object("platform");
  rig.platform_height_mm = platform.number("height_mm", 0, 1000);
  rig.platform_radius_mm = platform.number("radius_mm", 1, 2000);
  rig.platform_ring = parse_ring(platform.object("ring"));
  platform.finish();
  rig.table_tags = parse_table_tags(reader.object("table_tags"));
  rig.lamp_tags = corner_tags(reader.object("lamp_tags"), "lamp", Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
  rig.holder_tags =
      corner_tags(reader.object("holder_tags"), "holder", Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
  if (reader.has("holder")) {
    inversion::WrappedSpool checked;
    read_holder(reader.object("holder"), checked);  // what takes it reads the document (serve/spool_form.cpp)
  }
  if (reader.has("reference_patch")) {
    ObjectReader chip = reader.object("reference_patch");
    rig.reference_chip =
        ReferenceChip{.edge_mm = chip.number("edge_mm", 1, 100), .albedo = chip.number("albedo", 0.01, 1)};
    chip.finish();
  }
  if (reader.has("colour_chart")) rig.colour_chart = parse_chart(reader.object("colour_chart"));
  ObjectReader panel = reader.object("spectralon");
  rig.spectralon.albedo = panel.number("albedo", 0.5, 1);
  rig.spectralon.white_mm = panel.number("white_mm", 1, 1000);
  rig.spectralon.plate_mm = panel.number("plate_mm", rig.spectralon.white_mm, 2000);
  rig.spectralon.tags =
      corner_tags(panel.object("tags"), "spectralon", Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
  panel.finish();
  if (reader.has("control_bar_mm")) rig.control_bar_mm = reader.number("control_bar_mm", 80, 125);
  scale_prints(rig, reader);
}

void parse_lamps(ObjectReader lamps, RigFile& rig) {
  rig.front_lamp_mm = lamps.vector3("front_position_mm");
  rig.back_lamp_mm = lamps.vector3("back_position_mm");
  rig.front_left_lamp_mm =
      lamps.has("front_left_position_mm") ? lamps.vector3("front_left_position_mm") : mirrored(rig.front_lamp_mm);
  rig.lamp_aim_mm = lamps.vector3("aim_mm");
  rig.lamp_radius_mm = lamps.number("radius_mm", 0.1, 100);
  lamps.finish();
}

}  // namespace

Eigen::Vector3d chart_square_centre(const ColourChart& chart, std::size_t square) {
  const double column = static_cast<double>(square % kChartColumns) - (kChartColumns - 1) / 2.0;
  const double row = static_cast<double>(square / kChartColumns) - (kChartRows - 1) / 2.0;
  return {column * chart.pitch_mm, -row * chart.pitch_mm, 0};
}

RigFile parse_rig(const nlohmann::json& document, const std::string& source) {
  ObjectReader reader(document, source, "rig");
  RigFile rig;
  rig.name = reader.text("name");
  rig.camera_driver = reader.choice("camera", {"simulated", "gphoto2"});
  if (rig.camera_driver == "gphoto2") rig.camera_wire = parse_camera_wire(reader.object("camera_connection"));
  rig.turntable_driver = reader.choice("turntable", {"simulated", "grbl", "zaber", "manual"});
  if (rig.turntable_driver == "grbl" || rig.turntable_driver == "zaber")
    rig.turntable_wire = parse_turntable(reader.object("turntable_setup"), rig.turntable_driver);
  rig.operator_driver = reader.choice("operator", {"simulated", "console"});
  parse_camera_setup(reader, rig);
  parse_targets(reader, rig);
  parse_lamps(reader.object("lamp_by_tape"), rig);
  parse_capture(reader.object("capture"), rig);
  if (reader.has("simulation")) {
    rig.simulation = parse_simulation(reader.object("simulation"));
    rig.simulation->truth.platform_from_ring.pretranslate(Eigen::Vector3d(0, 0, rig.platform_height_mm));
    if (rig.camera_wire && rig.camera_wire->simulated) {
      rig.camera_wire->setup.width_px = rig.simulation->truth.lens.width_px;
      rig.camera_wire->setup.height_px = rig.simulation->truth.lens.height_px;
    }
  }
  const bool simulated_line = (rig.turntable_wire && rig.turntable_wire->line == TurntableWire::Line::simulated) ||
                              (rig.camera_wire && rig.camera_wire->simulated);
  if ((rig.camera_driver == "simulated" || rig.turntable_driver == "simulated" || simulated_line) && !rig.simulation)
    reader.refuse("simulation", "is missing; a rig with simulated devices needs it");
  reader.finish();
  return rig;
}

RigFile read_rig(const std::filesystem::path& file) {
  return parse_rig(read_json_file(file), file.string());
}

}  // namespace station
