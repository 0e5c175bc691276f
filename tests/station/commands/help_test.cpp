// What a person is told who does not know the program: --help, --version, the words that a shell completes, and what
// was meant by a word that was typed wrong.
#include "tests/station/commands/help.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "station/commands/nearest_word.h"
#include "station/documents/session_file.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(Help, PutsTheCommandsIntoGroupsByWhatOneWantsToDo) {
  std::vector<std::string> headings;
  for (const ListedCommand& command : listed_below({}))
    if (headings.empty() || headings.back() != command.heading) headings.push_back(command.heading);
  EXPECT_THAT(headings, ElementsAre("See what it does", "Set up a bench", "Photograph spools", "Digitize threads",
                                    "Predict cloth", "Use them in other programs", "Study the models", "Many at once",
                                    "Use this program"))
      << "a command that guide.cpp does not name stands under a heading of CLI11";
}

// examples_test.cpp runs them.
TEST(Help, GivesAnExampleOfEachCommand) {
  const std::vector<Words> commands = every_command();
  EXPECT_GT(commands.size(), 40U);
  for (const Words& command : commands) {
    const bool only_a_heading =
        help_of(command).find("Usage: threadstation " + joined(command) + " [OPTIONS] SUBC") != std::string::npos;
    if (!only_a_heading)
      EXPECT_THAT(example_of(command), testing::StartsWith("threadstation " + joined(command)))
          << joined(command) << ": name it in guide.cpp";
  }
}

TEST(Help, HasNoNotesToProgrammers) {
  std::vector<Words> commands = every_command();
  commands.emplace_back();
  for (const Words& command : commands) {
    const std::string help = help_of(command);
    for (const char* note : {"ENUM", "{", "->", "TEXT:", "INT", "FLOAT", "POSITIVE", "Subcommands", "DATA/"})
      EXPECT_THAT(help, Not(HasSubstr(note))) << joined(command);
  }
}

TEST(Help, NamesTheWordsAndTheRangeThatAnOptionTakes) {
  EXPECT_THAT(help_of({"target"}), HasSubstr("--paper a4|letter"));
  EXPECT_THAT(help_of({"invert"}), HasSubstr("--solver lm|adam"));
  EXPECT_THAT(help_of({"invert"}), HasSubstr("--model bundle|fiber|thread|yarn"));
  EXPECT_THAT(help_of({"render"}), HasSubstr("--threads NUMBER (0 to 4096)"));
  EXPECT_THAT(help_of({"render"}), HasSubstr("--out TEXT (needed)"));
  EXPECT_THAT(help_of({"render"}), HasSubstr("  --png                       a PNG beside"));  // flags take nothing
  EXPECT_THAT(help_of({"invert"}), HasSubstr("  --eq6 "));
}

TEST(Version, IsOneLineWithTheNameOfTheProgram) {
  const ProgramResult result = run_threadstation({"--version"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out, station::software_version() + "\n");
  EXPECT_THAT(result.out, testing::MatchesRegex("threadstation [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(UnknownWord, IsAnsweredWithTheNearestKnownOne) {
  const auto expect_answer = [](const Words& typed, const std::string& answer) {
    const ProgramResult result = run_threadstation(typed);
    EXPECT_EQ(result.status, 2) << joined(typed);
    EXPECT_EQ(result.error, "threadstation: " + answer + "\n");
  };
  expect_answer({"rendr", "scene.json"}, "rendr: did you mean render?");
  expect_answer({"scater", "fit"}, "scater: did you mean scatter?");
  expect_answer({"scatter", "eavl"}, "eavl: did you mean eval?");
  expect_answer({"render", "scene.json", "--ot", "x.png"}, "--ot: did you mean --out?");
  expect_answer({"render", "scene.json", "--otu=x.png"}, "--otu: did you mean --out?");
  expect_answer({"xylophone"}, "xylophone is not known here; threadstation --help lists what is");
  expect_answer({"library", "burn"}, "burn is not known here; threadstation library --help lists what is");
}

TEST(UnknownWord, IsNotBlamedWhereSomethingElseIsWrong) {
  const ProgramResult result = run_threadstation({"target", "--paper", "a5", "--out", "x"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.error, HasSubstr("a5"));
  EXPECT_THAT(result.error, Not(HasSubstr("did you mean")));
}

TEST(TypingDistance, CountsLettersTypedLeftOutChangedOrExchanged) {
  EXPECT_EQ(station::typing_distance("render", "render"), 0);
  EXPECT_EQ(station::typing_distance("rendr", "render"), 1);
  EXPECT_EQ(station::typing_distance("rendder", "render"), 1);
  EXPECT_EQ(station::typing_distance("tender", "render"), 1);
  EXPECT_EQ(station::typing_distance("erndre", "render"), 2);
  EXPECT_EQ(station::typing_distance("", "render"), 6);
}

class Completion : public testing::Test {
 protected:
  // The words that bash offers after those, the last of which is being typed.
  std::vector<std::string> in_bash(const Words& typed) {
    return lines_of(
        "bash -c '. \"$1\"; shift; COMP_WORDS=(threadstation \"$@\"); COMP_CWORD=$#; _threadstation; "
        "printf \"%s\\n\" \"${COMPREPLY[@]}\"' ",
        "bash", typed);
  }
  // Those that zsh is given to choose from; FILES where it takes a file.
  std::vector<std::string> in_zsh(const Words& typed) {
    return lines_of(
        "zsh -fc '_describe() { print -l -- ${${(P)2}%%:*} }; _files() { print FILES }; script=$1; shift; "
        "words=(threadstation \"$@\"); CURRENT=$#words; . $script' ",
        "zsh", typed);
  }

 private:
  std::vector<std::string> lines_of(const std::string& shell, const std::string& language, const Words& typed) {
    const TemporaryFolder folder;
    const std::filesystem::path script = folder / "script";
    std::ofstream(script) << run_threadstation({"completion", language}).out;
    std::string line = shell + language + " '" + script.string() + "'";
    for (const std::string& word : typed) line += " '" + word + "'";
    const ProgramResult result = run_shell(line);
    EXPECT_EQ(result.error, "") << joined(typed);
    std::vector<std::string> words;
    std::istringstream lines(result.out);
    for (std::string word; std::getline(lines, word);)
      if (!word.empty()) words.push_back(word);
    return words;
  }
};

TEST_F(Completion, OfBashKnowsCommandsTheirOptionsAndTheWordsOfThese) {
  EXPECT_THAT(in_bash({"ren"}), ElementsAre("render"));
  EXPECT_THAT(in_bash({"scatter", "e"}), ElementsAre("eval", "exits"));
  EXPECT_THAT(in_bash({"render", "scene.json", "--sp"}), ElementsAre("--spp"));
  EXPECT_THAT(in_bash({"target", "--paper", ""}), ElementsAre("a4", "letter"));
  EXPECT_THAT(in_bash({"scatter", "eval", "--model", "y"}), ElementsAre("yarn"));
  EXPECT_THAT(in_bash({"render", "sc"}), IsEmpty());  // then bash offers files
}

TEST_F(Completion, OfZshKnowsTheSame) {
  EXPECT_THAT(in_zsh({"ren"}), testing::Contains("render"));
  EXPECT_THAT(in_zsh({"scatter", "e"}), ElementsAre("simulate", "fit", "eval", "plot", "prior", "exits"));
  EXPECT_THAT(in_zsh({"render", "scene.json", "--sp"}), testing::Contains("--spp"));
  EXPECT_THAT(in_zsh({"target", "--paper", ""}), ElementsAre("a4", "letter"));
  EXPECT_THAT(in_zsh({"render", "sc"}), ElementsAre("FILES"));
}

TEST_F(Completion, OffersEveryListedCommandAndNoOther) {
  std::vector<std::string> listed;
  for (const ListedCommand& command : listed_below({})) listed.push_back(command.name);
  EXPECT_THAT(in_bash({""}), testing::UnorderedElementsAreArray(listed));
}

}  // namespace
}  // namespace station_test
