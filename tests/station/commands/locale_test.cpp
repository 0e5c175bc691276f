// Where numbers are written with a comma: the same files as anywhere else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace {

namespace fs = std::filesystem;
using station_test::ProgramResult;
using station_test::run_shell;
using station_test::TemporaryFolder;

const std::string kFixtures = FIXTURES_DIR, kData = DATA_DIR;

// German is not set up on every computer: made here from its source, with the package `locales`.
struct Locale : testing::Test {
  static void SetUpTestSuite() {
    folder = new TemporaryFolder;
    const ProgramResult made = run_shell("localedef -i de_DE -f UTF-8 '" + (*folder / "de_DE.UTF-8").string() + "'");
    ASSERT_EQ(made.status, 0) << made.error;
    german = "LOCPATH='" + folder->path().string() + "' LC_ALL=de_DE.UTF-8 ";
  }
  static void TearDownTestSuite() { delete folder; }

  static std::string in_german(const std::string& command) { return german + command; }

  // The same command in both; `%` is the folder that it works in.
  static void run(const std::string& arguments) {
    for (const char* name : {"c", "german"}) {
      fs::create_directories(*folder / name);
      std::string words = arguments;
      for (std::size_t at = 0; (at = words.find('%')) != std::string::npos;)
        words.replace(at, 1, (*folder / name).string());
      const std::string prefix = name == std::string("c") ? "LC_ALL=C " : german;
      const ProgramResult result = run_shell(prefix + "'" THREADSTATION_PROGRAM "' " + words);
      EXPECT_EQ(result.status, 0) << prefix << words << "\n" << result.error;
      said[name] += without(result.out, (*folder / name).string());
    }
  }

  static std::string without(std::string text, const std::string& word) {
    for (std::size_t at = 0; (at = text.find(word)) != std::string::npos;) text.erase(at, word.size());
    return text;
  }

  static std::map<std::string, std::string> files(const std::string& name) {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(*folder / name)) {
      std::ifstream in(entry.path(), std::ios::binary);
      if (entry.is_regular_file() && entry.path().filename() != ".lock")  // whose process it was
        found[fs::relative(entry.path(), *folder / name)] = {std::istreambuf_iterator<char>(in), {}};
    }
    return found;
  }

  static inline TemporaryFolder* folder = nullptr;
  static inline std::string german;
  static inline std::map<std::string, std::string> said;
};

TEST_F(Locale, OfThisTestWritesNumbersWithAComma) {
  EXPECT_EQ(run_shell(in_german("/usr/bin/printf %.1f 1")).out, "1,0");
}

TEST_F(Locale, ChangesNothingThatIsWritten) {
  run("plan --rig '" + kData + "/rigs/simulated.json' --out %/plan.json");
  run("weave --draft '" + kData + "/drafts/plain.json' --out %/patch.json --drawing %/draft.svg");
  run("scatter simulate --fiber-radius 0.05 --thread-radius 1 --gap 0.01 --attempts 2000 --rays 2000 "
      "--configurations 2 --bins 88 --seed 3 --quiet --out %/simulated.csv");
  const std::string queries = *folder / "queries.csv";
  std::ofstream(queries) << "h,theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad\n0.25,0.1,0.5,-0.2,2.75\n";
  run("scatter eval --model fiber --parameters '" + kData + "/fibers/clear.json' --in '" + queries +
      "' --out %/values.csv");
  run("replay '" + kFixtures + "/sessions/silk_red' --out %/session --quiet");
  run("develop %/session --quiet");
  run("verify %/session");
  run("report %/session");
  const auto expected = files("c"), found = files("german");
  EXPECT_GT(expected.size(), 60U);
  for (const auto& [name, bytes] : expected) {
    ASSERT_TRUE(found.contains(name)) << name;
    EXPECT_TRUE(found.at(name) == bytes) << name << " differs";
  }
  EXPECT_EQ(found.size(), expected.size());
  EXPECT_EQ(said.at("german"), said.at("c"));
}

}  // namespace
