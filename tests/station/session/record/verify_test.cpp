#include "station/session/record/verify.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "station/documents/manifest.h"
#include "tests/station/session/capture/fakes.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class VerifyTest : public testing::Test {
 protected:
  void SetUp() override { fake.run(path, small_plan()); }

  std::vector<std::string> problems() const { return verify_session(path).problems; }

  void flip_bit(const std::string& name) const {
    std::string text = text_of(path / name);
    text[text.size() / 2] ^= 1;
    write_text(path / name, text);
  }

  TemporaryFolder folder;
  fs::path path = folder / "session";
  FakeStation fake;
};

TEST_F(VerifyTest, ACompleteSessionIsSound) {
  const VerifyReport report = verify_session(path);
  EXPECT_TRUE(report.sound());
  EXPECT_TRUE(report.complete);
  EXPECT_EQ(report.pictures, 7U);
  EXPECT_EQ(report.views, 3U);
  EXPECT_EQ(report.views_planned, 3U);
  EXPECT_EQ(report.files, 8U) << "six pictures (two darks are one), session.json, a calibration file";
  EXPECT_EQ(report.records, records_of(path).size());
}

TEST_F(VerifyTest, NamesAFlippedBitAMissingFileAndAnExtraOne) {
  flip_bit("raw/transmission-1.arw");
  EXPECT_THAT(problems(), ElementsAre("raw/transmission-1.arw differs from its journalled hash"));
  EXPECT_FALSE(verify_session(path).complete);
  fs::remove(path / "raw/transmission-1.arw");
  EXPECT_THAT(problems(), ElementsAre("raw/transmission-1.arw is missing"));
  write_text(path / "raw/cat.jpg", "cat");
  EXPECT_THAT(problems(), ElementsAre("raw/transmission-1.arw is missing", "raw/cat.jpg is not named in the journal"));
}

TEST_F(VerifyTest, ASessionThatHasJustBegunNamesItsMissingStepsInOneLine) {
  path = folder / "begun";
  fake.options.choose_exposure = nullptr;
  fake.options.stop_wish = [this] { return fake.camera.captures > 0 ? StopWish::pause : StopWish::none; };
  fake.camera.captures = 0;
  fake.run(path, small_plan());
  EXPECT_THAT(problems(), ElementsAre("6 steps have no picture: reflection-horizontal-1 to 2, transmission-1, "
                                      "dark-reflection-horizontal-1 to 2, dark-transmission-1; resume the session",
                                      "the session is paused, not complete; resume it"));
}

TEST_F(VerifyTest, APictureThatWasReplacedByALinkIsMissing) {
  fs::rename(path / "raw/transmission-1.arw", folder / "kept.arw");
  fs::create_symlink(folder / "kept.arw", path / "raw/transmission-1.arw");
  EXPECT_THAT(problems(), ElementsAre("raw/transmission-1.arw is missing"));
}

TEST_F(VerifyTest, NamesAChangedOrAddedCalibrationAndAChangedQuestion) {
  write_text(path / "calibration/calibration.json", "{\"changed\": 1}");
  write_text(path / "calibration/other.json", "{}");
  nlohmann::json session = nlohmann::json::parse(text_of(path / "session.json"));
  session["operator"] = "somebody else";
  write_text(path / "session.json", session.dump());
  EXPECT_THAT(problems(), ElementsAre("calibration/calibration.json differs from its journalled hash",
                                      "session.json differs from its journalled hash",
                                      "calibration/other.json is not named in the journal"));
}

TEST_F(VerifyTest, NamesTheLineOfAChangedJournal) {
  std::string text = text_of(path / "journal.jsonl");
  text[text.find("transmission-1")] = 'T';
  write_text(path / "journal.jsonl", text);
  EXPECT_THAT(problems().at(0), HasSubstr("does not match its checksum"));
}

TEST_F(VerifyTest, ATornJournalIsReportedAndNotChanged) {
  const std::string torn = text_of(path / "journal.jsonl") + "{\"seq\":";
  write_text(path / "journal.jsonl", torn);
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("torn line of 7 bytes")));
  EXPECT_EQ(text_of(path / "journal.jsonl"), torn);
}

TEST_F(VerifyTest, AnInterruptedSessionNamesWhatIsLeftToDo) {
  const fs::path second = folder / "second";
  FakeStation other;
  other.options.choose_exposure = nullptr;
  other.options.stop_wish = [&] { return other.camera.captures == 5 ? StopWish::pause : StopWish::none; };
  ASSERT_EQ(other.run(second, small_plan()), RunState::paused);
  const VerifyReport report = verify_session(second);
  EXPECT_THAT(report.problems, ElementsAre("2 steps have no picture: dark-reflection-horizontal-2, "
                                           "dark-transmission-1; resume the session",
                                           "the session is paused, not complete; resume it"));
  EXPECT_EQ(report.views, 3U);
  EXPECT_FALSE(report.complete);
}

TEST_F(VerifyTest, DerivedFilesAreCheckedWhereTheyHaveAManifest) {
  write_text(path / "linear/a.exr", "abc");
  EXPECT_TRUE(verify_session(path).sound()) << "they can be made again";
  FileSystem file_system;
  EXPECT_EQ(write_manifest(path / "linear", file_system), 1U);
  EXPECT_TRUE(verify_session(path).sound());
  write_text(path / "linear/a.exr", "abd");
  write_text(path / "linear/b.exr", "abc");
  EXPECT_THAT(problems(),
              ElementsAre("linear/a.exr differs from its manifest", "linear/b.exr is not named in the manifest"));
}

TEST_F(VerifyTest, AFolderThatIsNoSessionIsAnError) {
  EXPECT_THAT(message_of([&] { verify_session(folder / "nowhere"); }), HasSubstr("is no session"));
}

}  // namespace
}  // namespace station
