// A bench of its own for a test that runs the program as a person does: firmware on a pseudo-terminal, a camera on the
// network, and the rig file that names them.
#pragma once

#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "station/bench/platform_memory.h"
#include "station/bench/rig_devices.h"
#include "station/documents/degree.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"
#include "tests/support/documented_firmware.h"

namespace station_test {

inline constexpr double kLeftFarDeg = 100, kLeftNearDeg = 3;  // where somebody left the platform
// The board's seconds to a real one: until it is to be stopped; from then on, so that a stop that this computer is late
// to deliver is not the program's; once the board has heard it, because a program waits so many real seconds for a
// platform that brakes; and behind the stop.
inline constexpr double kQuick = 4, kSlow = 0.1, kBraking = 0.5, kQuickest = 8;
inline constexpr auto kPatience = std::chrono::seconds(120);

// Both simulations of GRBL: this project's own, and the one that was written from the protocol's documentation alone.
enum class Board { grbl_with_switch, grbl_here, documented_with_switch, documented_here, zaber };
inline constexpr int kBoards = 5;

inline bool is_here(Board board) {
  return board == Board::grbl_here || board == Board::documented_here;
}
inline bool is_documented(Board board) {
  return board == Board::documented_with_switch || board == Board::documented_here;
}
inline std::string name_of(Board board) {
  if (board == Board::zaber) return "Zaber";
  return std::string(is_documented(board) ? "documented GRBL" : "GRBL") +
         (is_here(board) ? " without a switch" : " with a switch");
}

// The time of a board that this process plays, at a pace of its own. While the thread that plays the board gets no
// processor it stands still: a real board has a processor of its own, and turns no platform while it is not listening.
class BoardClock final : public rig::Clock {
 public:
  double monotonic_s() override {
    constexpr double kMostAtOnceS = 0.02;
    const std::lock_guard hold(mutex_);
    const double now_s = real_.monotonic_s();
    passed_s_ += pace_ * std::min(now_s - std::exchange(seen_s_, now_s), kMostAtOnceS);
    return passed_s_;
  }
  std::string utc() override { return real_.utc(); }
  void sleep_s(double duration_s) override { real_.sleep_s(duration_s); }
  void set_pace(double pace) {
    monotonic_s();
    const std::lock_guard hold(mutex_);
    pace_ = pace;
  }
  // What has passed for the board when it last looked.
  double passed_s() const {
    const std::lock_guard hold(mutex_);
    return passed_s_;
  }

 private:
  mutable std::mutex mutex_;
  rig::SystemClock real_;
  double seen_s_ = real_.monotonic_s(), passed_s_ = 0, pace_ = kQuick;
};

// A port whose board somebody may switch off, to turn the platform by hand and to switch it on again.
class AttendedPort final : public rig::SimulatedPort {
 public:
  using PowerOn = std::function<std::shared_ptr<rig::SimulatedPort>(std::optional<double> turned_to_deg)>;
  explicit AttendedPort(PowerOn another) : another_(std::move(another)), port_(another_(std::nullopt)) {}

  void power_on() override { port()->power_on(); }
  void opened() override {
    {
      const std::lock_guard hold(mutex_);
      if (++openings_ == turned_at_opening_) port_ = another_(turned_to_deg_);
    }
    port()->opened();
  }
  void receive(std::string_view bytes) override {
    // GRBL's feed hold, cancelled jog and reset; Zaber's word.
    if (bytes.find_first_of("!\x85\x18") != bytes.npos || bytes.find("stop") != bytes.npos) ++stops_heard_;
    port()->receive(bytes);
  }
  std::string transmit() override { return port()->transmit(); }
  void unplug() override { port()->unplug(); }
  bool plugged() override { return port()->plugged(); }
  int operations() override { return port()->operations(); }

  int openings() const {
    const std::lock_guard hold(mutex_);
    return openings_;
  }
  int stops_heard() const { return stops_heard_; }
  // By hand, right before a program opens the port for the Nth time.
  void turn_before_opening(int opening, double to_deg) {
    const std::lock_guard hold(mutex_);
    turned_at_opening_ = opening;
    turned_to_deg_ = to_deg;
  }

 private:
  std::shared_ptr<rig::SimulatedPort> port() const {
    const std::lock_guard hold(mutex_);
    return port_;
  }

  PowerOn another_;
  std::atomic<int> stops_heard_ = 0;
  mutable std::mutex mutex_;  // guards what follows
  std::shared_ptr<rig::SimulatedPort> port_;
  int openings_ = 0, turned_at_opening_ = 0;
  double turned_to_deg_ = 0;
};

// A bench whose devices are found at ports, and the rig file that names them.
class Lab {
 public:
  explicit Lab(Board board, double left_at_deg = kLeftFarDeg) {
    const std::string data = DATA_DIR;
    document_ = station::read_json_file(
        data + (board == Board::zaber ? "/rigs/simulated_wire_zaber.json" : "/rigs/simulated_wire_grbl.json"));
    document_["simulation"]["turntable"]["scale"] = 1;
    if (is_here(board)) document_["turntable_setup"]["home"] = "here";
    const station::RigFile served = station::parse_rig(document_, "the bench");
    // Exposures are over at once, or calibrations would take minutes; the date is the present one.
    const auto date = std::chrono::system_clock::now().time_since_epoch();
    devices_.clock = std::make_unique<rig::SimulatedClock>(std::chrono::duration<double>(date).count());
    devices_.bench = std::make_unique<rig::SimulatedBench>(served.simulation->truth, [](const rig::BenchState& state) {
      return cv::Mat3f(state.lens.height_px, state.lens.width_px, cv::Vec3f::all(0.1F));
    });
    devices_.bench->turn_platform(left_at_deg * station::kDegree);
    port_ = std::make_shared<AttendedPort>([this, board, served](std::optional<double> turned_to_deg) {
      if (turned_to_deg) devices_.bench->turn_platform(*turned_to_deg * station::kDegree);
      return is_documented(board)
                 ? rig::make_simulated_port(make_documented_firmware(*devices_.bench, *board_clock_, !is_here(board)))
                 : station::start_firmware(served, *devices_.bench, *board_clock_);
    });
    devices_.simulated_wire = rig::serve_on_pty(port_);
    station::start_simulated_camera(served, devices_);
    const std::string camera = std::to_string(devices_.simulated_camera.network->port());
    document_["turntable_setup"]["reply_timeout_s"] = 20;  // this computer plays the board, and has other things to do
    document_["turntable_setup"]["line"] = "pty";
    document_["turntable_setup"]["port"] = devices_.simulated_wire->path();
    document_["camera_connection"]["port"] = "ptpip:127.0.0.1:" + camera + ":" + camera;
    document_["camera_connection"]["width_px"] = document_["simulation"]["sensor"]["width_px"];
    document_["camera_connection"]["height_px"] = document_["simulation"]["sensor"]["height_px"];
    document_.erase("simulation");
    document_["operator"] = "console";
    document_["name"] =
        station::read_json_file(std::string(DATA_DIR) + "/rigs/simulated.json")["name"];  // of the calibration's rig
    station::write_json_file(rig_file(), document_);
    std::ofstream(folder_ / "answers") << std::string(10000, '\n');
    if (is_here(board))
      station::remember_platform(memory_file(), nullptr)
          ->keep({.steps = 0, .angle_rad = left_at_deg * station::kDegree});
  }

  std::filesystem::path rig_file() const { return folder_ / "rig.json"; }
  std::filesystem::path in(const std::string& name) const { return folder_ / name; }
  double angle_deg() const {
    port_->plugged();
    return devices_.bench->state().platform_angle_rad / station::kDegree;
  }
  double board_time_s() const { return board_clock_->passed_s(); }
  int openings() const { return port_->openings(); }  // of its turntable's port
  int stops_heard() const { return port_->stops_heard(); }
  void turn_by_hand_before_opening(int opening, double to_deg) const { port_->turn_before_opening(opening, to_deg); }
  void set_pace(double pace) const { board_clock_->set_pace(pace); }
  std::map<std::string, std::string> environment() const { return {{"XDG_STATE_HOME", in("state")}}; }

  // The program in the background, with a person who agrees to everything, or nobody; and until its end.
  pid_t start(const std::vector<std::string>& arguments, bool attended = true) const {
    return start_threadstation(arguments, attended ? in("answers") : "/dev/null", environment(), in("errors"));
  }
  // What the program that was started last said last.
  std::string last_error() const {
    std::ifstream errors(in("errors"));
    std::string last;
    for (std::string line; std::getline(errors, line);)
      if (!line.empty()) last = line;
    return last;
  }
  int run(const std::vector<std::string>& arguments) const { return wait_for(start(arguments)); }

  std::optional<rig::PlatformPlace> remembered() const {
    return station::remember_platform(memory_file(), nullptr)->recall();
  }
  // The angle at which the memory says that the platform stands; nothing when it does not know.
  std::optional<double> remembered_deg() const {
    const auto place = remembered();
    return place && !place->turning && !place->lost ? std::optional(place->angle_rad / station::kDegree) : std::nullopt;
  }

 private:
  // The file's name is the program's affair; its folder is new.
  std::filesystem::path memory_file() const {
    station::RigFile rig = station::parse_rig(document_, "the rig");
    return in("state") / "threadstation" / station::platform_memory_file(rig).filename();
  }

  TemporaryFolder folder_;
  nlohmann::json document_;
  std::unique_ptr<BoardClock> board_clock_ = std::make_unique<BoardClock>();
  station::RigDevices devices_;
  std::shared_ptr<AttendedPort> port_;
};

inline bool has_ended(pid_t process) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == process;
}

// False when it goes on for too long; it is ended then.
inline bool ends(pid_t process) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!has_ended(process) && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const bool by_itself = has_ended(process);
  if (!by_itself) kill(process, SIGKILL);
  return by_itself;
}

inline double wait_until_it_stands(const Lab& lab) {
  constexpr double kStandsS = 0.4;
  double before = lab.angle_deg();
  for (double since_s = lab.board_time_s(); lab.board_time_s() - since_s < kStandsS;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (std::exchange(before, lab.angle_deg()) != before) since_s = lab.board_time_s();
  }
  return before;
}

// Returns while the platform turns, after it has begun to for so many times; false when the program ended before.
inline bool turns(const Lab& lab, int times, pid_t process) {
  constexpr double kPauseS = 0.3;
  const auto until = std::chrono::steady_clock::now() + kPatience;
  double before = lab.angle_deg(), stood_since_s = lab.board_time_s() - kPauseS;
  while (!has_ended(process) && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const double now_s = lab.board_time_s();
    if (std::exchange(before, lab.angle_deg()) == before) continue;
    const bool begins = now_s - std::exchange(stood_since_s, now_s) >= kPauseS;
    if (begins && --times == 0) return true;
  }
  return false;
}

}  // namespace station_test
