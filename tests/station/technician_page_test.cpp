// Who may have the technician's page do what: one browser in control, names that stay in the workspace, and a run that is none
// of the network's business (rows 14, 37).
#include <fcntl.h>
#include <unistd.h>

#include <array>

#include "tests/station/technician_page_fixture.h"

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
  EXPECT_EQ(post("/api/answer", {{"client", "me"}, {"done", true}, {"question", 1}}).status,
            409);  // nothing is running
}

TEST_F(TechnicianPage, AQuestionIsShownAndItsAnswerReachesTheRun) {
  start_calibration();
  const json question = job().at("question");
  EXPECT_FALSE(question.empty());
  EXPECT_TRUE(job().at("arrangement").contains("lamp")) << job().dump(1);
  EXPECT_EQ((question.dump() + job().at("lines").dump()).find("arrangement"), std::string::npos);
  EXPECT_EQ(post("/api/job", {{"client", "me"}, {"kind", "calibrate"}, {"name", "two"}}).status, 409);
  EXPECT_EQ(post("/api/answer", {{"client", "me"}, {"done", false}, {"question", job().at("asked")}}).status, 200);
  ASSERT_TRUE(eventually([&] { return job().at("running") == false; }));
  EXPECT_EQ(job().at("status"), 1);
  EXPECT_NE(job().at("lines").dump().find("the person declined"), std::string::npos) << job().dump(1);
}

TEST_F(TechnicianPage, ASecondClickDoesNotAnswerTheNextQuestion) {
  start_calibration();
  const int first = job().at("asked");
  EXPECT_EQ(post("/api/answer", {{"client", "me"}, {"done", true}, {"question", first}}).status, 200);
  EXPECT_EQ(refused_with("/api/answer", {{"client", "me"}, {"done", true}, {"question", first}}), 409);
  ASSERT_TRUE(eventually([&] { return job().at("asked") == first + 1; })) << job().dump(1);
  EXPECT_EQ(refused_with("/api/answer", {{"client", "me"}, {"done", true}, {"question", first}}), 409);
  EXPECT_EQ(refused_with("/api/answer", {{"client", "me"}, {"done", true}}), 400);
  EXPECT_EQ(job().at("asked"), first + 1);
  EXPECT_FALSE(job().at("question").is_null());
}

TEST_F(TechnicianPage, TheEmergencyStopIsAnybodysAndEndsTheRun) {
  start_calibration();
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(post("/api/stop", {{"client", "a watcher"}}).status, 200);
  EXPECT_LT(std::chrono::steady_clock::now() - began, 1s);
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
    EXPECT_EQ(
        refused_with("/api/job",
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

}  // namespace
}  // namespace station_test
