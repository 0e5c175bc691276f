#include "station/commands/ready_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "station/data/data_folder.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ReadyName : public testing::Test {
 protected:
  ReadyName() { station::or_ready("drafts", app_.add_option("--draft", drafts_)); }

  std::vector<std::string> parsed(const std::vector<std::string>& words) {
    std::vector<std::string> arguments(words.rbegin(), words.rend());  // as CLI11 takes them
    arguments.emplace_back("--draft");
    app_.parse(arguments);
    return drafts_;
  }
  std::string refused(const std::string& word) {
    try {
      parsed({word});
    } catch (const CLI::ValidationError& error) {
      return error.what();
    }
    return "";
  }

  CLI::App app_;
  std::vector<std::string> drafts_;
};

TEST_F(ReadyName, IsTheFileThatComesWithTheProgram) {
  const fs::path drafts = station::data_folder() / "drafts";
  EXPECT_THAT(parsed({"plain", "twill_2_2"}), testing::ElementsAre(drafts / "plain.json", drafts / "twill_2_2.json"));
  EXPECT_TRUE(fs::exists(drafts / "plain.json"));
}

TEST_F(ReadyName, GivesWayToWhatLiesHereAndToPaths) {
  const TemporaryFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  std::ofstream("plain") << "{}";
  EXPECT_THAT(parsed({"plain", "satin_5.json", "drafts/satin_5"}),
              testing::ElementsAre("plain", "satin_5.json", "drafts/satin_5"));
  fs::current_path(before);
}

TEST_F(ReadyName, ThatThereIsNotIsRefusedWithTheNearestOrWithAll) {
  EXPECT_THAT(refused("twil_2_2"), HasSubstr("no ready draft of that name; did you mean twill_2_2?"));
  EXPECT_THAT(refused("velvet"), testing::AllOf(HasSubstr("there is no file velvet and no ready draft"),
                                                HasSubstr("; ready ones: basket_2_2, herringbone, ")));
}

TEST_F(ReadyName, IsTakenByTheProgramAndRefusedInOneLine) {
  const ProgramResult result = run_threadstation({"weave", "--draft", "velvet", "--out", "x.json"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.error_lines(), 1) << result.error;
  EXPECT_THAT(result.error, testing::AllOf(HasSubstr("--draft"), HasSubstr("no ready draft")));
}

}  // namespace
}  // namespace station_test
