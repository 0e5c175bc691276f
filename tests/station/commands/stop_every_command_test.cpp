// Every command of the program that opens a turntable is stopped in its own motions, by everything that stops a
// program, on every board. The program lists these commands itself; here stands only what their options need.
//
// Each stop has a bench of its own (lab.h) and runs the program as a person does. THREADSTATION_STOPS in the
// environment says how many there are; as it is, every command, board and ending meet once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <future>
#include <iostream>
#include <iterator>
#include <mutex>
#include <random>
#include <regex>
#include <sstream>
#include <thread>
#include <utility>

#include "station/serve/technician_page.h"
#include "tests/places.h"
#include "tests/station/commands/lab.h"
#include "tests/station/commands/program.h"

namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using namespace station_test;

constexpr double kMostWayDeg = 5, kMostWayOfKilledDeg = 24;
constexpr double kSameDeg = 0.03;
constexpr int kEndings = 5, kMotions = 4;
constexpr int kLanes = 3;  // most of the time is waiting

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

// The names of which --help says so.
std::vector<std::string> turning_commands() {
  std::istringstream help(run_threadstation({"--help"}).out);
  std::vector<std::string> names;
  std::smatch found;
  for (std::string line; std::getline(help, line);)
    if (std::regex_search(line, found, std::regex("^  ([a-z-]+) .*\\(turns the platform\\)$")))
      names.push_back(found[1]);
  return names;
}

// A way in which a command is run.
struct Way {
  std::string command;
  std::vector<std::string> besides{};  // options that take the place of those that begin something new
  int opening = 1;                     // its motions count since it has opened the turntable for so many times
  std::string name() const {
    return command + (besides.empty() ? "" : " " + besides.front()) +
           (opening == 1 ? "" : ", turntable opened " + std::to_string(opening) + " times");
  }
  bool goes_on() const { return !besides.empty() && (besides.front() == "--resume" || besides.front() == "--reshoot"); }
};

// The arguments, by the names of the options that the command's help lists.
std::vector<std::string> arguments_for(const Way& way, const Lab& lab) {
  std::istringstream words(way.command);
  std::vector<std::string> arguments{std::istream_iterator<std::string>(words), {}};
  std::vector<std::string> for_help = arguments;
  for_help.emplace_back("--help");
  const std::string help = run_threadstation(for_help).out;
  const std::string data = DATA_DIR;
  for (const std::string& word : way.besides)
    arguments.push_back(word.ends_with(".csv") ? lab.in(word).string() : word);
  const auto add = [&](const std::string& option, const std::string& value) {
    if (help.find("  " + option + " ") != std::string::npos) arguments.insert(arguments.end(), {option, value});
  };
  add("--out", lab.in("out"));
  if (way.goes_on()) return arguments;
  add("--rig", lab.rig_file());
  add("--like", lab.rig_file());
  add("--calibration", data + "/calibrations/simulated.json");
  if (way.besides.empty()) add("--spool", data + "/spools/silk_red.json");
  if (help.find("--accept-calibration") != std::string::npos) arguments.emplace_back("--accept-calibration");
  return arguments;
}

struct Stopped {
  std::string what;
  bool turned = false;  // it was turning when it was stopped
  double way_deg = 0;   // from the signal on
  std::string problem;  // of what must hold afterwards
};

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

// What must hold behind a stop: the platform stands where the program says, and the next one finds its angle 0 or asks.
std::string problem_afterwards(const Lab& lab, Board board, Ending ending, double stood_deg) {
  if (is_here(board) && ending != Ending::kill) {
    const auto place = lab.remembered();
    const auto remembered = lab.remembered_deg();
    if (!remembered || std::abs(*remembered - stood_deg) > kSameDeg)
      return "it stands at " + std::to_string(stood_deg) + " deg and remembers " +
             (remembered    ? std::to_string(*remembered)
              : !place      ? "nothing"
              : place->lost ? "that it is lost"
                            : "that it turns from " + std::to_string(place->angle_rad / station::kDegree));
  }
  lab.set_pace(kQuickest);
  const ProgramResult home = run_shell("XDG_STATE_HOME='" + lab.in("state").string() + "' " + THREADSTATION_PROGRAM +
                                       " home --rig '" + lab.rig_file().string() + "' < /dev/null");
  const bool done = home.status == 0;
  // A switch is found from one side, perhaps a turn further on.
  const double angle_deg = is_here(board) ? lab.angle_deg() : std::remainder(lab.angle_deg(), 360);
  const bool may_ask = is_here(board) && ending == Ending::kill;
  if (done && std::abs(angle_deg) > kSameDeg) return "its home is at " + std::to_string(angle_deg) + " deg";
  if (!done && !may_ask) return "it is not homed any more: " + home.error;
  if (!done && lab.angle_deg() != stood_deg) return "it asks where the platform stands and turns it";
  return "";
}

// Stops a command `delay_s` of the board's time after the platform began to turn for so many times.
Stopped stop(const Way& way, Board board, Ending ending, int times, double delay_s) {
  Stopped result{.what = way.name() + ", " + name_of(board) + ", " + name_of(ending) + ", motion " +
                         std::to_string(times) + ", after " + std::to_string(delay_s) + " s"};
  const Lab lab(board, times == 1 ? kLeftFarDeg : kLeftNearDeg);
  std::ofstream(lab.in("spools.csv")) << "barcode,spool\n1," << DATA_DIR << "/spools/silk_red.json\n2,\n";
  if (way.goes_on()) {
    const Way first{way.command};
    const pid_t process = lab.start(arguments_for(first, lab));
    turns(lab, 2, process);
    kill(process, SIGINT);
    ends(process);
    wait_for(process);
  }
  // When it opens the turntable once more, somebody has turned it meanwhile.
  if (way.opening > 1) lab.turn_by_hand_before_opening(way.opening, kLeftFarDeg);
  const pid_t process = lab.start(arguments_for(way, lab));
  while (lab.openings() < way.opening && !has_ended(process)) std::this_thread::sleep_for(1ms);
  if (!turns(lab, times, process)) {
    kill(process, SIGKILL);
    wait_for(process);
    if (times > 1) return stop(way, board, ending, times - 1, delay_s);
    result.problem = "it never turned";
    return result;
  }
  for (const double from_s = lab.board_time_s(); lab.board_time_s() - from_s < delay_s && !has_ended(process);)
    std::this_thread::sleep_for(1ms);
  lab.set_pace(kSlow);
  const double before_deg = lab.angle_deg();
  std::this_thread::sleep_for(20ms);
  const double told_deg = lab.angle_deg();
  result.turned = told_deg != before_deg;
  const int heard = lab.stops_heard();
  end(process, ending);
  const double late_deg = std::abs(lab.angle_deg() - told_deg);  // this thread was held up
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (lab.stops_heard() == heard && !has_ended(process) && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(1ms);
  lab.set_pace(kBraking);
  if (ending != Ending::kill && !ends(process)) result.problem = "the program goes on";
  wait_for(process);
  lab.set_pace(kQuick);
  const double stood_deg = wait_until_it_stands(lab);
  result.way_deg = std::abs(stood_deg - told_deg);
  // A controller that looks for its switch when its program is killed finds it, and stands there.
  const bool found_home = ending == Ending::kill && !is_here(board) && std::abs(std::remainder(stood_deg, 360)) < 0.1;
  if (found_home) result.way_deg = 0;
  const double most_deg = ending == Ending::kill ? kMostWayOfKilledDeg : kMostWayDeg;
  if (result.way_deg > most_deg + late_deg)
    result.problem = "it went on for " + std::to_string(result.way_deg) + " deg";
  if (result.problem.empty()) result.problem = problem_afterwards(lab, board, ending, stood_deg);
  if (!result.problem.empty()) result.problem += "; its last words: " + lab.last_error();
  return result;
}

struct Case {
  Way way;
  Board board;
  Ending ending;
};

// Every command that the program lists on every board with every ending; and the further ways of capture, and check's
// turn to its test picture, with each of them at least once. (Without a switch that one turns nothing.)
std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (int ending = 0; ending < kEndings; ++ending) {
    for (int board = 0; board < kBoards; ++board)
      for (const std::string& command : turning_commands())
        if (command != "preview")  // it opens a turntable and never turns it
          cases.push_back({{command}, static_cast<Board>(board), static_cast<Ending>(ending)});
    const auto board = static_cast<Board>(ending % kBoards);
    for (const auto& besides : {std::vector<std::string>{"--queue", "spools.csv"}, {"--resume"}, {"--reshoot", "1"}})
      cases.push_back({{"capture", besides}, board, static_cast<Ending>(ending)});
    constexpr std::array kWithSwitch{Board::grbl_with_switch, Board::documented_with_switch, Board::zaber};
    const Board found = kWithSwitch.at(static_cast<std::size_t>(ending) % kWithSwitch.size());
    cases.push_back({{.command = "check", .opening = 2}, found, static_cast<Ending>(ending)});
  }
  return cases;
}

int wanted_stops(int all) {
  const char* asked = std::getenv("THREADSTATION_STOPS");
  return asked == nullptr ? all : std::atoi(asked);
}

}  // namespace

TEST(StopEveryCommand, TheProgramListsThoseThatTurnThePlatform) {
  EXPECT_THAT(turning_commands(), testing::IsSupersetOf({"calibrate", "capture", "check", "home", "preview"}));
}

// Whoever presses Escape in a browser posts this.
TEST(StopEveryCommand, ThePagesEmergencyStopEndsACheckThatTurns) {
  for (const Board board : {Board::grbl_with_switch, Board::documented_with_switch, Board::zaber}) {
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
    const auto patience = std::chrono::steady_clock::now() + kPatience;
    while (lab.angle_deg() == kLeftFarDeg && std::chrono::steady_clock::now() < patience)
      std::this_thread::sleep_for(2ms);
    lab.set_pace(kSlow);
    std::this_thread::sleep_for(1s);
    const double told_deg = lab.angle_deg();
    ASSERT_NE(told_deg, kLeftFarDeg) << "it never turned";
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

// The interview of a new rig, which turns the platform to look at it, by every ending.
TEST(StopEveryCommand, TheInterviewOfANewRigIsStoppedInItsMotions) {
  for (int ending = 0; ending < kEndings; ++ending) {
    const Stopped result =
        stop({"rig new"}, static_cast<Board>(ending % kBoards), static_cast<Ending>(ending), 2, 0.2 * ending);
    EXPECT_EQ(result.problem, "") << result.what;
  }
}

TEST(StopEveryCommand, AtRandomMomentsNeverGoesOnForMoreThanFiveDegreesNorLosesThePosition) {
  constexpr unsigned kSeed = 20261123;
  const std::vector<Case> cases = all_cases();
  const int stops = wanted_stops(static_cast<int>(cases.size()));
  std::cout << stops << " stops, seed " << kSeed << "\n";
  std::mutex drawing;
  std::mt19937 random(kSeed);
  int drawn = 0;
  std::vector<Stopped> results;
  const auto lane = [&] {
    for (;;) {
      std::unique_lock hold(drawing);
      if (drawn == stops) return;
      const auto& [way, board, ending] = cases[static_cast<std::size_t>(drawn++) % cases.size()];
      const int times = way.opening > 1 ? 1 : std::uniform_int_distribution(1, kMotions)(random);
      const double delay_s = std::uniform_real_distribution(0.0, 1.5)(random);
      hold.unlock();
      Stopped result = stop(way, board, ending, times, delay_s);
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
