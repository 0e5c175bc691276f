// The example that each command's --help gives, run as a person would type it, in the order of --help and in one
// folder, so that it takes what those before it made. What a person has there beforehand is put there: small pictures
// of a coarse bench, a calibration that was interrupted near its end, and the recorded session in place of one that
// would take minutes to draw.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <set>

#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/commands/help.h"
#include "tests/station/commands/program.h"
#include "tests/station/commands/workflow.h"
#include "tests/station/session/hasty_bench.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path kData = DATA_DIR, kRecorded = fs::path(FIXTURES_DIR) / "sessions/silk_red";

json rig(int samples, int target_samples) {
  json document = station::read_json_file(kData / "rigs/simulated.json");
  document["simulation"]["samples_per_pixel"] = samples;
  document["simulation"]["target_samples_per_pixel"] = target_samples;
  return document;
}

class Examples : public testing::Test {
 protected:
  // Runs a line in the folder where all are run; `threadstation` is the program that was built.
  ProgramResult run(const std::string& line) {
    return run_shell("cd '" + folder_.path().string() + "' || exit; export PATH='" +
                     fs::path(THREADSTATION_PROGRAM).parent_path().string() + "':\"$PATH\"; " + line);
  }
  void write(const std::string& name, const json& document) {
    fs::create_directories((folder_ / name).parent_path());
    station::write_json_file(folder_ / name, document);
  }
  void copy(const fs::path& from, const std::string& name) {
    fs::remove_all(folder_ / name);
    fs::copy(from, folder_ / name, fs::copy_options::recursive);
  }
  // What ctest has made for Workflow's suites; without it the example takes all pictures itself.
  void interrupted_calibration() {
    write("rig.json", rig(1, 4));
    const char* made = std::getenv(kCalibratedBench);
    if (made == nullptr) return;
    copy(fs::path(made) / "calibration", "calibration");
    fs::remove(folder_ / "calibration/calibration.json");
    json list = station::read_json_file(folder_ / "calibration/pictures.json");
    constexpr std::size_t kMissing = 5;
    list["pictures"].erase(list["pictures"].end() - kMissing, list["pictures"].end());
    write("calibration/pictures.json", list);
  }
  void photographs_of_a_chessboard() {
    fs::create_directories(folder_ / "photographs");
    for (const auto& picture : fs::directory_iterator("/usr/share/doc/opencv-doc/examples/data"))
      if (picture.path().filename().string().starts_with("left") && picture.path().stem() != "left")
        fs::copy(picture, folder_ / "photographs" / picture.path().filename());
  }
  void pictures_by_hand() {
    json list = station::read_json_file(fs::path(FIXTURES_DIR) / "imports/silk_red_by_hand.json");
    const fs::path beside = fs::path(FIXTURES_DIR) / "imports";
    for (const char* key : {"rig", "spool", "calibration"}) list[key] = beside / list[key].get<std::string>();
    for (json& picture : list["pictures"]) picture["file"] = beside / picture["file"].get<std::string>();
    write("pictures.json", list);
  }
  void session_of_a_cloth() {
    run("threadstation capture --rig rig.json --calibration calibration --spool '" +
        (kData / "fabrics/satin_blue_gold.json").string() +
        "' --out cloth_session --unattended --accept-calibration --quiet && threadstation develop cloth_session "
        "--quiet");
  }
  void directions() {
    std::ofstream(folder_ / "directions.csv")
        << "h,theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad\n0.2,0.1,0.3,-0.1,2\n-0.5,0,1,0.4,0.2\n";
  }
  void coarse_bench() {
    write("rig.json", hasty_rig(rig(1, 1)));
    fs::remove_all(folder_ / "calibration");
    write("calibration/calibration.json",
          hasty_calibration(station::read_json_file(kData / "calibrations/simulated.json")));
  }

  // What is there before an example is run.
  const std::map<std::string, std::function<void()>> before_{
      {"calibrate", [this] { interrupted_calibration(); }},
      {"calibrate camera", [this] { photographs_of_a_chessboard(); }},
      {"capture", [this] { coarse_bench(); }},
      {"import", [this] { pictures_by_hand(); }},
      {"replay", [this] { copy(kRecorded, "session"); }},
      {"predict", [this] { session_of_a_cloth(); }},
      {"compare", [this] { fs::copy_file(folder_ / "swatch.exr", folder_ / "photograph.exr"); }},
      {"scatter eval", [this] { directions(); }},
      {"validate", [this] { write("rig.json", hasty_rig(rig(1, 1))); }},
      {"validate-cloth", [this] { write("rig.json", hasty_rig(rig(1, 1))); }},
  };
  const TemporaryFolder folder_;
};

// Those that go on until ctrl-C, by what they print when they are ready.
const std::map<std::string, std::string> kUntilInterrupted{{"simulate-hardware", "Ctrl-C ends"}, {"serve", "http://"}};
// installation_test.cpp and reproduced_figures_test.cpp run them.
const std::set<std::string> kRunElsewhere{"demo", "reproduce"};

TEST_F(Examples, OfHelpAllRunInTheOrderOfTheWork) {
  int run_of_them = 0;
  for (const Words& command : every_command()) {
    const std::string name = joined(command), example = example_of(command);
    if (example.empty() || kRunElsewhere.contains(name)) continue;
    SCOPED_TRACE(example);
    if (const auto needs = before_.find(name); needs != before_.end()) needs->second();
    const auto begun = std::chrono::steady_clock::now();
    const auto endless = kUntilInterrupted.find(name);
    const ProgramResult result = endless == kUntilInterrupted.end()
                                     ? run(example)
                                     : run(example + " >ready & until grep -q '" + endless->second +
                                           "' ready; do kill -0 $! || break; sleep 0.1; done; kill -INT $!; wait $!");
    EXPECT_EQ(result.status, 0) << result.error;
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
    std::printf("%6.1f s  %s\n", took.count(), name.c_str()), std::fflush(stdout);
    ++run_of_them;
  }
  EXPECT_GT(run_of_them, 35);
}

}  // namespace
}  // namespace station_test
