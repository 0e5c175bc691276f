// What the technician's page shows, and what its forms write: sessions, pictures, queues, devices, spools.
#include <cctype>
#include <cmath>
#include <regex>
#include <set>

#include "rig/devices/clock.h"
#include "station/documents/sample.h"
#include "station/documents/spool.h"
#include "station/serve/left_jobs.h"
#include "station/session/record/journal.h"
#include "station/thread/library.h"
#include "tests/station/serve/technician_page_fixture.h"

namespace station_test {
namespace {

TEST_F(TechnicianPage, ASessionIsShownAsItsJournalHasItNow) {
  const std::filesystem::path folder = folder_ / "bench/sessions/silk_red";
  copy_session();
  const json shown = get("/api/session", "silk_red");
  EXPECT_EQ(shown.at("state"), "complete");
  ASSERT_EQ(shown.at("views").size(), 17U);
  for (const json& view : shown["views"]) EXPECT_EQ(view.at("grade"), "good") << view;
  std::ifstream stream(folder / "journal.jsonl");
  std::string journal{std::istreambuf_iterator<char>(stream), {}};
  journal.resize(journal.rfind('\n', journal.size() - 2) + 1);  // without its stop
  std::ofstream(folder / "journal.jsonl") << journal;
  EXPECT_EQ(get("/api/state").at("sessions")[0].at("state"), "interrupted");
}

TEST_F(TechnicianPage, AViewThatTheFitHasNotSeenIsToldApart) {
  copy_session();
  json thread = station::read_json_file(std::filesystem::path(DATA_DIR) / "threads/silk_red.json");
  const json view{{"id", "reflection-horizontal-1"}, {"relative_rmse", 0.1}, {"relative_bias", 0.02}};
  json held_out = view;
  held_out["held_out"] = true;
  thread["fit"]["views"] = {view, held_out};
  std::filesystem::create_directories(folder_ / "bench/sessions/silk_red/result");
  station::write_json_file(folder_ / "bench/sessions/silk_red/result/thread.json", thread);
  const json views = get("/api/result", "silk_red").at("views");
  ASSERT_EQ(views.size(), 2U);
  EXPECT_EQ(views[0].at("held_out"), false);
  EXPECT_EQ(views[1].at("held_out"), true);
}

TEST_F(TechnicianPage, ThePageAndItsPartsAreThere) {
  for (const char* path : {"/",           "/app.js",     "/bench.js",      "/calibration.js",
                           "/capture.js", "/curves.js",  "/document.js",   "/frame.js",
                           "/keys.js",    "/library.js", "/live.js",       "/overview.js",
                           "/result.js",  "/session.js", "/station.js",    "/step_picture.js",
                           "/viewer.js",  "/style.css",  "/texts.de.json", "/texts.en.json"}) {
    const HttpResponse answer = page_->handle({.method = "GET", .path = path});
    EXPECT_EQ(answer.status, 200) << path;
    EXPECT_GT(answer.body.size(), 500U) << path;
  }
  EXPECT_EQ(page_->handle({.method = "GET", .path = "/../rig.json"}).status, 404);
  EXPECT_EQ(page_->handle({.method = "GET", .path = "/\xff\xfe"}).status, 404);
  // Every text that the page asks for is in the one file.
  const json texts = json::parse(page_->handle({.method = "GET", .path = "/texts.en.json"}).body);
  const std::string page = page_->handle({.method = "GET", .path = "/"}).body;
  for (std::size_t at = 0; (at = page.find("data-text=\"", at)) != std::string::npos;) {
    at += 11;
    EXPECT_TRUE(texts.contains(page.substr(at, page.find('"', at) - at))) << page.substr(at, 30);
  }
}

TEST_F(TechnicianPage, EveryTextThatTheScriptsAskForIsInTheOneFile) {
  const json texts = json::parse(asked("/texts.en.json").body);
  int found = 0;
  for (const char* file :
       {"/app.js", "/bench.js", "/calibration.js", "/capture.js", "/curves.js", "/design.js", "/document.js",
        "/exposure.js", "/frame.js", "/keys.js", "/library.js", "/live.js", "/overview.js", "/result.js", "/session.js",
        "/station.js", "/step_picture.js", "/viewer.js"}) {
    const std::string script = asked(file).body;
    for (std::size_t at = 0; (at = script.find("text(\"", at)) != std::string::npos; ++found) {
      at += 6;
      if (std::isalnum(static_cast<unsigned char>(script[at - 7])) != 0) continue;  // getContext and the like
      const std::string key = script.substr(at, script.find('"', at) - at);
      if (key.ends_with("_")) continue;  // goes on with a kind
      EXPECT_TRUE(texts.contains(key)) << file << ": " << key;
    }
  }
  EXPECT_GT(found, 40);
}

// The same texts in both languages, each with the same places for values, and none left in the first one's words.
TEST_F(TechnicianPage, EveryTextIsThereInBothLanguages) {
  const json english = json::parse(asked("/texts.en.json").body), german = json::parse(asked("/texts.de.json").body);
  const auto places = [](const std::string& text) {
    std::multiset<std::string> found;
    const std::regex place("\\{[a-z]+\\}");
    for (std::sregex_iterator at(text.begin(), text.end(), place), end; at != end; ++at) found.insert(at->str());
    return found;
  };
  int same = 0;
  for (const auto& [key, text] : english.items()) {
    ASSERT_TRUE(german.contains(key)) << key;
    EXPECT_EQ(places(text), places(german[key])) << key;
    same += text == german[key] ? 1 : 0;
  }
  EXPECT_EQ(english.size(), german.size());
  EXPECT_LT(same, 15) << "texts that are alike in both";
}

TEST_F(TechnicianPage, WhatIsNotThereIsSaidInOneLine) {
  copy_session();
  for (const auto& [path, query] : std::vector<std::pair<std::string, std::map<std::string, std::string>>>{
           {"/api/result", {{"name", "silk_red"}}},
           {"/api/thread", {{"number", "7"}}},
           {"/picture", {{"of", "raw"}, {"session", "silk_red"}, {"step", "nothing"}}},
           {"/picture", {{"of", "fitted"}, {"session", "silk_red"}, {"view", "reflection-horizontal-1"}}},
           {"/picture", {{"of", "cloth"}, {"session", "silk_red"}, {"view", "swatch"}}},
           {"/picture", {{"of", "draft"}, {"name", "none"}}},
           {"/picture", {{"of", "thread"}, {"number", "7"}}},
           {"/api/calibration", {{"name", "monday"}}},
           {"/calibration", {{"name", "monday"}}},
           {"/download", {{"name", "nothing"}}},
           {"/picture", {{"of", "anything"}}},
           {"/picture", {}}}) {
    const HttpResponse answer = asked(path, query);
    EXPECT_EQ(answer.status, 404) << path;
    EXPECT_TRUE(json::parse(answer.body).contains("message")) << answer.body;
  }
}

json silk_form() {
  return {{"client", "me"},
          {"barcode", "4006381333948"},
          {"name", "silk, blue"},
          {"lot", "B 3"},
          {"material", "silk"},
          {"colour", "blue"},
          {"note", ""},
          {"turns", 50},
          {"diameter_mm", 0.5},
          {"sheets", "front"},
          {"simulated", "silk_blue"}};
}

TEST_F(TechnicianPage, TheSpoolFormWritesWhatCaptureReads) {
  post("/api/control", {{"client", "me"}});
  const HttpResponse written = post("/api/spool", silk_form());
  ASSERT_EQ(written.status, 200) << written.body;
  EXPECT_EQ(json::parse(written.body).at("name"), "4006381333948-B-3");
  const station::Spool spool = station::read_spool(folder_ / "bench/spools/4006381333948-B-3.json");
  EXPECT_EQ(spool.name, "silk, blue");
  EXPECT_EQ(spool.wrapping.turns, 50);
  EXPECT_TRUE(spool.simulation.has_value());
  const station::Sample sample = station::read_sample_file(folder_ / "bench/samples/4006381333948-B-3.json");
  EXPECT_EQ(sample.lot, "B 3");
  EXPECT_EQ(sample.colour, "blue");
  const json line = get("/api/state").at("spools").at(0);
  EXPECT_EQ(line.at("sample").at("barcode"), "4006381333948");
  EXPECT_EQ(line.at("diameter_mm"), 0.5);
}

TEST(SampleFile, TheDocumentedOneIsReadAndWrittenAgain) {
  const station::Sample sample = station::read_sample_file(std::string(DATA_DIR) + "/samples/silk_blue.json");
  EXPECT_EQ(sample.lot, "B 3");
  const TemporaryFolder folder;
  station::write_sample_file(folder / "sample.json", sample);
  EXPECT_EQ(station::read_sample_file(folder / "sample.json"), sample);
}

TEST_F(TechnicianPage, ASpoolThatNoFileMayDescribeIsRefusedByTheLineOfTheFilesReader) {
  post("/api/control", {{"client", "me"}});
  const auto refused = [&](const char* key, const json& value, const std::string& named) {
    json form = silk_form();
    form[key] = value;
    const HttpResponse answer = post("/api/spool", form);
    EXPECT_EQ(answer.status, 400) << key << answer.body;
    EXPECT_NE(answer.body.find(named), std::string::npos) << answer.body;
  };
  refused("turns", 0, "turns");
  refused("turns", "many", "turns");
  refused("turns", 50.5, "turns");
  refused("diameter_mm", -1, "thread_diameter_mm");
  refused("diameter_mm", 0.05, "fiber");  // the simulated fibers do not fit into it
  refused("sheets", "both", "sheets");
  refused("lot", std::string(300, 'x'), "200");
  json nameless = silk_form();
  nameless.erase("name");
  nameless["barcode"] = "";
  EXPECT_EQ(refused_with("/api/spool", nameless), 400);
  EXPECT_TRUE(get("/api/state").at("spools").empty());
}

TEST_F(TechnicianPage, APictureOfEachViewIsShownAndTheLastFrameIsMeasured) {
  EXPECT_TRUE(get("/api/bench").at("frame").is_null());
  EXPECT_EQ(asked("/picture", {{"of", "frame"}}).status, 404);
  copy_session();
  const HttpResponse tile = asked("/picture", {{"of", "raw"}, {"session", "silk_red"}, {"step", "transmission-2"}});
  EXPECT_EQ(tile.status, 200);
  EXPECT_EQ(tile.content_type, "image/png");
  EXPECT_TRUE(tile.body.starts_with("\x89PNG"));
  const json frame = get("/api/bench").at("frame");
  EXPECT_TRUE(frame.at("source").get<std::string>().starts_with("silk_red: ")) << frame;
  double parts = 0;
  for (const json& part : frame.at("histogram").at("g")) parts += part.get<double>();
  EXPECT_NEAR(parts, 1, 1e-9);
  EXPECT_GE(frame.at("exposure").at("level"), 0);
  EXPECT_LE(frame.at("exposure").at("level"), 1.05);
  EXPECT_EQ(frame.at("tags").size(), 4U);
  EXPECT_EQ(asked("/picture", {{"of", "frame"}}).status, 200);
}

TEST_F(TechnicianPage, AJournalThatNamesAFileElsewhereShowsNoPicture) {
  copy_session();
  const std::filesystem::path file = folder_ / "bench/sessions/silk_red/journal.jsonl";
  const auto records = station::read_journal(file).records;
  const std::map<std::string, std::string> query{{"of", "raw"}, {"session", "silk_red"}, {"step", "transmission-2"}};
  const auto write_naming = [&](const std::string& picture) {
    std::filesystem::remove(file);
    rig::SystemClock clock;
    station::FileSystem disk;
    station::Journal journal(file, clock, disk);
    for (const station::JournalRecord& record : records) {
      json data = record.data;
      if (record.event == "picture" && data.at("step") == "transmission-2") data["file"] = picture;
      journal.append(record.event, data);
    }
  };
  write_naming("raw/transmission-2.arw");
  EXPECT_EQ(asked("/picture", query).status, 200);
  std::filesystem::copy(folder_ / "bench/sessions/silk_red/raw/transmission-2.arw", folder_ / "other.arw");
  for (const char* elsewhere : {"../../../other.arw", "raw/../../../../other.arw", "/etc/passwd"}) {
    write_naming(elsewhere);
    EXPECT_EQ(asked("/picture", query).status, 404) << elsewhere;
  }
}

// What was made before what it is made of is left to do, and a new fit is another thread.
TEST_F(TechnicianPage, ASessionSaysWhatIsLeftToDo) {
  copy_session();
  const std::filesystem::path session = folder_ / "bench/sessions/silk_red";
  const auto left = [&] { return get("/api/state").at("sessions")[0].at("left"); };
  EXPECT_EQ(left(), (json{"develop", "invert", "report", "add"}));
  const auto made = [&](const char* file, int minutes) {
    std::filesystem::last_write_time(session / file,
                                     std::filesystem::file_time_type::clock::now() + std::chrono::minutes(minutes));
  };
  const auto write = [&](const char* file, int minutes) {
    std::filesystem::create_directories((session / file).parent_path());
    std::ofstream(session / file) << "{}";
    made(file, minutes);
  };
  const auto fitted_as = [&](const char* thread, int minutes) {
    std::filesystem::copy_file(std::string(DATA_DIR) + "/threads/" + thread, session / "result/thread.json",
                               std::filesystem::copy_options::overwrite_existing);
    made("result/thread.json", minutes);
  };
  write("linear/views.json", 1);
  EXPECT_EQ(left(), (json{"invert", "report", "add"}));
  std::filesystem::create_directories(session / "result");
  fitted_as("silk_red.json", 2);
  write("report.html", 3);
  EXPECT_EQ(left(), (json{"add"}));
  station::Library(folder_ / "bench/library", true).add(session / "result/thread.json", "2026-11-21T10:20:30.123Z");
  EXPECT_EQ(left(), json::array());
  fitted_as("silk_blue.json", 4);
  EXPECT_EQ(left(), (json{"report", "add"}));
  write("linear/views.json", 5);
  EXPECT_EQ(left(), (json{"invert", "report", "add"}));
}

TEST(OldJobs, AreForgottenButForTheLastChecks) {
  const station_test::TemporaryFolder folder;
  const auto said = [&](int time, const char* kind) {
    const auto path = [&](const char* ending) { return folder / (std::to_string(time) + "-" + kind + ending); };
    std::ofstream(path(".out")) << "[]";
    std::ofstream(path(".progress")) << "{}";
    return path(".out");
  };
  const auto old_check = said(1000, "check"), check = said(1001, "check"), last_check = said(1002, "check"),
             old = said(1003, "invert"), newer = said(1004, "capture"), newest = said(1005, "invert");
  std::ofstream(folder / "1003-invert.process") << "1 1";
  station::forget_old_jobs(folder / ".", 2);
  for (const auto& kept : {check, last_check, newer, newest}) EXPECT_TRUE(std::filesystem::exists(kept)) << kept;
  for (const auto& gone : {old_check, old}) EXPECT_FALSE(std::filesystem::exists(gone)) << gone;
  EXPECT_FALSE(std::filesystem::exists(folder / "1003-invert.progress"));
  EXPECT_TRUE(std::filesystem::exists(folder / "1003-invert.process")) << "the emergency stop finds it by that";
}

TEST_F(TechnicianPage, ACalibrationIsShownWithItsGatesAndItsBudget) {
  const std::filesystem::path folder = folder_ / "bench/calibrations/ready";
  std::filesystem::create_directories(folder);
  EXPECT_FALSE(get("/api/state").at("calibrations")[0].contains("utc"));
  std::filesystem::copy_file(std::filesystem::path(DATA_DIR) / "calibrations/simulated.json",
                             folder / "calibration.json");
  const json line = get("/api/state").at("calibrations").at(0), full = get("/api/calibration", "ready");
  EXPECT_EQ(line.at("gates"), full.at("gates"));
  EXPECT_GT(line.at("gates").size(), 10U);
  for (const json& gate : full["gates"])
    EXPECT_EQ(gate.at("passed"),
              gate.at("at_least") ? gate.at("value") >= gate.at("limit") : gate.at("value") <= gate.at("limit"))
        << gate;
  double squares = 0;
  for (std::size_t i = 0; i + 1 < full["budget"].size(); ++i)
    squares += std::pow(full["budget"][i].at("front").get<double>(), 2);
  EXPECT_NEAR(line.at("error_front").get<double>(), std::sqrt(squares), 1e-9);
  std::ofstream(folder / "calibration.json") << "{";
  EXPECT_TRUE(get("/api/state").at("calibrations")[0].contains("problem"));
}

// Three spools, of which the first one is captured already.
void write_week(const std::filesystem::path& workspace) {
  std::filesystem::copy(std::string(FIXTURES_DIR) + "/sessions/silk_red", workspace / "sessions/4006381333931-A-12",
                        std::filesystem::copy_options::recursive);
  const std::string spool = std::string(DATA_DIR) + "/spools/silk_red.json";
  std::ofstream(workspace / "queues/week.csv")
      << "barcode,name,lot,material,colour,note,spool\n4006381333931,red,A 12,silk,,," << spool
      << "\n4006381333948,blue,B 3,silk,,,\n4006381333955,green,,silk,,,\n";
}

TEST_F(TechnicianPage, AQueueThatTheBenchPausesSaysWhyAndWhatIsDoneAndWhatWaits) {
  post("/api/control", {{"client", "me"}});
  write_week(folder_ / "bench");
  const HttpResponse started = post(
      "/api/job", {{"client", "me"}, {"kind", "queue"}, {"name", "week"}, {"calibration", "none"}, {"person", "me"}});
  EXPECT_EQ(started.status, 200) << started.body;
  ASSERT_TRUE(eventually([&] { return !job().at("question").is_null(); })) << job().dump(1);
  EXPECT_EQ(answer(job().at("question"), "done").status, 200);
  ASSERT_TRUE(eventually([&] { return job().at("running") == false || !job().at("question").is_null(); }));
  ASSERT_TRUE(job().at("question").is_null()) << "the next spool is asked for: " << job().dump(1);
  EXPECT_EQ(job().at("status"), 1);
  const std::string last = job().at("lines").back();
  for (const char* words : {"the queue is paused by a fault of the bench: ", "done: 4006381333931-A-12;",
                            "waiting: 4006381333948-B-3, 4006381333955;", "the same command goes on"})
    EXPECT_NE(last.find(words), std::string::npos) << last;
}

TEST_F(TechnicianPage, AQueueIsShownRowByRowAndABadOneSaysWhy) {
  post("/api/control", {{"client", "me"}});
  write_week(folder_ / "bench");
  std::ofstream(folder_ / "bench/queues/bad.csv") << "barcode,name,lot,material,colour,note,spool\n,,,,,,x.json\n";
  const json queues = get("/api/state").at("queues");
  ASSERT_EQ(queues.size(), 2U);
  EXPECT_NE(queues[0].at("problem").get<std::string>().find("neither barcode nor name"), std::string::npos);
  ASSERT_EQ(queues[1].at("spools").size(), 3U);
  EXPECT_EQ(queues[1]["spools"][0].at("state"), "complete");
  EXPECT_EQ(queues[1]["spools"][1].at("sample").at("name"), "blue");
  EXPECT_TRUE(queues[1]["spools"][1].at("state").is_null());
  const HttpResponse started = post(
      "/api/job", {{"client", "me"}, {"kind", "queue"}, {"name", "week"}, {"calibration", "none"}, {"person", "-x"}});
  EXPECT_EQ(started.status, 200) << started.body;
  // The first is complete already.
  ASSERT_TRUE(eventually([&] { return !job().at("question").is_null(); })) << job().dump(1);
  EXPECT_NE(job().at("question").dump().find("4006381333948-B-3"), std::string::npos) << job().dump(1);
  EXPECT_FALSE(job().at("question").contains("arrangement"));
  EXPECT_EQ(answer(job().at("question"), "decline").status, 200);
  ASSERT_TRUE(eventually([&] { return job().at("running") == false; }));
  EXPECT_NE(job().at("lines").dump().find("4006381333931-A-12: was complete already"), std::string::npos)
      << job().dump(1);
}

TEST_F(TechnicianPage, DevicesAreAsTheLastCheckFoundThem) {
  post("/api/control", {{"client", "me"}});
  for (const json& device : get("/api/bench").at("devices")) EXPECT_TRUE(device.at("passed").is_null());
  ASSERT_EQ(post("/api/job", {{"client", "me"}, {"kind", "check"}}).status, 200);
  ASSERT_TRUE(eventually([&] { return job().at("running") == false; }));
  const json bench = get("/api/bench");
  ASSERT_EQ(bench.at("devices").size(), 2U);
  for (const json& device : bench["devices"]) EXPECT_EQ(device.at("passed"), true) << device.dump(1);
  EXPECT_FALSE(bench.at("checked_ms").is_null());
  EXPECT_EQ(job().at("lines").dump().find("passed"), std::string::npos) << "JSON is not for people";
}

}  // namespace
}  // namespace station_test
