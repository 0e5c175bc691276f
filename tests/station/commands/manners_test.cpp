// What the program says and does where a person stops it or names what cannot be used.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;

// Runs the program and sends it ctrl-C as soon as it has said something on standard error; `out` is that and the rest.
ProgramResult interrupted(const fs::path& folder, const std::string& arguments) {
  const std::string pipe = folder / "pipe";
  return run_shell("mkfifo " + pipe + "; " + THREADSTATION_PROGRAM + " " + arguments + " > /dev/null 2> " + pipe +
                   " & program=$!; { read first; echo \"$first\"; kill -INT $program; cat; } < " + pipe +
                   "; wait $program; status=$?; rm " + pipe + "; exit $status");
}

TEST(CtrlC, EndsTheWeavingOfADraftAndLeavesNoPatch) {
  const TemporaryFolder folder;
  const fs::path patch = folder / "patch.json";
  const ProgramResult said =
      interrupted(folder.path(), "weave --draft " DATA_DIR "/drafts/slubbed_linen.json --out " + patch.string());
  EXPECT_EQ(said.status, 1) << said.out;
  EXPECT_NE(said.out.find("come to rest: step "), std::string::npos) << "it shows how far it is: " << said.out;
  EXPECT_NE(said.out.find("threadstation: the weaving was stopped on request; start it again\n"), std::string::npos)
      << said.out;
  EXPECT_FALSE(fs::exists(patch));
}

TEST(CtrlC, EndsARenderingWhileItsGarmentIsHung) {
  const TemporaryFolder folder;
  const ProgramResult said =
      interrupted(folder.path(), "render " DATA_DIR "/scenes/satin_drape.json --out " + (folder / "a.exr").string());
  EXPECT_EQ(said.status, 1) << said.out;
  EXPECT_NE(said.out.find("stopped on request"), std::string::npos) << said.out;
  EXPECT_FALSE(fs::exists(folder / "a.exr"));
}

void expect_one_line(const ProgramResult& said, const std::string& what) {
  EXPECT_NE(said.status, 0) << what;
  EXPECT_EQ(said.error_lines(), 1) << what << ": " << said.error;
  EXPECT_EQ(said.error.find("filesystem"), std::string::npos) << what << ": " << said.error;
  EXPECT_NE(said.error.find("; "), std::string::npos) << what << " says what to do: " << said.error;
}

// Every command that is given a folder or a file, with PLACE for it.
const std::vector<std::vector<std::string>> kUses{
    {"verify", "PLACE"},
    {"develop", "PLACE"},
    {"invert", "PLACE"},
    {"report", "PLACE"},
    {"replay", "PLACE", "--out", "PLACE/b"},
    {"capture", "--resume", "--out", "PLACE"},
    {"cloth", "PLACE", "--draft", DATA_DIR "/drafts/plain.json"},
    {"render", "PLACE", "--out", "PLACE/a.exr"},
    {"render", DATA_DIR "/scenes/plain_swatch.json", "--out", "PLACE/a.exr"},
    {"render", DATA_DIR "/scenes/plain_swatch.json", "--out", "PLACE"},
    {"weave", "--draft", "PLACE", "--out", "PLACE/a.json"},
    {"library", "list", "--library", "PLACE"},
    {"compare", "PLACE/a.exr", "PLACE/b.exr"},
    {"calibrate", "--solve", "--rig", DATA_DIR "/rigs/simulated.json", "--out", "PLACE"},
    {"calibrate", "--rig", DATA_DIR "/rigs/simulated.json", "--out", "PLACE"},
    {"check", "--rig", "PLACE"},
    {"target", "--rig", DATA_DIR "/rigs/simulated.json", "--out", "PLACE"},
    {"demo", "--out", "PLACE"},
    {"import", "--views", "PLACE", "--out", "PLACE/s"}};

std::vector<std::string> with_place(std::vector<std::string> words, const std::string& place) {
  for (std::string& word : words)
    if (word.starts_with("PLACE")) word.replace(0, 5, place);
  return words;
}

TEST(UnusablePlace, GivesOneLineThatSaysWhatToDo) {
  const TemporaryFolder folder;
  const fs::path round = folder / "round";
  fs::create_symlink(round, round);
  for (const auto& use : kUses) {
    const ProgramResult said = run_threadstation(with_place(use, round));
    expect_one_line(said, use.front());
    EXPECT_NE(said.error.find(round), std::string::npos) << use.front() << " names it: " << said.error;
  }
}

TEST(UnusablePlace, OfAnotherUserGivesOneLineThatSaysSo) {
  const TemporaryFolder folder;
  const fs::path closed = folder / "closed";
  fs::create_directories(closed / "session");
  fs::permissions(closed, fs::perms::none);
  // Nothing is closed to root.
  const std::string as_user = ::geteuid() == 0 ? "setpriv --reuid=65534 --regid=65534 --clear-groups " : "";
  fs::permissions(folder.path(), fs::perms::owner_all | fs::perms::others_exec | fs::perms::others_read);
  if (run_shell(as_user + "test -x " THREADSTATION_PROGRAM).status != 0)
    GTEST_SKIP() << "the program lies where user 65534 cannot run it";
  for (const auto& use : kUses) {
    std::string line = as_user + THREADSTATION_PROGRAM;
    for (const std::string& word : with_place(use, closed / "session")) line += " '" + word + "'";
    const ProgramResult said = run_shell(line);
    expect_one_line(said, use.front());
    EXPECT_NE(said.error.find(closed), std::string::npos) << use.front() << " names it: " << said.error;
  }
}

TEST(Umlaut, InANameIsEchoedAsItWasTyped) {
  const TemporaryFolder folder;
  const std::string name = "Grüne Seide Nr. 5, Straße";
  const auto says = [&](const std::vector<std::string>& words) {
    const ProgramResult said = run_threadstation(words);
    expect_one_line(said, words.front());
    EXPECT_NE(said.error.find(name), std::string::npos) << said.error;
  };
  says({"verify", folder / name});
  says({"render", folder / name, "--out", folder / "a.exr"});
  says({"capture", "--rig", DATA_DIR "/rigs/simulated.json", "--calibration", DATA_DIR "/calibrations/simulated.json",
        "--spool", folder / name, "--out", folder / "s"});
}

}  // namespace
}  // namespace station_test
