// The technician's page and who may have it do what: one browser in control, names that stay in the workspace, and a
// run that does not depend on the network.
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <future>
#include <string>
#include <vector>

#include "tests/station/serve/technician_page_fixture.h"

namespace station_test {
namespace {

using namespace std::chrono_literals;

TEST_F(TechnicianPage, OneBrowserIsInControlAndAnotherMayTakeOver) {
  const json start{{"client", "me"}, {"kind", "report"}, {"name", "none"}};
  EXPECT_EQ(post("/api/job", start).status, 409);
  EXPECT_EQ(post("/api/control", {{"client", "me"}}).status, 200);
  EXPECT_EQ(post("/api/job", start).status, 404);  // there is no such session
  EXPECT_EQ(post("/api/control", {{"client", "you"}}).status, 409);
  EXPECT_EQ(post("/api/control", {{"client", "you"}, {"take", true}}).status, 200);
  EXPECT_EQ(post("/api/job", start).status, 409);
  EXPECT_EQ(get("/api/state").at("control"), "you");
  EXPECT_GE(changes_, 2);
}

TEST_F(TechnicianPage, NamesThatLeaveTheWorkspaceAreRefused) {
  post("/api/control", {{"client", "me"}});
  for (const char* name : {"../x", "/etc", "", "a/b", "-x", ".hidden", "CON"}) {
    EXPECT_EQ(post("/api/job", {{"client", "me"}, {"kind", "develop"}, {"name", name}}).status, 400) << name;
    HttpRequest request{.method = "GET", .path = "/report", .query = {{"name", name}}};
    EXPECT_EQ(page_->handle(request).status, 400) << name;
  }
  EXPECT_EQ(post("/api/job", {{"client", "me"}, {"kind", "rm"}, {"name", "x"}}).status, 400);
  EXPECT_EQ(post("/api/job", json::array()).status, 400);
  EXPECT_EQ(answer({{"id", 1}}, "done").status, 409);  // nothing is running
}

TEST_F(TechnicianPage, AQuestionIsShownAndItsAnswerReachesTheRun) {
  start_calibration();
  const json question = job().at("question");
  EXPECT_FALSE(question.at("text").get<std::string>().empty());
  EXPECT_EQ(question.at("choices").size(), 2U);
  EXPECT_EQ(question.at("step"), 1);
  EXPECT_GT(question.at("of"), 10);
  EXPECT_TRUE(question.at("arrangement").contains("lamp")) << question.dump(1);
  EXPECT_EQ(job().at("lines"), json{question.at("text")});
  EXPECT_EQ(post("/api/job", {{"client", "me"}, {"kind", "calibrate"}, {"name", "two"}}).status, 409);
  EXPECT_EQ(answer(question, "decline").status, 200);
  ASSERT_TRUE(eventually([&] { return job().at("running") == false; }));
  EXPECT_EQ(job().at("status"), 1);
  EXPECT_NE(job().at("lines").dump().find("the person declined"), std::string::npos) << job().dump(1);
}

TEST_F(TechnicianPage, ASecondClickDoesNotAnswerTheNextQuestion) {
  start_calibration();
  const json first = job().at("question");
  EXPECT_EQ(answer(first, "perhaps").status, 409) << "no choice of this question";
  EXPECT_EQ(answer(first, "done").status, 200);
  EXPECT_EQ(answer(first, "done").status, 409);
  ASSERT_TRUE(eventually([&] { return !job().at("question").is_null(); })) << job().dump(1);
  const json second = job().at("question");
  EXPECT_NE(second.at("id"), first.at("id"));
  EXPECT_EQ(answer(first, "done").status, 409);
  EXPECT_EQ(refused_with("/api/answer", {{"client", "me"}, {"answer", "done"}}), 400);
  EXPECT_EQ(refused_with("/api/answer", {{"client", "me"}, {"answer", true}, {"question", second.at("id")}}), 400);
  EXPECT_EQ(job().at("question"), second);
}

TEST_F(TurnedByHand, IsCheckedFromThePage) {
  const std::vector<std::string> asked = attend({{"client", "me"}, {"kind", "check"}});
  ASSERT_GE(asked.size(), 10U);
  EXPECT_NE(asked[1].find("Turn the platform to 30.0 deg"), std::string::npos) << asked[1];
  EXPECT_EQ(get("/api/bench").at("devices")[0].at("passed"), true);
}

TEST_F(TurnedByHand, AnAngleThatIsTypedIsReadAndAWrongOneAskedForAgain) {
  ASSERT_EQ(post("/api/job", {{"client", "me"}, {"kind", "check"}}).status, 200);
  const auto asked_to = [&](const std::string& text) {
    return eventually([&] {
      const json question = job().at("question");
      return !question.is_null() && question.at("text").get<std::string>().find(text) != std::string::npos;
    });
  };
  ASSERT_TRUE(asked_to("its mark is in front"));
  EXPECT_EQ(answer(job().at("question"), "0.2").status, 200);
  ASSERT_TRUE(asked_to("to 30.0 deg"));
  const json first = job().at("question");
  EXPECT_TRUE(first.contains("typed") && !first.contains("remark")) << first.dump(1);
  EXPECT_EQ(answer(first, "20").status, 200);
  ASSERT_TRUE(eventually([&] { return !job().at("question").is_null(); }));
  EXPECT_EQ(job().at("question").at("remark"), "That is not 30.0 deg; turn it on.");
  EXPECT_EQ(job().at("question").at("text"), first.at("text"));
}

TEST_F(TechnicianPage, TheEmergencyStopIsAnybodysAndEndsTheRun) {
  start_calibration();
  EXPECT_EQ(post("/api/stop", {{"client", "a watcher"}}).status, 200);
  ASSERT_TRUE(eventually([&] { return job().at("running") == false; }));
  EXPECT_NE(job().at("status"), 0);
}

TEST_F(TechnicianPage, WhoeverIsNotInControlChangesNothing) {
  post("/api/control", {{"client", "me"}});
  const json spool{{"client", "you"}, {"name", "silk"}, {"turns", 50}, {"diameter_mm", 0.5}};
  EXPECT_EQ(refused_with("/api/spool", spool), 409);
  for (const char* kind : {"check", "preview", "calibrate", "queue", "cloth", "add", "export"})
    EXPECT_EQ(refused_with("/api/job", {{"client", "you"}, {"kind", kind}, {"name", "x"}}), 409) << kind;
  EXPECT_EQ(refused_with("/api/pause", {{"client", "you"}}), 409);
  EXPECT_TRUE(get("/api/state").at("spools").empty());
  EXPECT_TRUE(get("/api/state").at("job").is_null());
}

TEST_F(TechnicianPage, ASpoolGetsTheHolderOfTheRigAndNoneWithoutOne) {
  post("/api/control", {{"client", "me"}});
  const json spool{{"client", "me"}, {"name", "silk"}, {"turns", 40}, {"diameter_mm", 0.5}};
  json rig = station::read_json_file(folder_ / "rig.json");
  rig["holder"] = {{"frame_width_mm", 90},
                   {"frame_height_mm", 80},
                   {"frame_depth_mm", 4},
                   {"window_width_mm", 50},
                   {"window_height_mm", 15}};
  station::write_json_file(folder_ / "rig.json", rig);
  ASSERT_EQ(post("/api/spool", spool).status, 200);
  EXPECT_EQ(station::read_json_file(folder_ / "bench/spools/silk.json").at("holder"), rig["holder"]);

  rig.erase("holder");
  station::write_json_file(folder_ / "rig.json", rig);
  std::filesystem::remove(folder_ / "bench/spools/silk.json");
  const HttpResponse refused = post("/api/spool", spool);
  EXPECT_EQ(refused.status, 400);
  EXPECT_NE(refused.body.find("measure its frame and window"), std::string::npos) << refused.body;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "bench/spools/silk.json"));
}

TEST_F(TechnicianPage, NoNameOfARequestLeavesItsFolder) {
  post("/api/control", {{"client", "me"}});
  copy_session();
  for (const char* name : {"../x", "/etc/passwd", "a/b", ".hidden", "..", "x\ny"}) {
    for (const char* part : {"calibration", "spool"}) {
      json fields{{"client", "me"}, {"kind", "capture"}, {"name", "a"}, {"calibration", "a"}, {"spool", "a"}};
      fields[part] = name;
      EXPECT_EQ(refused_with("/api/job", fields), 400) << part << " " << name;
    }
    EXPECT_EQ(refused_with("/api/job", {{"client", "me"}, {"kind", "check"}, {"calibration", name}}), 400) << name;
    EXPECT_EQ(refused_with("/api/job", {{"client", "me"}, {"kind", "cloth"}, {"name", "silk_red"}, {"draft", name}}),
              400)
        << name;
    EXPECT_EQ(refused_with("/api/job",
                           {{"client", "me"}, {"kind", "export"}, {"number", 1}, {"format", "folder"}, {"name", name}}),
              400)
        << name;
    EXPECT_EQ(
        refused_with("/api/spool",
                     {{"client", "me"}, {"name", "silk"}, {"turns", 50}, {"diameter_mm", 0.5}, {"simulated", name}}),
        400)
        << name;
    for (const char* of : {"raw", "photographed", "cloth"})
      EXPECT_EQ(asked("/picture", {{"of", of}, {"session", name}, {"step", "a"}, {"view", "a"}}).status, 400)
          << of << name;
    EXPECT_EQ(asked("/picture", {{"of", "raw"}, {"session", "silk_red"}, {"step", name}}).status, 400) << name;
    EXPECT_EQ(asked("/picture", {{"of", "cloth"}, {"session", "silk_red"}, {"view", name}}).status, 400) << name;
    EXPECT_EQ(asked("/picture", {{"of", "draft"}, {"name", name}}).status, 400) << name;
    EXPECT_EQ(asked("/api/result", {{"name", name}}).status, 400) << name;
    EXPECT_EQ(asked("/api/thread", {{"number", name}}).status, 400) << name;
  }
  EXPECT_TRUE(get("/api/state").at("job").is_null());
}

// A journal of another machine may say anything, with the right checksums.

// The browsers' connections are among them: one that a job keeps open is never closed.

// Beside the jobs: another draft is another cloth, another view the same one; a stop is not for it.
TEST_F(TechnicianPage, ADesignIsSeenWhileItIsMade) {
  ASSERT_EQ(run_threadstation({"library", "add", std::string(DATA_DIR) + "/threads/silk_red.json", "--library",
                               folder_ / "bench/library"})
                .status,
            0);
  json wanted{{"client", "me"}, {"number", 1}, {"weft", 1}, {"draft", "plain"}, {"shape", "swatch"}};
  EXPECT_EQ(refused_with("/api/look", wanted), 409) << "nobody is in control";
  post("/api/control", {{"client", "me"}});
  const auto shown = [&](int look) {
    json state;
    EXPECT_TRUE(eventually([&] {
      state = get("/api/look");
      return !state.at("shown").is_null() && state["shown"]["look"] == look;
    })) << state;
    return state;
  };
  const auto looked = [&] { return json::parse(post("/api/look", wanted).body).at("look").get<int>(); };
  EXPECT_EQ(asked("/picture", {{"of", "look"}}).status, 404);
  const json first = shown(looked());
  EXPECT_EQ(asked("/picture", {{"of", "look"}}).body.substr(1, 3), "PNG");
  wanted["turn_deg"] = 40;
  const json turned = shown(looked());
  EXPECT_EQ(turned.at("of"), first.at("of"));
  EXPECT_EQ(json::parse(post("/api/stop", {}).body).at("message"), "nothing is running");
  EXPECT_TRUE(get("/api/look").at("running"));
  wanted["draft"] = "satin_5";
  EXPECT_NE(shown(looked()).at("of"), first.at("of"));
  for (const auto& [key, value] : {std::pair<const char*, json>("shape", "cube"),
                                   {"fibers", "felt"},
                                   {"draft", "../plain"},
                                   {"number", 7},
                                   {"zoom", 100},
                                   {"weft", "1"}}) {
    json wrong = wanted;
    wrong[key] = value;
    EXPECT_GE(refused_with("/api/look", wrong), 400) << key;
  }
  EXPECT_TRUE(get("/api/look").at("running"));
  EXPECT_EQ(post("/api/look", {{"client", "me"}, {"ended", true}}).status, 200);
  EXPECT_FALSE(get("/api/look").at("running"));
}

TEST_F(TechnicianPage, AJobKeepsNoneOfTheServersFilesOpen) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  start_calibration();
  close(ends[1]);
  ASSERT_EQ(fcntl(ends[0], F_SETFL, O_NONBLOCK), 0);
  char byte = 0;
  EXPECT_EQ(read(ends[0], &byte, 1), 0) << "the job holds the other end";
  close(ends[0]);
}

TEST_F(TechnicianPage, ALiveViewEndsForTheNextJob) {
  post("/api/control", {{"client", "me"}});
  ASSERT_EQ(post("/api/job", {{"client", "me"}, {"kind", "preview"}}).status, 200);
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(folder_ / "bench/preview.jpg"); })) << job().dump(1);
  ASSERT_TRUE(eventually([&] { return get("/api/bench").at("frame").at("kind") == "preview"; }));
  EXPECT_GT(get("/api/bench").at("frame").at("tags")[0].at("seen"), 3);  // the platform stands in the room's light
  const HttpResponse next = post("/api/job", {{"client", "me"}, {"kind", "calibrate"}, {"name", "monday"}});
  EXPECT_EQ(next.status, 200) << next.body;
  EXPECT_EQ(job().at("kind"), "calibrate");
}

// The next job waits for the live view to end; its program here ends when the test says so.
TEST_F(TechnicianPage, AStopWhileAJobIsBeingStartedKeepsItFromStarting) {
  const auto file = [&](const char* name) { return folder_ / name; };
  std::ofstream(file("program")) << "#!/bin/sh\ncd \"${0%/*}\"\n"
                                    "if [ $1 != preview ]; then touch $1; exit; fi\n"
                                    "trap 'touch told' INT\ntouch shown\n"
                                    "until [ -e over ]; do sleep 0.02; done\n";
  std::filesystem::permissions(file("program"), std::filesystem::perms::owner_all);
  page_ = std::make_unique<station::TechnicianPage>(
      file("rig.json"), file("bench"), [] {}, file("program"));
  post("/api/control", {{"client", "me"}});
  ASSERT_EQ(post("/api/job", {{"client", "me"}, {"kind", "preview"}}).status, 200);
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(file("shown")); }));
  auto next = std::async(std::launch::async, [&] { return post("/api/job", {{"client", "me"}, {"kind", "home"}}); });
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(file("told")); }));
  EXPECT_EQ(post("/api/stop", {{"client", "a watcher"}}).status, 200);
  std::ofstream(file("over")) << "";
  EXPECT_EQ(next.get().status, 409);
  ASSERT_TRUE(eventually([&] { return job().at("running") == false; }));
  EXPECT_EQ(job().at("kind"), "preview");
  EXPECT_FALSE(std::filesystem::exists(file("home")));
}

// Its program counts how often it is told.
TEST_F(TechnicianPage, TheEmergencyStopReachesAJobThatAnEarlierServerHasLeft) {
  const auto file = [&](const char* name) { return folder_ / name; };
  std::ofstream(file("program")) << "#!/bin/sh\ncd \"${0%/*}\"\n"
                                    "trap 'touch told' INT\ntouch began\n"
                                    "until [ -e told ]; do sleep 0.02; done\n";
  std::filesystem::permissions(file("program"), std::filesystem::perms::owner_all);
  const auto serve_again = [&] {
    page_ = std::make_unique<station::TechnicianPage>(
        file("rig.json"), file("bench"), [] {}, file("program"));
  };
  const auto stop = [&] { return json::parse(post("/api/stop", {{"client", "a watcher"}}).body).at("message"); };
  serve_again();
  post("/api/control", {{"client", "me"}});
  ASSERT_EQ(post("/api/job", {{"client", "me"}, {"kind", "home"}}).status, 200);
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(file("began")); }));
  serve_again();
  EXPECT_EQ(stop(), "stopped");
  EXPECT_TRUE(eventually([&] { return std::filesystem::exists(file("told")); }));
  EXPECT_TRUE(eventually([&] { return stop() == "nothing is running"; }));
}

// Shells in the program's place: steps that end as they are told.
struct JobSteps : testing::Test {
  station::JobRequest request(const std::vector<std::string>& scripts) {
    station::JobRequest asked{.title = "a job", .steps = {}, .said = folder_ / "said", .program = "/bin/sh"};
    for (const std::string& script : scripts)
      asked.steps.push_back({"step", {"-c", "cd " + folder_.path().string() + "; " + script}});
    return asked;
  }
  json ended(station::Job& job) {
    for (int i = 0; i < 600 && job.running(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return job.state();
  }
  static std::vector<std::string> states(const json& job) {
    std::vector<std::string> found;
    for (const json& step : job.at("steps")) found.push_back(step.at("state"));
    return found;
  }
  TemporaryFolder folder_;
};

TEST_F(JobSteps, FollowEachOtherAndWhatTheySayIsKept) {
  station::Job job(request({"echo one; touch first", "test -e first && echo two"}), [] {});
  const json state = ended(job);
  EXPECT_EQ(state.at("outcome"), "well");
  EXPECT_EQ(states(state), (std::vector<std::string>{"well", "well"}));
  EXPECT_EQ(state.at("lines"), (json{"one", "two"}));
}

TEST_F(JobSteps, OneThatFailsKeepsTheOthersFromBeginning) {
  station::Job job(request({"true", "exit 3", "touch third"}), [] {});
  const json state = ended(job);
  EXPECT_EQ(state.at("outcome"), "badly");
  EXPECT_EQ(state.at("status"), 3);
  EXPECT_EQ(states(state), (std::vector<std::string>{"well", "badly", "waiting"}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "third"));
}

// The step may be through before it hears of a pause, or of a stop: what follows must not begin all the same.
TEST_F(JobSteps, APauseAndAStopKeepTheNextOneFromBeginning) {
  for (const bool stops : {false, true}) {
    station::Job job(request({"trap 'exit 0' INT; touch begun; while true; do sleep 0.05; done", "touch second"}),
                     [] {});
    for (int i = 0; i < 600 && !std::filesystem::exists(folder_ / "begun"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    stops ? job.stop_now() : job.pause();
    const json state = ended(job);
    EXPECT_EQ(state.at("outcome"), stops ? "stopped" : "paused");
    EXPECT_EQ(states(state)[0], "well");
    EXPECT_EQ(states(state)[1], stops ? "stopped" : "paused");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "second"));
    std::filesystem::remove(folder_ / "begun");
  }
}

}  // namespace
}  // namespace station_test
