// Every command of the program that opens a turntable is stopped at random moments, by everything that stops a program.
// The program lists these commands itself; here stands only what their options need.
//
// Each stop has a bench of its own in real time, with firmware on a pseudo-terminal and a camera on the network, and
// runs the program as a person does. THREADSTATION_STOPS in the environment says how many there are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <future>
#include <iostream>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <regex>
#include <sstream>
#include <thread>
#include <utility>

#include "station/bench/platform_memory.h"
#include "station/bench/rig_devices.h"
#include "station/documents/degree.h"
#include "station/documents/reader.h"
#include "station/serve/technician_page.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using nlohmann::json;
using station::kDegree;
using station_test::run_threadstation;

constexpr double kLeftAtDeg = 100;  // where somebody left the platform
constexpr double kMostWayDeg = 5, kMostWayOfKilledDeg = 24;
constexpr int kLanes = 4;

enum class Ending { interrupt, terminate, hang_up, twice, kill };

const char* name_of(Ending ending) {
  switch (ending) {
    case Ending::interrupt:
      return "SIGINT";
    case Ending::terminate:
      return "SIGTERM";
    case Ending::hang_up:
      return "SIGHUP";
    case Ending::twice:
      return "/api/stop";  // which is SIGINT twice
    case Ending::kill:
      return "SIGKILL";
  }
  return "";
}

enum class Board { grbl_with_switch, grbl_here, zaber };

const char* name_of(Board board) {
  return board == Board::zaber ? "Zaber" : board == Board::grbl_here ? "GRBL without a switch" : "GRBL with a switch";
}

// The names under the heading of --help, down to the next one.
std::vector<std::string> turning_commands() {
  std::istringstream help(run_threadstation({"--help"}).out);
  std::vector<std::string> names;
  bool listed = false;
  for (std::string line; std::getline(help, line);) {
    if (!line.empty() && line.front() != ' ') listed = line.starts_with("Commands that turn the platform");
    std::smatch found;
    if (listed && std::regex_search(line, found, std::regex("^  ([a-z-]+) "))) names.push_back(found[1]);
  }
  return names;
}

// The time of a board that this process plays. It passes as real time does, but while the thread that plays the board
// gets no processor it stands still: a real board has a processor of its own, and turns no platform while it is not
// listening.
class BoardClock final : public rig::Clock {
 public:
  double monotonic_s() override {
    constexpr double kMostAtOnceS = 0.02;
    const std::lock_guard hold(mutex_);
    const double now_s = real_.monotonic_s();
    passed_s_ += std::min(now_s - std::exchange(seen_s_, now_s), kMostAtOnceS);
    return passed_s_;
  }
  std::string utc() override { return real_.utc(); }
  void sleep_s(double duration_s) override { real_.sleep_s(duration_s); }
  // What has passed for the board when it last looked.
  double passed_s() const {
    const std::lock_guard hold(mutex_);
    return passed_s_;
  }

 private:
  mutable std::mutex mutex_;
  rig::SystemClock real_;
  double seen_s_ = real_.monotonic_s(), passed_s_ = 0;
};

// A bench in real time, whose devices are found at ports, and the rig file that names them.
class Lab {
 public:
  explicit Lab(Board board) : board_(board) {
    const std::string fixtures = FIXTURES_DIR;
    document_ = station::read_json_file(
        fixtures + (board == Board::zaber ? "/rigs/simulated_wire_zaber.json" : "/rigs/simulated_wire_grbl.json"));
    document_["simulation"]["turntable"]["scale"] = 1;
    if (board == Board::grbl_here) document_["turntable_setup"]["home"] = "here";
    const station::RigFile served = station::parse_rig(document_, "the bench");
    devices_.clock = std::make_unique<rig::SystemClock>();
    devices_.bench = std::make_unique<rig::SimulatedBench>(served.simulation->truth, [](const rig::BenchState& state) {
      return cv::Mat3f(state.lens.height_px, state.lens.width_px, cv::Vec3f::all(0.1F));
    });
    devices_.bench->turn_platform(kLeftAtDeg * kDegree);
    port_ = station::start_firmware(served, *devices_.bench, *board_clock_);
    devices_.simulated_wire = rig::serve_on_pty(port_);
    station::start_simulated_camera(served, devices_);
    const std::string camera = std::to_string(devices_.simulated_camera.network->port());
    document_["turntable_setup"]["line"] = "pty";
    document_["turntable_setup"]["port"] = devices_.simulated_wire->path();
    document_["camera_connection"]["port"] = "ptpip:127.0.0.1:" + camera + ":" + camera;
    document_["camera_connection"]["width_px"] = document_["simulation"]["sensor"]["width_px"];
    document_["camera_connection"]["height_px"] = document_["simulation"]["sensor"]["height_px"];
    document_.erase("simulation");
    document_["operator"] = "console";
    document_["name"] = station::read_json_file(fixtures + "/rigs/simulated.json")["name"];  // of the calibration's rig
    station::write_json_file(rig_file(), document_);
    std::ofstream(folder_ / "answers") << std::string(10000, '\n');
    if (board == Board::grbl_here)
      station::remember_platform(memory_file(), nullptr)->keep({.steps = 0, .angle_rad = kLeftAtDeg * kDegree});
  }

  fs::path rig_file() const { return folder_ / "rig.json"; }
  fs::path in(const std::string& name) const { return folder_ / name; }
  double angle_deg() const {
    port_->plugged();
    return devices_.bench->state().platform_angle_rad / kDegree;
  }
  double board_time_s() const { return board_clock_->passed_s(); }
  std::map<std::string, std::string> environment() const { return {{"XDG_STATE_HOME", in("state")}}; }

  // The angle at which the memory says that the platform stands; nothing when it says that it was turning.
  std::optional<double> remembered_deg() const {
    const auto place = station::remember_platform(memory_file(), nullptr)->recall();
    return place && !place->turning ? std::optional(place->angle_rad / kDegree) : std::nullopt;
  }

 private:
  // The file's name is the program's affair; its folder is new.
  fs::path memory_file() const {
    station::RigFile rig = station::parse_rig(document_, "the rig");
    return in("state") / "threadstation" / station::platform_memory_file(rig).filename();
  }

  Board board_;
  station_test::TemporaryFolder folder_;
  json document_;
  std::unique_ptr<BoardClock> board_clock_ = std::make_unique<BoardClock>();
  station::RigDevices devices_;
  std::shared_ptr<rig::SimulatedPort> port_;
};

// The arguments for a command, by the names of the options that its help lists.
std::vector<std::string> arguments_for(const std::string& command, const Lab& lab) {
  const std::string help = run_threadstation({command, "--help"}).out;
  const std::string fixtures = FIXTURES_DIR;
  const std::vector<std::pair<std::string, std::string>> known{
      {"--rig", lab.rig_file()},
      {"--calibration", fixtures + "/calibrations/simulated.json"},
      {"--spool", fixtures + "/spools/silk_red.json"},
      {"--out", lab.in("out")}};
  std::vector<std::string> arguments{command};
  for (const auto& [option, value] : known)
    if (help.find("  " + option + " ") != std::string::npos) arguments.insert(arguments.end(), {option, value});
  if (help.find("--accept-calibration") != std::string::npos) arguments.emplace_back("--accept-calibration");
  return arguments;
}

struct Stopped {
  std::string what;
  bool turned = false;  // it was turning when it was stopped
  double way_deg = 0;   // from the signal on
  std::string problem;  // of what must hold afterwards
};

bool has_ended(pid_t process) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == process;
}

double wait_until_it_stands(const Lab& lab) {
  constexpr double kStandsS = 0.4;
  double before = lab.angle_deg();
  for (double since_s = lab.board_time_s(); lab.board_time_s() - since_s < kStandsS;) {
    std::this_thread::sleep_for(20ms);
    if (std::exchange(before, lab.angle_deg()) != before) since_s = lab.board_time_s();
  }
  return before;
}

void end(pid_t process, Ending ending) {
  const int signal = ending == Ending::terminate ? SIGTERM
                     : ending == Ending::hang_up ? SIGHUP
                     : ending == Ending::kill    ? SIGKILL
                                                 : SIGINT;
  kill(process, signal);
  if (ending != Ending::twice) return;
  std::this_thread::sleep_for(20ms);
  kill(process, SIGINT);
}

// Stops `command` `delay_s` after the platform began to turn.
Stopped stop(const std::string& command, Board board, Ending ending, double delay_s) {
  Stopped result{.what = command + ", " + name_of(board) + ", " + name_of(ending) + " after " +
                         std::to_string(delay_s) + " s"};
  const Lab lab(board);
  const pid_t process =
      station_test::start_threadstation(arguments_for(command, lab), lab.in("answers"), lab.environment());
  const auto patience = std::chrono::steady_clock::now() + 60s;
  while (lab.angle_deg() == kLeftAtDeg && !has_ended(process) && std::chrono::steady_clock::now() < patience)
    std::this_thread::sleep_for(2ms);
  if (lab.angle_deg() == kLeftAtDeg) result.problem = "it never turned";
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(delay_s);
  while (std::chrono::steady_clock::now() < until && !has_ended(process)) std::this_thread::sleep_for(1ms);
  const double before = lab.angle_deg();
  std::this_thread::sleep_for(5ms);
  const double told_deg = lab.angle_deg();
  result.turned = told_deg != before;
  end(process, ending);
  const double stood_deg = wait_until_it_stands(lab);
  result.way_deg = std::abs(stood_deg - told_deg);
  const auto patience_to_end = std::chrono::steady_clock::now() + 60s;
  while (!has_ended(process) && std::chrono::steady_clock::now() < patience_to_end) std::this_thread::sleep_for(10ms);
  if (!has_ended(process)) {
    result.problem = "the program goes on";
    kill(process, SIGKILL);
  }
  station_test::wait_for(process);
  // A controller that looks for its switch when its program is killed finds it, and stands there.
  const bool found_home = ending == Ending::kill && board != Board::grbl_here && std::abs(stood_deg) < 0.1;
  if (found_home) result.way_deg = 0;
  const double most_deg = ending == Ending::kill ? kMostWayOfKilledDeg : kMostWayDeg;
  if (result.way_deg > most_deg) result.problem = "it went on for " + std::to_string(result.way_deg) + " deg";
  if (std::abs(lab.angle_deg() - stood_deg) > 0) result.problem = "it turned again";
  if (board == Board::grbl_here && ending != Ending::kill) {
    const auto remembered = lab.remembered_deg();
    if (!remembered || std::abs(*remembered - lab.angle_deg()) > 0.03)
      result.problem = "it stands at " + std::to_string(lab.angle_deg()) + " deg and remembers " +
                       (remembered ? std::to_string(*remembered) : "nothing");
  }
  return result;
}

int wanted_stops() {
  const char* asked = std::getenv("THREADSTATION_STOPS");
  return asked == nullptr ? 60 : std::atoi(asked);
}

}  // namespace

TEST(StopEveryCommand, TheProgramListsThoseThatTurnThePlatform) {
  EXPECT_THAT(turning_commands(), testing::IsSupersetOf({"calibrate", "capture", "check", "home", "preview"}));
}

// Whoever presses Escape in a browser posts this.
TEST(StopEveryCommand, ThePagesEmergencyStopEndsACheckThatTurns) {
  for (const Board board : {Board::grbl_with_switch, Board::zaber}) {
    const Lab lab(board);
    station::TechnicianPage page(
        lab.rig_file(), lab.in("workspace"), [] {}, THREADSTATION_PROGRAM);
    const auto post = [&](const std::string& path, const json& fields) {
      const station::HttpRequest request{.method = "POST", .path = path, .body = fields.dump()};
      const auto urgent = page.urgent(request);
      return urgent ? *urgent : page.handle(request);
    };
    ASSERT_EQ(post("/api/control", {{"client", "me"}}).status, 200);
    ASSERT_EQ(post("/api/job", {{"client", "me"}, {"kind", "check"}}).status, 200);
    const auto patience = std::chrono::steady_clock::now() + 60s;
    while (lab.angle_deg() == kLeftAtDeg && std::chrono::steady_clock::now() < patience)
      std::this_thread::sleep_for(2ms);
    std::this_thread::sleep_for(1s);
    const double told_deg = lab.angle_deg();
    ASSERT_NE(told_deg, kLeftAtDeg) << "it never turned";
    EXPECT_EQ(post("/api/stop", {{"client", "a watcher"}}).status, 200);
    EXPECT_LE(std::abs(wait_until_it_stands(lab) - told_deg), kMostWayDeg) << name_of(board);
    const auto state = [&] { return json::parse(page.handle({.method = "GET", .path = "/api/state"}).body).at("job"); };
    while (state().at("running") == true && std::chrono::steady_clock::now() < patience)
      std::this_thread::sleep_for(20ms);
    EXPECT_EQ(state().at("running"), false);
    EXPECT_NE(state().at("status"), 0);
    EXPECT_THAT(state().at("lines").dump(), testing::HasSubstr("the check was stopped"));
  }
}

TEST(StopEveryCommand, AtRandomMomentsNeverGoesOnForMoreThanFiveDegrees) {
  constexpr unsigned kSeed = 20261123;
  const int stops = wanted_stops();
  std::cout << stops << " stops, seed " << kSeed << "\n";
  std::vector<std::string> commands = turning_commands();
  std::erase(commands, "preview");  // it opens a turntable and never turns it
  std::mutex drawing;
  std::mt19937 random(kSeed);
  int drawn = 0;
  std::vector<Stopped> results;
  const auto lane = [&] {
    for (;;) {
      std::unique_lock hold(drawing);
      if (drawn == stops) return;
      const auto at = static_cast<std::size_t>(drawn++);
      const std::string command = commands[at % commands.size()];
      const auto board = static_cast<Board>(std::uniform_int_distribution(0, 2)(random));
      const auto ending = static_cast<Ending>(std::uniform_int_distribution(0, 4)(random));
      const double delay_s = std::uniform_real_distribution(0.0, 4.0)(random);
      hold.unlock();
      Stopped result = stop(command, board, ending, delay_s);
      hold.lock();
      results.push_back(std::move(result));
    }
  };
  std::vector<std::future<void>> lanes;
  for (int i = 0; i < kLanes; ++i) lanes.push_back(std::async(std::launch::async, lane));
  for (std::future<void>& one : lanes) one.get();
  int turned = 0;
  double longest_deg = 0, longest_of_killed_deg = 0;
  for (const Stopped& result : results) {
    EXPECT_EQ(result.problem, "") << result.what;
    turned += result.turned;
    double& longest = result.what.find("SIGKILL") == std::string::npos ? longest_deg : longest_of_killed_deg;
    longest = std::max(longest, result.way_deg);
  }
  std::cout << turned << " while it turned; the longest way " << longest_deg << " deg, of a killed program "
            << longest_of_killed_deg << " deg\n";
  EXPECT_GT(turned, stops / 3);
}
