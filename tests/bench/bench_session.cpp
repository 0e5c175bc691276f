// An unattended session of 17 views at 24 megapixels on the simulated wire rig, and its development: memory, and how
// much of the time is neither exposure nor motion nor download. The bench is drawn with 600 x 400 pixels and enlarged
// while the camera delivers, so that the simulation itself needs little; what happens inside a device's call is the
// device's time.
//
//   bench_session [FOLDER]      needs 5 GB there
//
// The first session, on the injected clock, draws what the second one is given.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <list>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/sensor/sensor_file.h"
#include "renderer/picture/image_file.h"
#include "rig/cameras/camera_process.h"
#include "rig/simulated/pty_server.h"
#include "rig/simulated/raw_writer.h"
#include "rig/turntables/controllers.h"
#include "rig/turntables/stepper_turntable.h"
#include "station/bench/bench_picture.h"
#include "station/bench/rig_devices.h"
#include "station/documents/reader.h"
#include "station/session/capture_session.h"
#include "station/session/develop/develop_session.h"
#include "station/session/record/verify.h"
#include "station/session/run_session.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using Seconds = std::chrono::duration<double>;
constexpr int kEnlarge = 10;  // 600 x 400 to 6000 x 4000

double now_s() {
  return Seconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Of a place in the picture; the centre of the first pixel is at 0.
double enlarged(double at_px) {
  return (at_px + 0.5) * kEnlarge - 0.5;
}

RigFile drawn_rig() {
  nlohmann::json document = read_json_file(std::string(DATA_DIR) + "/rigs/simulated_wire_grbl.json");
  document["simulation"]["samples_per_pixel"] = 4;
  document["simulation"]["target_samples_per_pixel"] = 16;  // a corner's noise is enlarged too
  document["capture"]["bracket_stops"] = nlohmann::json::array();
  return parse_rig(document, "simulated_wire_grbl.json");
}

RigFile large_rig() {
  RigFile rig = drawn_rig();
  rig::TrueLens& lens = rig.simulation->truth.lens;
  lens.width_px *= kEnlarge, lens.height_px *= kEnlarge;
  lens.fx_px *= kEnlarge, lens.fy_px *= kEnlarge;
  lens.cx_px = enlarged(lens.cx_px), lens.cy_px = enlarged(lens.cy_px);
  rig.focal_length_guess_px *= kEnlarge;
  return rig;
}

RigCalibration large_calibration() {
  RigCalibration calibration = read_calibration(std::string(DATA_DIR) + "/calibrations/simulated.json");
  calibration::Lens& lens = calibration.lens.lens;
  lens.width_px *= kEnlarge, lens.height_px *= kEnlarge;
  lens.fx_px *= kEnlarge, lens.fy_px *= kEnlarge;
  lens.cx_px = enlarged(lens.cx_px), lens.cy_px = enlarged(lens.cy_px);
  calibration.lens.projection_sigma_px *= kEnlarge;
  for (auto& [id, corners] : calibration.still_tags)
    for (Eigen::Vector2d& corner : corners) corner = {enlarged(corner.x()), enlarged(corner.y())};
  calibration.sensor.reset();
  return calibration;
}

// A camera that delivers enlarged drawings with a little noise, so that no two files are alike.
class LargeCamera final : public rig::Camera {
 public:
  LargeCamera(rig::SimulatedBench& bench, rig::Clock& clock)
      : bench_(bench),
        clock_(clock),
        small_rig_(drawn_rig()),
        draw_(make_bench_picture(small_rig_, read_spool(std::string(DATA_DIR) + "/spools/silk_red.json"))) {}

  rig::CameraIdentity identity() override {
    const rig::TrueLens& lens = bench_.truth().lens;
    return {
        .make = "Sony", .model = "ILCE-7M2", .serial = "SIM7", .width_px = lens.width_px, .height_px = lens.height_px};
  }
  std::vector<double> shutter_times_s() override { return small().shutter_times_s(); }
  rig::CameraSettings configure(const rig::CameraSettings& wanted) override { return now_ = small().configure(wanted); }
  rig::Picture capture() override {
    rig::RawFrame frame{.mosaic = mosaic(drawing()), .settings = now_, .utc = clock_.utc(), .serial = "SIM7"};
    clock_.sleep_s(now_.exposure_s);
    return {.bytes = rig::encode_raw(frame), .extension = "arw", .settings = now_, .utc = frame.utc};
  }
  std::vector<std::byte> preview() override { return {}; }

 private:
  rig::Camera& small() {
    static rig::SimulatedBench bench(small_rig_.simulation->truth, draw_);
    static const auto camera = rig::make_simulated_camera(bench, clock_);
    return *camera;
  }
  const cv::Mat3f& drawing() {
    rig::BenchState state = bench_.state();
    for (const auto& [drawn, picture] : drawings_)
      if (rig::same_state(drawn, state)) return picture;
    state.lens = small_rig_.simulation->truth.lens;
    drawings_.emplace_back(bench_.state(), draw_(state));
    return drawings_.back().second;
  }
  // One colour after the other, because all three enlarged at once need 288 MB.
  cv::Mat1w mosaic(const cv::Mat3f& drawn) {
    const rig::TrueSensor& sensor = bench_.truth().sensor;
    const double range = sensor.white_level_dn - sensor.black_level_dn;
    const auto factor = static_cast<float>(range * now_.exposure_s);
    cv::Mat1w result(drawn.rows * kEnlarge, drawn.cols * kEnlarge);
    for (int colour = 0; colour < 3; ++colour) {
      cv::Mat1f plane, enlarged_plane;
      cv::extractChannel(drawn, plane, colour);
      cv::resize(plane, enlarged_plane, result.size(), 0, 0, cv::INTER_LINEAR);
      for (int row = 0; row < result.rows; ++row)
        for (int column = 0; column < result.cols; ++column) {
          if ((row & 1) + (column & 1) != colour) continue;
          random_ = random_ * 6364136223846793005ULL + 1442695040888963407ULL;
          const float noise = 8 * (static_cast<float>(random_ >> 40U) / static_cast<float>(1 << 24) - 0.5F);
          const float dn = enlarged_plane(row, column) * factor + noise;
          result(row, column) = static_cast<unsigned short>(std::clamp(dn + static_cast<float>(sensor.black_level_dn),
                                                                       0.F, static_cast<float>(sensor.white_level_dn)));
        }
    }
    return result;
  }

  rig::SimulatedBench& bench_;
  rig::Clock& clock_;
  RigFile small_rig_;
  rig::DrawPicture draw_;
  rig::CameraSettings now_;
  static inline std::list<std::pair<rig::BenchState, cv::Mat3f>> drawings_;  // all sessions have the same hand
  std::uint64_t random_ = 1;
};

// Real seconds, and those of the session's clock, inside the devices' calls.
struct DeviceTime {
  rig::Clock& clock;
  double wall_s = 0, clock_s = 0;
  int calls = 0;
  template <typename Call>
  auto of(const Call& call) {
    struct Span {
      DeviceTime& time;
      double wall = now_s(), clock = time.clock.monotonic_s();
      ~Span() {
        time.wall_s += now_s() - wall, time.clock_s += time.clock.monotonic_s() - clock;
        ++time.calls;
      }
    } span{*this};
    return call();
  }
};

class TimedCamera final : public rig::Camera {
 public:
  TimedCamera(rig::Camera& camera, DeviceTime& pictures, DeviceTime& settings, double& exposed_s)
      : camera_(camera), pictures_(pictures), settings_(settings), exposed_s_(exposed_s) {}
  rig::CameraIdentity identity() override { return camera_.identity(); }
  std::vector<double> shutter_times_s() override {
    return settings_.of([&] { return camera_.shutter_times_s(); });
  }
  rig::CameraSettings configure(const rig::CameraSettings& wanted) override {
    return now_ = settings_.of([&] { return camera_.configure(wanted); });
  }
  rig::Picture capture() override {
    exposed_s_ += now_.exposure_s;
    return pictures_.of([&] { return camera_.capture(); });
  }
  std::vector<std::byte> preview() override { return camera_.preview(); }

 private:
  rig::Camera& camera_;
  DeviceTime& pictures_;
  DeviceTime& settings_;
  double& exposed_s_;
  rig::CameraSettings now_;
};

class TimedTurntable final : public rig::Turntable {
 public:
  TimedTurntable(rig::Turntable& turntable, DeviceTime& moves) : turntable_(turntable), moves_(moves) {}
  void home() override {
    moves_.of([&] { turntable_.home(); });
  }
  void move_to(double angle_rad) override {
    moves_.of([&] { turntable_.move_to(angle_rad); });
  }
  void stop() override { turntable_.stop(); }
  double angle_rad() override { return turntable_.angle_rad(); }
  rig::TurntableState state() override { return turntable_.state(); }

 private:
  rig::Turntable& turntable_;
  DeviceTime& moves_;
};

double megabytes(long kilobytes) {
  return static_cast<double>(kilobytes) / 1024;
}

void capture(const fs::path& folder, bool real_clock) {
  const RigFile rig = large_rig();
  const std::string spool_file = std::string(DATA_DIR) + "/spools/silk_red.json";
  std::unique_ptr<rig::Clock> clock;
  if (real_clock)
    clock = std::make_unique<rig::SystemClock>();
  else
    clock = std::make_unique<rig::SimulatedClock>(1.8e9);
  rig::SimulatedBench bench(rig.simulation->truth, [](const rig::BenchState&) { return cv::Mat3f(); });
  LargeCamera lens(bench, *clock);
  const auto body = rig::make_simulated_body(lens);
  const auto network = rig::serve_on_ptpip(*body);
  rig::CameraProcessSetup setup{.command = {"/proc/self/exe", kCameraProcess}, .camera = rig.camera_wire->setup};
  setup.camera.width_px = rig.simulation->truth.lens.width_px,
  setup.camera.height_px = rig.simulation->truth.lens.height_px;
  setup.camera.port = "ptpip:127.0.0.1:" + std::to_string(network->port()) + ":" + std::to_string(network->port());
  const auto camera = rig::make_process_camera(setup);
  const auto wire = rig::serve_on_pty(start_firmware(rig, bench, *clock));
  const auto turntable = rig::make_stepper_turntable(
      [&] { return rig::connect_grbl(rig::open_pty_line(wire->path()), *clock, rig.turntable_wire->controller); },
      *clock, rig.turntable_wire->stepper);
  const auto person = rig::make_simulated_operator(bench);

  DeviceTime pictures{*clock}, moves{*clock}, settings{*clock};
  double exposed_s = 0;
  TimedCamera timed_camera(*camera, pictures, settings, exposed_s);
  TimedTurntable timed_turntable(*turntable, moves);
  const nlohmann::json rig_document = read_json_file(std::string(DATA_DIR) + "/rigs/simulated_wire_grbl.json"),
                       spool_document = read_json_file(spool_file);
  const RigCalibration calibration = large_calibration();
  const Plan plan = plan_of(rig, read_spool(spool_file));
  SessionFile asked{
      .utc = clock->utc(), .software = software_version(), .rig = rig, .spool = read_spool(spool_file), .plan = plan};
  const std::string text = to_json(calibration).dump();
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  FileSystem disk;
  fs::remove_all(folder);
  SessionFolder session =
      SessionFolder::create(folder, make_session_document(asked.utc, rig_document, spool_document, plan),
                            {{"calibration.json", {bytes, bytes + text.size()}}}, *clock, disk);
  const double began_wall_s = now_s(), began_clock_s = clock->monotonic_s();
  const RunState state = run_session(session, {timed_camera, timed_turntable, *person, *clock}, asked, calibration, {});
  const double wall_s = now_s() - began_wall_s, clock_s = clock->monotonic_s() - began_clock_s;
  rusage self{};
  ::getrusage(RUSAGE_SELF, &self);
  double waited_s = 0;
  for (const JournalRecord& record : session.records())
    if (record.event == "lamp_watch") waited_s += record.data.at("waited_s").get<double>();
  std::printf("%s clock: %s, %d pictures (%.1f s of exposure), %d moves\n", real_clock ? "real" : "injected",
              state_name(state).c_str(), pictures.calls, exposed_s, moves.calls);
  const double total_s = real_clock ? wall_s : clock_s;
  const double inside_s = real_clock ? pictures.wall_s + moves.wall_s : pictures.clock_s + moves.clock_s;
  std::printf(
      "  %.1f s in all; exposure and download %.1f s, motion %.1f s; the lamp's settling %.1f s; everything else "
      "%.1f s = %.1f %%, the camera's settings %.1f s of it\n",
      total_s, real_clock ? pictures.wall_s : pictures.clock_s, real_clock ? moves.wall_s : moves.clock_s, waited_s,
      total_s - inside_s - waited_s, 100 * (total_s - inside_s - waited_s) / total_s,
      real_clock ? settings.wall_s : settings.clock_s);
  std::printf("  largest memory of this process, bench included: %.0f MiB\n", megabytes(self.ru_maxrss));
  std::fflush(stdout);
}

void develop(const fs::path& folder) {
  const double began_s = now_s();
  const DevelopedViews developed = develop_session(folder, ProgressStyle::quiet);
  const double took_s = now_s() - began_s;
  rusage self{};
  ::getrusage(RUSAGE_SELF, &self);
  const double processor_s = static_cast<double>(self.ru_utime.tv_sec + self.ru_stime.tv_sec);
  std::printf("developed %zu views: %.1f s, %.1f s of processor time, at most %.0f MiB\n", developed.views.size(),
              took_s, processor_s, megabytes(self.ru_maxrss));
  // The same reading and writing alone, one after the other.
  double read_s = 0, libraw_s = 0, write_s = 0;
  for (const DevelopedView& view : developed.views) {
    const fs::path raw = folder / "raw" / (view.view.id + ".arw");
    double start_s = now_s();
    std::ifstream file(raw, std::ios::binary);
    std::vector<char> bytes(fs::file_size(raw));
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    read_s += now_s() - start_s;
    start_s = now_s();
    calibration::read_sensor_bytes(std::as_bytes(std::span(bytes)), "a view");
    libraw_s += now_s() - start_s;
    const cv::Mat3f picture = renderer::read_exr(folder / view.image_file);
    start_s = now_s();
    renderer::write_exr(folder / "again.exr", picture, {{"compression", "none"}});
    write_s += now_s() - start_s;
  }
  fs::remove(folder / "again.exr");
  std::printf(
      "  of that, alone and one after the other: LibRaw %.1f s, raw files from the disk %.1f s, EXR to the "
      "disk %.1f s, of %zu views\n",
      libraw_s, read_s, write_s, developed.views.size());
}

// Each part in a process of its own, whose memory is its own.
void in_child(const std::function<void()>& part) {
  std::fflush(stdout);
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      part();
    } catch (const std::exception& error) {
      std::printf("failed: %s\n", error.what());
    }
    std::fflush(stdout);
    ::_exit(0);
  }
  ::waitpid(child, nullptr, 0);
}

}  // namespace
}  // namespace station

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], station::kCameraProcess) == 0)
    return rig::run_camera_process(3, rig::make_gphoto_camera);
  const std::filesystem::path folder = argc > 1 ? argv[1] : std::filesystem::temp_directory_path() / "bench_session";
  std::filesystem::create_directories(folder);
  station::in_child([&] {
    station::capture(folder / "session", false);
    station::capture(folder / "session", true);
  });
  station::in_child([&] { station::develop(folder / "session"); });
  std::filesystem::remove_all(folder);
}
