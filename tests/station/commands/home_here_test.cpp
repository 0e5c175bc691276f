// A platform without a home switch from one program to the next: it is left at 0, found where it was left, and taken to
// stand at its mark when somebody says so.
#include <gtest/gtest.h>

#include <cmath>

#include "station/serve/technician_page.h"
#include "tests/station/commands/lab.h"

namespace station_test {
namespace {

using nlohmann::json;

struct HomeHere : testing::TestWithParam<Board> {
  HomeHere() {
    json calibration = station::read_json_file(std::string(DATA_DIR) + "/calibrations/simulated.json");
    calibration["utc"] = rig::SystemClock().utc();  // it must not be too old
    calibration.erase("sensor");                    // of a bench that grows dark
    station::write_json_file(lab.in("calibration.json"), calibration);
  }
  std::vector<std::string> capture() const {
    const std::string spool = std::string(DATA_DIR) + "/spools/silk_red.json";
    return {"capture", "--rig", lab.rig_file(), "--calibration", lab.in("calibration.json"),
            "--spool", spool,   "--out",        lab.in("out"),   "--accept-calibration"};
  }
  std::vector<std::string> resume() const { return {"capture", "--resume", "--out", lab.in("out")}; }
  static void interrupt_twice(pid_t process) {
    kill(process, SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));  // two at once may count as one
    kill(process, SIGINT);
    ASSERT_TRUE(ends(process));
    wait_for(process);
  }
  void expect_at_zero() const {
    EXPECT_NEAR(lab.angle_deg(), 0, 0.03);
    EXPECT_NEAR(lab.remembered_deg().value_or(999), 0, 0.03);
  }
  std::vector<json> events(const std::string& name) const {
    std::vector<json> found;
    std::ifstream journal(lab.in("out") / "journal.jsonl");
    for (std::string line; std::getline(journal, line);)
      if (const json record = json::parse(line, nullptr, false); record.is_object() && record["event"] == name)
        found.push_back(record["data"]);
    return found;
  }
  Lab lab{GetParam(), kLeftNearDeg};
};

INSTANTIATE_TEST_SUITE_P(OnBoth, HomeHere, testing::Values(Board::grbl_here, Board::documented_here),
                         [](const auto& board) { return is_documented(board.param) ? "DocumentedGrbl" : "Grbl"; });

TEST_P(HomeHere, ACaptureThatWasPausedElsewhereGoesOnFromThereAndEndsAtZero) {
  const pid_t first = lab.start(capture());
  ASSERT_TRUE(turns(lab, 3, first));
  while (std::abs(lab.angle_deg()) < 10 && !has_ended(first)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  kill(first, SIGINT);
  ASSERT_TRUE(ends(first));
  EXPECT_NE(wait_for(first), 0);
  EXPECT_GT(std::abs(lab.angle_deg()), 5);
  EXPECT_NEAR(lab.remembered_deg().value_or(999), lab.angle_deg(), 0.03);
  EXPECT_EQ(lab.run(resume()), 0);
  expect_at_zero();
  EXPECT_TRUE(events("discarded").empty());
  EXPECT_EQ(events("stop").back().at("outcome"), "complete") << events("stop").back();
}

TEST_P(HomeHere, AStopOnTheWayBackToZeroLeavesTheSessionComplete) {
  const pid_t process = lab.start(capture());
  const auto complete = [&] {
    const auto stops = events("stop");
    return !stops.empty() && stops.back().at("outcome") == "complete";
  };
  while (!complete() && !has_ended(process)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  lab.set_pace(kSlow);
  ASSERT_TRUE(turns(lab, 1, process)) << "it came back before it was stopped";
  interrupt_twice(process);
  EXPECT_TRUE(complete());
  EXPECT_EQ(events("stop").size(), 1U);
  EXPECT_GT(std::abs(lab.angle_deg()), 1);
  EXPECT_NEAR(lab.remembered_deg().value_or(999), lab.angle_deg(), 0.03);
  lab.set_pace(kQuickest);
  EXPECT_EQ(lab.run({"home", "--rig", lab.rig_file()}), 0);
  expect_at_zero();
}

// The board takes a second and a half to stand.
TEST_P(HomeHere, AStopAtOnceWaitsUntilThePlatformStands) {
  const pid_t process = lab.start(capture());
  ASSERT_TRUE(turns(lab, 3, process));
  const double from_deg = lab.angle_deg();
  while (std::abs(lab.angle_deg() - from_deg) < 8 && !has_ended(process))
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  lab.set_pace(kSlow);
  interrupt_twice(process);
  EXPECT_EQ(events("stop").back().at("outcome"), "aborted");
  EXPECT_NEAR(lab.remembered_deg().value_or(999), lab.angle_deg(), 0.03);
}

TEST_P(HomeHere, SomebodyWhoSaysThatItStandsAtItsMarkIsBelieved) {
  EXPECT_EQ(lab.run({"home", "--rig", lab.rig_file(), "--mark"}), 0);
  EXPECT_NEAR(lab.angle_deg(), kLeftNearDeg, 0.03) << "it is not turned";
  EXPECT_NEAR(lab.remembered_deg().value_or(999), 0, 0.03);
}

TEST_P(HomeHere, ThePageTurnsItBack) {
  ::setenv("XDG_STATE_HOME", lab.in("state").c_str(), 1);
  station::TechnicianPage page(
      lab.rig_file(), lab.in("workspace"), [] {}, THREADSTATION_PROGRAM);
  const auto post = [&](const std::string& path, const json& fields) {
    return page.handle({.method = "POST", .path = path, .body = fields.dump()}).status;
  };
  ASSERT_EQ(post("/api/control", {{"client", "me"}}), 200);
  ASSERT_EQ(post("/api/job", {{"client", "me"}, {"kind", "home"}}), 200);
  const auto state = [&] { return json::parse(page.handle({.method = "GET", .path = "/api/state"}).body).at("job"); };
  while (state().at("running") == true) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(state().at("status"), 0) << state().dump(1);
  expect_at_zero();
}

}  // namespace
}  // namespace station_test
