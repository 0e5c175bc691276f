// What the technician's page shows of the library's threads and designs, and what it does with them.
#include "station/documents/thread_file.h"
#include "station/serve/result_document.h"
#include "station/thread/library.h"
#include "tests/station/commands/program.h"
#include "tests/station/serve/technician_page_fixture.h"

namespace station_test {
namespace {

TEST_F(TechnicianPage, AThreadIsEditedTakenOutAndPutBack) {
  station::Library(folder_ / "bench/library", true)
      .add(std::filesystem::path(DATA_DIR) / "threads/silk_blue.json", "2026-11-21T10:20:30.123Z");
  EXPECT_EQ(refused_with("/api/thread", {{"client", "me"}, {"number", 1}, {"removed", true}}), 409);
  post("/api/control", {{"client", "me"}});
  EXPECT_EQ(post("/api/thread", {{"client", "me"}, {"number", 1}, {"name", "Seide, blau"}, {"lot", "7"}}).status, 200);
  EXPECT_EQ(get("/api/state").at("threads")[0].at("sample").at("lot"), "7");
  EXPECT_EQ(refused_with("/api/thread", {{"client", "me"}, {"number", 1}, {"lot", "7"}}), 400);
  EXPECT_EQ(refused_with("/api/thread", {{"client", "me"}, {"number", "1; DROP TABLE threads"}, {"lot", "7"}}), 400);
  EXPECT_EQ(refused_with("/api/thread", {{"client", "me"}, {"number", 2}, {"removed", true}}), 409);
  EXPECT_EQ(post("/api/thread", {{"client", "me"}, {"number", 1}, {"removed", true}}).status, 200);
  EXPECT_EQ(get("/api/state").at("threads").size(), 0U);
  EXPECT_EQ(refused_with("/api/thread", {{"client", "me"}, {"number", 1}, {"removed", true}}), 409);
  EXPECT_EQ(post("/api/thread", {{"client", "me"}, {"number", 1}, {"removed", false}}).status, 200);
  EXPECT_EQ(get("/api/state").at("threads").size(), 1U);
}

TEST_F(TechnicianPage, ADesignIsWovenOfReadyThreadsBeforeThereIsAnyOfOnesOwn) {
  const json ready = get("/api/state").at("ready_threads");
  EXPECT_EQ(ready.size(), 28U);
  post("/api/control", {{"client", "me"}});
  ASSERT_EQ(post("/api/job", {{"client", "me"},
                              {"kind", "design"},
                              {"name", "ready"},
                              {"number", ready.at(0)},
                              {"weft", ready.at(1)},
                              {"draft", "plain"},
                              {"shape", "swatch"},
                              {"quick", true}})
                .status,
            200);
  ASSERT_TRUE(eventually([&] { return !job().at("running").get<bool>(); }));
  ASSERT_EQ(job().at("status"), 0) << job();
  EXPECT_EQ(get("/api/state").at("designs").at(0).at("threads").size(), 2U);
}

TEST_F(TechnicianPage, ADesignIsWovenOfThreadsOfTheLibrary) {
  station::Library library(folder_ / "bench/library", true);
  for (const char* thread : {"silk_red.json", "silk_blue.json"})
    library.add(std::filesystem::path(DATA_DIR) / "threads" / thread, "2026-11-21T10:20:30.123Z");
  post("/api/control", {{"client", "me"}});
  const json wanted{{"client", "me"}, {"kind", "design"}, {"name", "rot x blau"}, {"number", 1},
                    {"weft", 2},      {"draft", "plain"}, {"quick", true}};
  json missing = wanted;
  missing["weft"] = 3;
  EXPECT_EQ(refused_with("/api/job", missing), 404);
  for (const char* none : {"silk_grey", "../threads/silk_red", ""}) {
    missing["weft"] = none;
    EXPECT_GE(refused_with("/api/job", missing), 400) << none;
  }
  ASSERT_EQ(post("/api/job", wanted).status, 200);
  ASSERT_TRUE(eventually([&] { return !job().at("running").get<bool>(); }));
  ASSERT_EQ(job().at("status"), 0) << job();
  const json design = get("/api/state").at("designs").at(0);
  EXPECT_NE(design.at("threads")[0], design.at("threads")[1]);
  const std::string name = design.at("name");
  const auto shown = [&](const char* view) {
    return asked("/picture", {{"of", "design"}, {"name", name}, {"view", view}});
  };
  EXPECT_EQ(shown("swatch").content_type, "image/png");
  EXPECT_EQ(shown("nothing").status, 404);
  const auto at = [&](const char* stops) {
    return asked("/picture", {{"of", "design"}, {"name", name}, {"view", "swatch"}, {"stops", stops}});
  };
  EXPECT_EQ(at("0").body, shown("swatch").body);
  EXPECT_NE(at("-2").body, shown("swatch").body);
  EXPECT_EQ(at("-2").content_type, "image/png");
  for (const char* stops : {"bright", "1.5", "99"}) EXPECT_EQ(at(stops).status, 400) << stops;
  EXPECT_EQ(refused_with("/api/job", wanted), 409) << "a design is not replaced by another";
  const HttpResponse packed = asked("/download", {{"of", "design"}, {"name", name}});
  EXPECT_NE(packed.body.find("/weft_thread.json"), std::string::npos);
  EXPECT_NE(packed.body.find("/swatch.exr"), std::string::npos);
}

TEST_F(TechnicianPage, BatchesInTheWorkspaceAreShownAndStopped) {
  EXPECT_EQ(get("/api/batches").size(), 0U);
  std::filesystem::create_directories(folder_ / "bench/batches");
  const std::string batch = folder_ / "bench/batches/tables";
  const ProgramResult done =
      run_threadstation({"batch", std::string(DATA_DIR) + "/batches/ready_threads.json", "--out", batch, "--quiet"});
  ASSERT_EQ(done.status, 0) << done.error;
  const json shown = get("/api/batches");
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_EQ(shown[0].at("name"), "tables");
  EXPECT_EQ(shown[0].at("steps")[0].at("done"), shown[0].at("steps")[0].at("tasks"));
  EXPECT_NE(asked("/batch", {{"name", "tables"}}).body.find("<th>step</th>"), std::string::npos);
  EXPECT_EQ(asked("/batch", {{"name", "none"}}).status, 404);
  EXPECT_EQ(asked("/batch", {{"name", "../x"}}).status, 400);
  EXPECT_EQ(refused_with("/api/batch", {{"client", "me"}, {"name", "tables"}}), 409) << "not in control";
  post("/api/control", {{"client", "me"}});
  EXPECT_EQ(json::parse(post("/api/batch", {{"client", "me"}, {"name", "tables"}}).body).at("message"),
            "nothing of it is running");
  EXPECT_EQ(refused_with("/api/batch", {{"client", "me"}, {"name", "none"}}), 404);
  std::ofstream(batch + "/plan.json") << "{";
  EXPECT_NE(get("/api/batches")[0].at("problem").get<std::string>().find("plan.json"), std::string::npos);
}

TEST_F(TechnicianPage, AnExportIsDownloadedAsOneFile) {
  std::filesystem::create_directories(folder_ / "bench/exports/thread-1/textures");
  std::ofstream(folder_ / "bench/exports/thread-1/textures/a.txt") << "some words";
  std::ofstream(folder_ / "outside.txt") << "not for others";
  std::filesystem::create_symlink(folder_ / "outside.txt", folder_ / "bench/exports/thread-1/link.txt");
  const HttpResponse packed = asked("/download", {{"name", "thread-1"}});
  ASSERT_EQ(packed.status, 200);
  EXPECT_EQ(packed.body.substr(0, 2), "PK");
  EXPECT_NE(packed.body.find("thread-1/textures/a.txt"), std::string::npos);
  EXPECT_EQ(packed.body.find("link.txt"), std::string::npos) << "what lies elsewhere is not given away";
  EXPECT_EQ(asked("/download", {{"name", "../sessions"}}).status, 400);
}

TEST_F(TechnicianPage, AThreadOfTheLibraryIsShownWithItsCurves) {
  station::Library(folder_ / "bench/library", true)
      .add(std::string(DATA_DIR) + "/threads/silk_red.json", "2026-01-01T00:00:00Z");
  const json thread = json::parse(asked("/api/thread", {{"number", "1"}}).body);
  ASSERT_EQ(thread.at("curves").size(), 41U);
  EXPECT_EQ(thread["curves"][0].at("cosine"), 0);
  EXPECT_EQ(thread["curves"][0].at("lambda")[1], 0);    // r1 c
  EXPECT_FALSE(thread["curves"][0].contains("sigma"));  // it was never fitted
  const std::string colour = thread.at("colour").at("srgb");
  EXPECT_GT(colour.substr(1, 2), colour.substr(3, 2));  // red silk
  EXPECT_EQ(get("/api/state").at("threads")[0].at("number"), 1);
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(TechnicianPage, AThreadOfAnotherStationIsImportedWithItsSampleAndGetsALabel) {
  post("/api/control", {{"client", "me"}});
  const std::string thread = text_of(std::filesystem::path(DATA_DIR) / "threads/silk_blue.json");
  station::write_sample_file(
      folder_ / "sample.json",
      {.barcode = "4006381333948", .name = "blue <silk>", .lot = "B 3", .material = "silk", .colour = "", .note = ""});
  const json wanted{
      {"client", "me"}, {"name", "thread.json"}, {"thread", thread}, {"sample", text_of(folder_ / "sample.json")}};
  const HttpResponse made = post("/api/import", wanted);
  ASSERT_EQ(made.status, 200) << made.body;
  EXPECT_EQ(json::parse(made.body).at("number"), 1);
  const json line = get("/api/state").at("threads").at(0);
  EXPECT_EQ(line.at("sample").at("barcode"), "4006381333948");
  EXPECT_EQ(line.at("sample").at("lot"), "B 3");

  const HttpResponse label = asked("/label", {{"number", "1"}});
  EXPECT_EQ(label.content_type, "image/svg+xml");
  EXPECT_NE(label.body.find("blue &lt;silk&gt;"), std::string::npos) << label.body;
  EXPECT_EQ(asked("/label", {{"number", "7"}}).status, 404);
  EXPECT_EQ(asked("/label", {{"number", "x"}}).status, 400);

  EXPECT_NE(json::parse(post("/api/import", wanted).body)
                .at("message")
                .get<std::string>()
                .find("in the library already, as number 1"),
            std::string::npos);
  json other = wanted;
  other["thread"] = "{\"format\": \"threadstation/spool\"}";
  EXPECT_EQ(refused_with("/api/import", other), 409);
  other["name"] = "../thread.json";
  EXPECT_EQ(refused_with("/api/import", other), 400);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "bench/jobs/import"));
  // A sample without any name is refused before anything is added.
  other = wanted;
  other["thread"] = text_of(std::filesystem::path(DATA_DIR) / "threads/silk_red.json");
  json nameless = json::parse(text_of(folder_ / "sample.json"));
  nameless["name"] = nameless["barcode"] = "";
  other["sample"] = nameless.dump();
  EXPECT_EQ(refused_with("/api/import", other), 409);
  EXPECT_EQ(get("/api/state").at("threads").size(), 1U);
}

// One has a session to be seen in, the other is woven for it; while a job runs, only what is there is shown.
TEST_F(TechnicianPage, AThreadThatCameWithoutASessionIsWovenToBeSeen) {
  copy_session();
  const std::filesystem::path session = folder_ / "bench/sessions/silk_red";
  std::filesystem::create_directory(session / "result");
  std::filesystem::copy(std::string(DATA_DIR) + "/threads/silk_red.json", session / "result/thread.json");
  station::Library(folder_ / "bench/library", true).add(session, "2026-01-01T00:00:00Z");
  start_calibration();
  const std::string thread = text_of(std::filesystem::path(DATA_DIR) / "threads/silk_blue.json");
  ASSERT_EQ(post("/api/import", {{"client", "me"}, {"name", "thread.json"}, {"thread", thread}}).status, 200);
  ASSERT_TRUE(job().at("running"));
  const auto pictured = [&](int line) { return get("/api/state").at("threads").at(line).at("pictured") == true; };
  EXPECT_TRUE(pictured(0));
  EXPECT_FALSE(pictured(1));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "bench/pictures"));
  EXPECT_EQ(asked("/picture", {{"of", "thread"}, {"number", "2"}}).status, 404);
  EXPECT_EQ(post("/api/stop", {}).status, 200);
  ASSERT_TRUE(eventually([&] { return job().at("running") == false; }));
  const int before = changes_;
  ASSERT_TRUE(eventually([&] { return pictured(1); }));
  EXPECT_LE(changes_ - before, 2) << "nobody is told of each step of the picture";
  EXPECT_EQ(asked("/picture", {{"of", "thread"}, {"number", "2"}}).body.substr(1, 3), "PNG");
  const std::filesystem::directory_iterator kept(folder_ / "bench/pictures");
  EXPECT_EQ(std::distance(begin(kept), end(kept)), 1) << "nothing but the picture";
}

// A file that is spoiled is tried once.
TEST_F(TechnicianPage, AThreadThatCannotBeWovenIsTriedOnce) {
  station::Library library(folder_ / "bench/library", true);
  library.add(std::string(DATA_DIR) + "/threads/silk_red.json", "2026-01-01T00:00:00Z");
  std::ofstream(library.thread_file(1)) << "{";
  get("/api/state");
  const auto begun = folder_ / "bench/pictures";
  ASSERT_TRUE(std::filesystem::exists(begun));
  ASSERT_TRUE(eventually([&] {
    get("/api/state");
    return std::filesystem::is_empty(begun);
  }));
  get("/api/state");
  EXPECT_TRUE(std::filesystem::is_empty(begun));
}

TEST_F(TechnicianPage, ALotIsSeenBesideItself) {
  EXPECT_EQ(asked("/api/lots", {}).status, 404);
  station::Library library(folder_ / "bench/library", true);
  for (const char* thread : {"silk_red.json", "silk_blue.json", "silk_gold.json"})
    library.add(std::filesystem::path(DATA_DIR) / "threads" / thread, "2026-11-21T10:20:30.123Z");
  for (const int number : {1, 2})
    library.edit(number,
                 {.barcode = "", .name = std::to_string(number), .lot = "A", .material = "", .colour = "", .note = ""});
  const json lots = json::parse(asked("/api/lots", {}).body);
  ASSERT_EQ(lots.size(), 1U);
  EXPECT_EQ(lots[0].at("numbers"), json({1, 2}));
  // Of two, each is about half of their difference from the mean.
  const double apart = json::parse(asked("/api/thread", {{"number", "1"}, {"with", "2"}}).body).at("delta_e_2000");
  EXPECT_GT(lots[0].at("largest_delta_e_2000").get<double>(), 0.25 * apart);
  EXPECT_LT(lots[0].at("mean_delta_e_2000").get<double>(), apart);
  EXPECT_EQ(lots[0].at("diameter_mm").size(), 2U);
}

// What is photographed with light from the front is the thread's colour, not what its model scatters.
TEST(ThreadsColour, IsThatOfThePhotographsBesideAWhiteCard) {
  station::ThreadFile thread = station::read_thread(std::string(DATA_DIR) + "/threads/silk_red.json");
  EXPECT_EQ(station::thread_document(thread).at("colour").at("of"), "model");
  thread.fit = json::parse(R"({"views": [
    {"id": "a", "relative_rmse": 0, "relative_bias": 0, "colour_over_diffuser": [0.1, 0.2, 0.4]},
    {"id": "b", "relative_rmse": 0, "relative_bias": 0, "colour_over_diffuser": [0.3, 0.2, 0.6]},
    {"id": "c", "relative_rmse": 0, "relative_bias": 0, "colour_over_diffuser": [9, 9, 9], "transmission": true}]})");
  const json colour = station::thread_document(thread).at("colour");
  EXPECT_EQ(colour.at("of"), "views");
  EXPECT_EQ(colour.at("srgb"), "#7c7cbc");  // 0.2, 0.2, 0.5 of white
  EXPECT_EQ(colour.at("clipped"), false);
  thread.fit["views"][0].erase("colour_over_diffuser");  // fitted before it was kept
  EXPECT_EQ(station::thread_document(thread).at("colour").at("of"), "model");
}

}  // namespace
}  // namespace station_test
