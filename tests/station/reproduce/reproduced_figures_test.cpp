// Numbers of the paper's figures as `reproduce --quick` makes them, beside those that are stored with the figures. Only
// what is made within a minute is made here.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/places.h"
#include "tests/station/commands/help.h"
#include "tests/station/commands/program.h"

namespace {

TEST(ReproducedFigures, HaveTheStoredNumbers) {
  const station_test::TemporaryFolder folder;
  // The example of help, and with it what else takes less than a minute.
  std::string example = station_test::example_of({"reproduce"});
  ASSERT_TRUE(example.starts_with("threadstation ")) << example;
  ASSERT_NE(example.find(" 5 "), example.npos) << example;
  example.replace(example.find(" 5 "), 3, " 5 12 13 ");
  const auto made = station_test::run_shell("cd '" + folder.path().string() + "' && '" THREADSTATION_PROGRAM "'" +
                                            example.substr(std::string("threadstation").size()) + " --json");
  ASSERT_EQ(made.status, 0) << made.error;
  int compared = 0;
  const nlohmann::json page = nlohmann::json::parse(made.out);
  for (const nlohmann::json& figure : page.at("figures"))
    for (const nlohmann::json& number : figure.at("numbers")) {
      if (!number.contains("stored")) continue;
      ASSERT_TRUE(number.at("value").is_number()) << number.dump();
      EXPECT_NEAR(number.at("value").get<double>(), number.at("stored").get<double>(),
                  number.at("within").get<double>())
          << number.at("name");
      ++compared;
    }
  EXPECT_EQ(compared, 4 + 2 + 1);
}

}  // namespace
