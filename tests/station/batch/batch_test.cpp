// Batches on this computer, as a person starts them.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include "station/batch/batch_state.h"
#include "station/batch/slurm.h"
#include "station/documents/batch_file.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/batch/small_sessions.h"
#include "tests/station/commands/own_figures.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const json kFit{{"do", "invert"}, {"options", {"--paths", "16", "--spp", "1"}}, {"memory_gib", 0.3}};
const json kTables{{"do", "export"}, {"options", {"--only", "csv"}}, {"memory_gib", 0.3}};

// Whether any two tasks of the step ran at the same time.
bool any_together(const fs::path& folder, const std::string& step, int items) {
  const auto seconds = [](const std::string& utc) {
    return 3600 * std::stod(utc.substr(11, 2)) + 60 * std::stod(utc.substr(14, 2)) + std::stod(utc.substr(17));
  };
  std::vector<std::pair<double, double>> runs;  // end, seconds
  for (int i = 0; i < items; ++i) {
    const json record = record_in(folder, step, "s0" + std::to_string(i));
    runs.emplace_back(seconds(record.at("ended_utc")), record.at("seconds"));
  }
  std::ranges::sort(runs);
  for (std::size_t i = 1; i < runs.size(); ++i)
    if (runs[i].first - runs[i].second < runs[i - 1].first - 0.1) return true;
  return false;
}

class BatchTest : public ::testing::Test {
 protected:
  ProgramResult batch(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"batch", folder_ / "plan.json", "--out", folder_ / "batch", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_threadstation(words);
  }
  // How many tasks of the step are in this state.
  static int count(const ProgramResult& result, const std::string& step, const std::string& state) {
    const json description = json::parse(result.out);
    for (const json& one : description.at("steps"))
      if (one.at("step") == step) return one.at(state);
    return -1;
  }
  std::string ended(const std::string& step, const std::string& item) {
    return record_in(folder_.path(), step, item).at("ended_utc");
  }
  TemporaryFolder folder_;
};

// One of several computers makes a figure of the paper.
TEST_F(BatchTest, EachFigureIsATask) {
  const OwnFigures figures;
  for (const std::string draft : {"plain", "twill_2_2"})
    figures.write(draft + ".json", {{"format", "threadstation/figure"},
                                    {"version", 1},
                                    {"figure", draft == "plain" ? "8" : "9"},
                                    {"title", draft},
                                    {"paper", "shows it"},
                                    {"different", "nothing"},
                                    {"steps", {{{"run", "weave --draft " + draft + " --out p.json --view p.png"}}}},
                                    {"pictures", {{{"pictures", {{{"file", "p.png"}, {"caption", draft}}}}}}}});
  json plan = station::read_json_file(DATA_DIR "/batches/figures.json");
  plan["figures"] = json::array({(figures.folder() / "*.json").string()});
  station::write_json_file(folder_ / "plan.json", plan);
  const ProgramResult made = batch();
  ASSERT_EQ(made.status, 0) << made.error;
  EXPECT_EQ(count(made, "reproduce", "done"), 2);
  const fs::path of_twill = folder_.path() / "batch/results/reproduce/twill_2_2";
  EXPECT_TRUE(fs::exists(of_twill / "index.html"));
  EXPECT_TRUE(fs::exists(of_twill / "figure-9/p.json"));
  fs::remove(of_twill / "index.html");
  ASSERT_EQ(batch().status, 0);
  EXPECT_TRUE(fs::exists(of_twill / "index.html")) << "what is not as the record says is made again";

  station::write_json_file(figures.folder() / "thread.json", {{"diameter_mm", 1}});
  const ProgramResult refused = batch();
  EXPECT_EQ(refused.status, 1);
  EXPECT_NE(refused.error.find("thread.json' describes no figure"), std::string::npos) << refused.error;
}

TEST_F(BatchTest, DoesEveryStepOfEachSessionOnceAndThenOnlyWhatChanged) {
  make_sessions(folder_.path(), 3);
  written_plan(folder_.path(), {{{"do", "develop"}}, kFit, {{"do", "report"}}, kTables});
  const ProgramResult first = batch();
  ASSERT_EQ(first.status, 0) << first.error;
  for (const char* step : {"develop", "invert", "report", "export"}) EXPECT_EQ(count(first, step, "done"), 3) << step;
  const auto made = made_in(folder_.path());
  EXPECT_TRUE(made.contains("sessions/s01/result/thread.json"));
  EXPECT_TRUE(made.contains("batch/results/export/s02/manifest.json") || made.size() > 30) << made.size();
  const json record = record_in(folder_.path(), "invert", "s01");
  EXPECT_GT(record.at("peak_mib"), 5);
  EXPECT_GT(record.at("processor_s"), 0.01);

  std::map<std::string, std::string> times;
  const auto all_times = [&] {
    std::map<std::string, std::string> all;
    for (const char* step : {"develop", "invert", "report", "export"})
      for (const char* item : {"s00", "s01", "s02"}) all[std::string(step) + " " + item] = ended(step, item);
    return all;
  };
  times = all_times();
  ASSERT_EQ(batch().status, 0);
  EXPECT_EQ(all_times(), times) << "nothing was done again";

  // A result that somebody spoils is made again as it was; nothing else changes.
  std::ofstream(folder_ / "sessions/s01/result/thread.json", std::ios::app) << " ";
  ASSERT_EQ(batch().status, 0);
  EXPECT_NE(ended("invert", "s01"), times["invert s01"]);
  EXPECT_EQ(ended("export", "s01"), times["export s01"]) << "what it reads is what it was";
  EXPECT_EQ(ended("invert", "s02"), times["invert s02"]);
  EXPECT_EQ(made_in(folder_.path()), made);

  // Other options of one step.
  times = all_times();
  json mitsuba = kTables;
  mitsuba["options"] = {"--only", "csv,blender"};
  written_plan(folder_.path(), {{{"do", "develop"}}, kFit, {{"do", "report"}}, mitsuba});
  ASSERT_EQ(batch().status, 0);
  EXPECT_NE(ended("export", "s00"), times["export s00"]);
  EXPECT_EQ(ended("report", "s00"), times["report s00"]);

  // Another input: a session's mask.
  times = all_times();
  const fs::path mask = folder_ / "sessions/s02/masks/transmission-3.png";
  fs::copy_file(folder_ / "sessions/s02/masks/reflection-horizontal-2.png", mask, fs::copy_options::overwrite_existing);
  ASSERT_EQ(batch().status, 0);
  EXPECT_NE(ended("develop", "s02"), times["develop s02"]) << "its mask is not what it made";
  EXPECT_EQ(ended("invert", "s02"), times["invert s02"]) << "and then it is";
  EXPECT_EQ(ended("develop", "s01"), times["develop s01"]);
}

TEST_F(BatchTest, AFailureHoldsOnlyWhatNeedsItAndSaysWhy) {
  make_sessions(folder_.path(), 3);
  fs::rename(folder_ / "sessions/s01/calibration/calibration.json", folder_ / "kept.json");
  written_plan(folder_.path(), {{{"do", "develop"}}, kFit, kTables});
  const ProgramResult failed = batch();
  EXPECT_EQ(failed.status, 1);
  EXPECT_EQ(failed.error_lines(), 2) << "a note and the end: " << failed.error;
  EXPECT_NE(failed.error.find("3 of 9 tasks are not done"), std::string::npos) << failed.error;
  EXPECT_EQ(count(failed, "develop", "failed"), 1);
  EXPECT_EQ(count(failed, "invert", "held"), 1);
  EXPECT_EQ(count(failed, "export", "done"), 2);
  const json problem = json::parse(failed.out).at("problems").at(0);
  EXPECT_EQ(problem.at("task"), "develop of s01");
  EXPECT_NE(problem.at("why").get<std::string>().find("calibration.json: no such file"), std::string::npos);
  const ProgramResult status = run_threadstation({"batch", "status", folder_ / "batch", "--json"});
  EXPECT_EQ(json::parse(status.out), json::parse(failed.out)) << "as it stands in the folder";

  fs::rename(folder_ / "kept.json", folder_ / "sessions/s01/calibration/calibration.json");
  const std::string before = ended("export", "s00");
  const ProgramResult good = batch();
  EXPECT_EQ(good.status, 0) << good.error;
  EXPECT_EQ(count(good, "export", "done"), 3);
  EXPECT_EQ(ended("export", "s00"), before);
  const ProgramResult report = run_threadstation({"batch", "report", folder_ / "batch"});
  EXPECT_NE(report.out.find("develop"), std::string::npos) << report.out;
  EXPECT_TRUE(fs::exists(folder_ / "batch" / "report.html"));
}

// Ctrl-C, and the kernel's kill, after which the tasks themselves go on.
TEST_F(BatchTest, InterruptedItGoesOnAndEndsWithTheSameFiles) {
  const json fit{{"do", "invert"}, {"options", {"--paths", "64", "--spp", "1"}}, {"memory_gib", 0.3}};
  const TemporaryFolder whole;
  make_sessions(whole.path(), 5, true);
  written_plan(whole.path(), {fit, kTables});
  ASSERT_EQ(run_threadstation({"batch", whole / "plan.json", "--out", whole / "batch", "--quiet"}).status, 0);
  make_sessions(folder_.path(), 5, true);
  written_plan(folder_.path(), {fit, kTables});
  // Each as soon as the fit of a session has begun, the last while nothing else is left to begin.
  for (const auto& [signal, item] : {std::pair(SIGINT, "s00"), std::pair(SIGKILL, "s02"), std::pair(SIGTERM, "s04")}) {
    const fs::path task = folder_ / "batch/tasks/invert" / item;
    const pid_t process = start_threadstation({"batch", folder_ / "plan.json", "--out", folder_ / "batch"});
    for (int i = 0; i < 60000 && !fs::exists(task / "begun.json") && !fs::exists(task / "record.json"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    ::kill(process, signal);
    EXPECT_NE(wait_for(process), 0);
  }
  const ProgramResult end = batch();
  ASSERT_EQ(end.status, 0) << end.error;
  EXPECT_EQ(made_in(folder_.path()), made_in(whole.path()));
  int attempts = 0;
  for (int i = 0; i < 5; ++i)
    attempts += record_in(folder_.path(), "invert", "s0" + std::to_string(i)).at("attempts").get<int>();
  EXPECT_LE(attempts, 5 + 2 * 2) << "no more than were stopped: two at a time, twice";
}

// As the kernel does where memory ends: it was no failure of the command's own.
TEST_F(BatchTest, ACommandThatIsKilledIsToldOfAndTriedAgain) {
  make_sessions(folder_.path(), 1, true);
  json fit = kFit;
  fit["options"] = {"--paths", "1024", "--spp", "1"};
  written_plan(folder_.path(), json::array({fit}));
  const std::string invert = "pgrep -f 'inver[t] " + (folder_ / "sessions/s00").string() + "'";
  const pid_t process = start_threadstation({"batch", folder_ / "plan.json", "--out", folder_ / "batch"});
  for (int i = 0; i < 300 && run_shell(invert).status != 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  run_shell("kill -KILL $(" + invert + ")");
  EXPECT_EQ(wait_for(process), 1);
  const json status = json::parse(run_threadstation({"batch", "status", folder_ / "batch", "--json"}).out);
  EXPECT_EQ(status.at("steps")[0].at("died"), 1) << status.dump(1);
  EXPECT_NE(status.at("problems").at(0).at("why").get<std::string>().find("was killed by signal 9"), std::string::npos);
  EXPECT_TRUE(record_in(folder_.path(), "invert", "s00").is_null());
  written_plan(folder_.path(), json::array({kFit}));
  EXPECT_EQ(batch().status, 0);
}

TEST_F(BatchTest, ItemsAreCalledAsTheirSessions) {
  make_sessions(folder_.path(), 2, true);
  fs::rename(folder_ / "sessions/s00", folder_ / "sessions/lot.1");
  fs::rename(folder_ / "sessions/s01", folder_ / "sessions/lot.2");
  written_plan(folder_.path(), json::array({kFit}));
  ASSERT_EQ(batch().status, 0);
  EXPECT_FALSE(record_in(folder_.path(), "invert", "lot-2").is_null());
  const std::string threads =
      written_plan(folder_.path(), json::array({kTables}),
                   {{"sessions", json::array()}, {"threads", json::array({"sessions/*/result/thread.json"})}});
  const ProgramResult tables = run_threadstation({"batch", threads, "--out", folder_ / "tables", "--quiet"});
  ASSERT_EQ(tables.status, 0) << tables.error;
  EXPECT_TRUE(fs::exists(folder_ / "tables/results/export/lot-1/scattering.csv"));
}

// What a rendering has left that was stopped is not gone on with when it is another.
TEST_F(BatchTest, ARenderingWithOtherOptionsBeginsAnew) {
  const auto plan = [&](const std::string& samples) {
    station::write_json_file(folder_ / "plan.json",
                             {{"format", "threadstation/batch"},
                              {"version", 1},
                              {"scenes", json::array({std::string(DATA_DIR) + "/scenes/plain_swatch.json"})},
                              {"steps", json::array({{{"do", "render"}, {"options", {"--spp", samples}}}})}});
  };
  plan("4096");
  const pid_t process = start_threadstation({"batch", folder_ / "plan.json", "--out", folder_ / "batch"});
  const fs::path log = folder_ / "batch/tasks/render/plain_swatch/log.txt";
  for (int i = 0; i < 300 && (!fs::exists(log) || fs::file_size(log) < 20); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  ::kill(process, SIGINT);
  EXPECT_EQ(wait_for(process), 1);
  EXPECT_TRUE(fs::exists(folder_ / "batch/results/render/plain_swatch.exr.checkpoint"));
  plan("1");
  const ProgramResult result = batch();
  EXPECT_EQ(result.status, 0) << result.error << result.out;
  EXPECT_FALSE(fs::exists(folder_ / "batch/results/render/plain_swatch.exr.checkpoint"));
}

TEST_F(BatchTest, UsesNoMoreCoresThanItMay) {
  make_sessions(folder_.path(), 4, true);
  written_plan(folder_.path(), json::array({kFit}));
  ASSERT_EQ(batch({"--cores", "1"}).status, 0);
  EXPECT_FALSE(any_together(folder_.path(), "invert", 4)) << "one after the other";
  written_plan(folder_.path(), json::array({{{"do", "invert"}, {"cores", 64}}}));
  const ProgramResult many = batch({"--cores", "1"});
  EXPECT_EQ(many.status, 1);
  EXPECT_NE(many.error.find("is to have 64 cores, and there are 1"), std::string::npos) << many.error;
}

TEST_F(BatchTest, TakesNoMoreMemoryThanItMay) {
  make_sessions(folder_.path(), 4, true);
  json fit = kFit;
  fit["options"] = {"--paths", "256", "--spp", "1"};
  written_plan(folder_.path(), json::array({fit}));
  ASSERT_EQ(batch({"--memory-gib", "0.5"}).status, 0);  // one has 0.3 until it is measured, and much less then
  const json first = record_in(folder_.path(), "invert", "s00"), second = record_in(folder_.path(), "invert", "s01");
  EXPECT_LT(first.at("ended_utc").get<std::string>(), second.at("ended_utc").get<std::string>());
  fit["memory_gib"] = 0.3;
  fit["options"] = {"--paths", "255", "--spp", "1"};
  written_plan(folder_.path(), json::array({fit}));
  const double wanted = 1.3 * first.at("peak_mib").get<double>() + 100;
  ASSERT_EQ(batch({"--memory-gib", std::to_string(1.5 * wanted / 1024)}).status, 0);
  EXPECT_FALSE(any_together(folder_.path(), "invert", 4));
}

// What a task is expected to take: the plan's word, then what others took, and twice as much after each death.
TEST(BatchNeeds, FollowWhatTasksTookAndDoubleWithEachDeath) {
  const station::BatchStep step{.name = "fit", .command = "invert", .cores = 2, .memory_gib = 1, .minutes = 30};
  const station::BatchItem item{.name = "a"};
  std::vector<station::TaskStatus> states(2);
  for (station::TaskStatus& status : states) status.task = {&step, &item};
  const station::TaskNeeds first = station::expected_needs(states, step);
  EXPECT_EQ(first.cores, 2);
  EXPECT_EQ(first.memory_mib, 1024);
  EXPECT_EQ(first.minutes, 30);
  states[1].record = station::TaskRecord{.done = true, .seconds = 120, .peak_mib = 200};
  const station::TaskNeeds later = station::expected_needs(states, step), again = station::after_deaths(later, 2);
  EXPECT_EQ(later.memory_mib, 1.3 * 200 + 100);
  EXPECT_EQ(later.minutes, 2 + 3 * 2);
  EXPECT_EQ(again.memory_mib, 4 * later.memory_mib);
  EXPECT_EQ(again.minutes, 4 * later.minutes);
  EXPECT_EQ(station::after_deaths(later, 9).minutes, 8 * later.minutes);
  states[1].record->done = false;
  EXPECT_EQ(station::expected_needs(states, step).memory_mib, 1024) << "a failure tells nothing";
}

TEST_F(BatchTest, ValidatesSpools) {
  station::write_json_file(folder_ / "plan.json",
                           {{"format", "threadstation/batch"},
                            {"version", 1},
                            {"spools", json::array({std::string(DATA_DIR) + "/spools/packed_silk_red_20.json"})},
                            {"steps", json::array({{{"do", "validate"},
                                                    {"options",
                                                     {"--rig", std::string(DATA_DIR) + "/rigs/simulated.json",
                                                      "--folds", "0", "--model", "fiber", "--spp", "1"}}}})}});
  const ProgramResult result = batch();
  ASSERT_EQ(result.status, 0) << result.error << result.out;
  EXPECT_TRUE(fs::exists(folder_ / "batch/results/validate/packed_silk_red_20/validation.json"));
}

TEST_F(BatchTest, RendersScenesAndWeavesThreadFiles) {
  const std::string data = DATA_DIR;
  json plan{
      {"format", "threadstation/batch"},
      {"version", 1},
      {"threads", {data + "/threads/silk_red.json"}},
      {"scenes", {data + "/scenes/plain_swatch.json"}},
      {"steps",
       {{{"do", "cloth"}, {"name", "twill"}, {"options", {"--draft", "twill_2_2", "--quick", "--shape", "swatch"}}},
        {{"do", "render"}, {"options", {"--spp", "1", "--png"}}}}}};
  station::write_json_file(folder_ / "plan.json", plan);
  const ProgramResult result = batch();
  ASSERT_EQ(result.status, 0) << result.error;
  EXPECT_TRUE(fs::exists(folder_ / "batch/results/twill/silk_red/swatch.exr"));
  EXPECT_TRUE(fs::exists(folder_ / "batch/results/render/plain_swatch.png"));
  const std::string before = ended("render", "plain_swatch");
  ASSERT_EQ(batch().status, 0);
  EXPECT_EQ(ended("render", "plain_swatch"), before);
}

TEST_F(BatchTest, BadPlansGetOneLine) {
  make_sessions(folder_.path(), 1);
  const auto refused = [&](const json& steps, const json& more, const std::string& must_name) {
    written_plan(folder_.path(), steps, more);
    const ProgramResult result = batch();
    EXPECT_EQ(result.status, 1) << result.out;
    EXPECT_EQ(result.error_lines(), 1) << result.error;
    EXPECT_NE(result.error.find(must_name), std::string::npos) << result.error;
    EXPECT_FALSE(fs::exists(folder_ / "batch"));
  };
  const json none = json::object();
  refused(json::array({{{"do", "wash"}}}), none, "\"steps[0].do\"");
  refused({kFit, kFit}, none, "two steps are called \"invert\"");
  refused(json::array({{{"do", "invert"}, {"options", {"--out", "x"}}}}), none, "which the batch gives itself");
  refused(json::array({{{"do", "invert"}, {"needs", json::array({"develop"})}}}), none, "which is no earlier step");
  refused(json::array({{{"do", "report"}, {"model", "fiber"}}}), none, "report takes no fiber here");
  refused(json::array({{{"do", "render"}}}), none, "has nothing that it could be done with");
  refused(json::array(), none, "give at least one");
  refused(json::array({kFit}), {{"sessions", json::array({"elsewhere/*"})}}, "nothing is found for \"elsewhere/*\"");
  refused(json::array({kFit}), {{"sessions", json::array({"sessions"})}}, "is no session's folder");
  refused(json::array({kFit}), {{"sessions", json::array()}}, "found nothing to work on");
  refused(json::array({kFit}), {{"speed", 3}}, "\"speed\"");
  EXPECT_EQ(run_threadstation({"batch", "status", folder_.path()}).status, 1);
  EXPECT_EQ(run_threadstation({"batch"}).status, 1);
  fs::create_directory(folder_ / "other");
  std::ofstream(folder_ / "other/file") << "x";
  written_plan(folder_.path(), json::array({kFit}));
  const ProgramResult other = run_threadstation({"batch", folder_ / "plan.json", "--out", folder_ / "other"});
  EXPECT_NE(other.error.find("holds other things than a batch"), std::string::npos) << other.error;
}

TEST(BatchFile, ReadyPlansAreRead) {
  for (const auto& entry : fs::directory_iterator(fs::path(DATA_DIR) / "batches"))
    if (entry.path().extension() == ".json") EXPECT_NO_THROW(station::read_batch(entry.path())) << entry.path();
  const station::BatchFile plan = station::read_batch(fs::path(DATA_DIR) / "batches" / "sessions.json");
  ASSERT_TRUE(plan.step("twill"));
  EXPECT_EQ(plan.step("twill")->needs, std::vector<std::string>{"invert"});
  EXPECT_EQ(plan.step("invert")->needs, std::vector<std::string>{"develop"});
}

// The batch of an earlier day is done as it was meant.
TEST_F(BatchTest, APlanOfAnEarlierDayIsDone) {
  fs::copy(fs::path(FIXTURES_DIR) / "formats" / "2026-11", folder_ / "month", fs::copy_options::recursive);
  const ProgramResult result =
      run_threadstation({"batch", folder_ / "month/batch.json", "--out", folder_ / "batch", "--json"});
  ASSERT_EQ(result.status, 0) << result.error;
  EXPECT_EQ(count(result, "export", "done"), 2) << "of the session and of the thread file";
  EXPECT_EQ(count(result, "render", "done"), 1);
}

TEST(SlurmWords, NumbersBecomeRanges) {
  EXPECT_EQ(station::ranges_text({3, 0, 1, 2, 7, 9, 10}), "0-3,7,9-10");
  EXPECT_EQ(station::ranges_text({5}), "5");
}

}  // namespace
}  // namespace station_test
