// Numbers of the paper's figures as `reproduce --quick` makes them, beside those that are stored with the figures. Only
// what is made within a minute is made here.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/station/commands/program.h"

namespace {

TEST(ReproducedFigures, HaveTheStoredNumbers) {
  const station_test::TemporaryFolder folder;
  const auto made = station_test::run_threadstation({"reproduce", "5", "--quick", "--json", "--out", folder / "out"});
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
  EXPECT_GE(compared, 4);
}

}  // namespace
