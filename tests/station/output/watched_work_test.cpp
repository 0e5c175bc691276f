#include "station/output/watched_work.h"

#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <sstream>

#include "station/documents/draft_file.h"
#include "station/output/interrupt.h"
#include "tests/places.h"

namespace station {
namespace {

// A display whose clock goes on by a second whenever it is asked, and what it said.
class Watched {
 public:
  Watched() { testing::internal::CaptureStderr(); }
  ProgressDisplay& progress() { return progress_; }
  std::vector<nlohmann::json> said() {
    std::istringstream lines(testing::internal::GetCapturedStderr());
    std::vector<nlohmann::json> all;
    for (std::string line; std::getline(lines, line);) all.push_back(nlohmann::json::parse(line));
    return all;
  }

 private:
  std::chrono::steady_clock::time_point now_{};
  ProgressDisplay progress_{"work", ProgressStyle::json_lines, [this] { return now_ += std::chrono::seconds(1); }};
};

renderer::Draft plain() {
  return read_draft(std::string(DATA_DIR) + "/drafts/plain.json");
}

constexpr renderer::SkirtShape kSkirt;

TEST(WatchedWork, WeavingShowsItsStepsAndGivesThePatch) {
  watch_interrupts();
  Watched watched;
  const renderer::YarnPatch patch = weave_watched(plain(), watched.progress()).patch;
  const auto said = watched.said();
  ASSERT_GT(said.size(), 2u);
  EXPECT_EQ(said.back().at("total"), 0) << "nobody knows how many steps it takes";
  EXPECT_NE(said.back().at("label").get<std::string>().find("come to rest: step "), std::string::npos) << said.back();
  EXPECT_EQ(patch.yarns.front().control_points, renderer::woven_patch(plain()).patch.yarns.front().control_points);
}

TEST(WatchedWork, DrapingShowsItsPartAndGivesTheMesh) {
  watch_interrupts();
  Watched watched;
  const renderer::UvMesh mesh = garment_watched(kSkirt, watched.progress());
  const auto said = watched.said();
  ASSERT_GT(said.size(), 10u);
  EXPECT_GT(said.back().at("done"), 80);
  EXPECT_EQ(said.back().at("total"), 100);
  EXPECT_EQ(mesh.vertices, renderer::garment_mesh(kSkirt).vertices);
}

TEST(WatchedWork, CtrlCEndsIt) {
  watch_interrupts();
  std::raise(SIGINT);
  ProgressDisplay quiet("work", ProgressStyle::quiet);
  EXPECT_THROW(weave_watched(plain(), quiet), std::runtime_error);
  EXPECT_THROW(garment_watched(kSkirt, quiet), std::runtime_error);
  EXPECT_THROW(garment_watched(renderer::DrapeShape{}, quiet), std::runtime_error);
  watch_interrupts();
}

}  // namespace
}  // namespace station
