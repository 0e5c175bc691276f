// A test fixture: a technician's page without a network, on a simulated rig with a person at it and a workspace of its
// own.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "station/documents/reader.h"
#include "station/serve/technician_page.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {

using nlohmann::json;
using station::HttpRequest;
using station::HttpResponse;

class TechnicianPage : public testing::Test {
 protected:
  explicit TechnicianPage(const json& changes = {{"operator", "console"}}) {
    json rig = station::read_json_file(std::string(DATA_DIR) + "/rigs/simulated.json");
    rig.merge_patch(changes);
    std::ofstream(folder_ / "rig.json") << rig.dump();
    page_ = std::make_unique<station::TechnicianPage>(
        folder_ / "rig.json", folder_ / "bench", [this] { ++changes_; }, THREADSTATION_PROGRAM);
  }

  HttpResponse post(const std::string& path, const json& fields) {
    const HttpRequest request{.method = "POST", .path = path, .body = fields.dump()};
    if (auto urgent = page_->urgent(request)) return *urgent;
    return page_->handle(request);
  }
  HttpResponse asked(const std::string& path, const std::map<std::string, std::string>& query = {}) {
    return page_->handle({.method = "GET", .path = path, .query = query});
  }
  json get(const std::string& path, const std::string& name = "") {
    return json::parse(asked(path, name.empty() ? std::map<std::string, std::string>{}
                                                : std::map<std::string, std::string>{{"name", name}})
                           .body);
  }
  int refused_with(const std::string& path, const json& fields) {
    const HttpResponse response = post(path, fields);
    EXPECT_FALSE(json::parse(response.body).at("message").get<std::string>().empty());
    return response.status;
  }
  void copy_session() {
    std::filesystem::copy(std::string(FIXTURES_DIR) + "/sessions/silk_red", folder_ / "bench/sessions/silk_red",
                          std::filesystem::copy_options::recursive);
  }
  json job() { return get("/api/state").at("job"); }

  template <class Condition>
  bool eventually(const Condition& condition) {
    for (int i = 0; i < 2400; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }
  HttpResponse answer(const json& question, const std::string& chosen) {
    return post("/api/answer", {{"client", "me"}, {"question", question.at("id")}, {"answer", chosen}});
  }
  void start_calibration() {
    EXPECT_EQ(post("/api/control", {{"client", "me"}}).status, 200);
    const HttpResponse started = post("/api/job", {{"client", "me"}, {"kind", "calibrate"}, {"name", "monday"}});
    ASSERT_EQ(started.status, 200) << started.body;
    ASSERT_TRUE(eventually([&] { return !job().at("question").is_null(); })) << job().dump(1);
  }

  // Does all that the job asks until it ends; the texts of its questions.
  std::vector<std::string> attend(const json& fields) {
    std::vector<std::string> texts;
    const HttpResponse started = post("/api/job", fields);
    EXPECT_EQ(started.status, 200) << started.body;
    for (json state; eventually([&] { return !(state = job()).at("question").is_null() || !state.at("running"); });) {
      if (!state.at("running")) break;
      texts.push_back(state.at("question").at("text"));
      EXPECT_EQ(answer(state.at("question"), "done").status, 200);
    }
    EXPECT_EQ(job().at("status"), 0) << job().dump(1);
    return texts;
  }

  TemporaryFolder folder_;
  std::atomic<int> changes_ = 0;
  std::unique_ptr<station::TechnicianPage> page_;
};

// A rig whose platform a person turns, while the simulated hand does all else.
class TurnedByHand : public TechnicianPage {
 protected:
  TurnedByHand()
      : TechnicianPage(
            {{"turntable", "manual"}, {"simulation", {{"samples_per_pixel", 2}, {"target_samples_per_pixel", 4}}}}) {
    post("/api/control", {{"client", "me"}});
  }
};

}  // namespace station_test
