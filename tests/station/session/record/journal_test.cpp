#include "station/session/record/journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "station/documents/disk/sha256.h"
#include "tests/station/session/capture/fakes.h"

namespace station {
namespace {

using testing::HasSubstr;

class JournalTest : public testing::Test {
 protected:
  Journal open() { return Journal(file, clock, disk); }

  void write_three() {
    Journal journal = open();
    for (int i = 1; i <= 3; ++i) journal.append("picture", {{"number", i}});
  }

  TemporaryFolder folder;
  std::filesystem::path file = folder / "journal.jsonl";
  rig::SimulatedClock clock{1.8e9};
  FakeFileSystem disk;
};

TEST_F(JournalTest, KeepsItsRecords) {
  write_three();
  const JournalText text = read_journal(file);
  ASSERT_EQ(text.records.size(), 3U);
  EXPECT_EQ(text.torn_bytes, 0U);
  EXPECT_EQ(text.records[1].seq, 2U);
  EXPECT_EQ(text.records[1].event, "picture");
  EXPECT_EQ(text.records[1].data, nlohmann::json({{"number", 2}}));
  EXPECT_EQ(text.records[1].utc, clock.utc());
}

TEST_F(JournalTest, GoesOnWhereItEnded) {
  write_three();
  open().append("resume", nlohmann::json::object());
  EXPECT_EQ(read_journal(file).records.back().seq, 4U);
}

// The recipe of journal.h, without the code that it describes.
TEST_F(JournalTest, CanBeCheckedByAnotherProgram) {
  write_three();
  std::istringstream lines(text_of(file));
  std::string previous(64, '0');
  for (std::string line; std::getline(lines, line);) {
    const std::size_t cut = line.rfind(",\"sha256\":\"");
    const auto digits = nlohmann::json::parse(line).at("sha256").get<std::string>();
    EXPECT_EQ(sha256_hex(previous + line.substr(0, cut)), digits);
    previous = digits;
  }
}

TEST_F(JournalTest, CutsATornLastLineWhereverItWasTornAndSaysSo) {
  write_three();
  const std::string whole = text_of(file);
  const std::size_t second_end = whole.find('\n', whole.find('\n') + 1) + 1;
  for (std::size_t size = second_end + 1; size < whole.size(); ++size) {
    write_text(file, whole.substr(0, size));
    EXPECT_EQ(read_journal(file).torn_bytes, size - second_end);
    const Journal journal = open();
    ASSERT_EQ(journal.records().size(), 3U);
    EXPECT_EQ(journal.records().back().event, "cut");
    EXPECT_EQ(journal.records().back().data.at("bytes"), size - second_end);
    EXPECT_EQ(read_journal(file).records.size(), 3U) << "what the cut left is a sound journal";
  }
}

TEST_F(JournalTest, CutsALastLineWithAWrongChecksum) {
  write_three();
  std::string text = text_of(file);
  text[text.size() - 10] ^= 1;
  write_text(file, text);
  EXPECT_EQ(open().records().back().event, "cut");
}

TEST_F(JournalTest, AFlippedBitInAnEarlierLineIsAnErrorThatNamesTheLine) {
  write_three();
  const std::string whole = text_of(file);
  const std::size_t begin = whole.find('\n') + 1, end = whole.find('\n', begin);
  for (std::size_t at = begin; at < end; ++at) {
    std::string text = whole;
    text[at] ^= 4;  // never makes a newline from what stands in a line
    write_text(file, text);
    EXPECT_THAT(message_of([&] { open(); }), HasSubstr("line 2 ")) << at - begin;
  }
}

TEST_F(JournalTest, ARemovedLineIsNoticed) {
  write_three();
  const std::string whole = text_of(file);
  write_text(file, whole.substr(whole.find('\n') + 1));
  EXPECT_THAT(message_of([&] { open(); }), HasSubstr("line 1 "));
}

// A line as journal.h describes it, the first of its file.
std::string first_line(const std::string& content) {
  std::string line = content;
  line += R"(,"sha256":")" + sha256_hex(std::string(64, '0') + content) + "\"}\n";
  return line;
}

TEST_F(JournalTest, ALineThatChecksButIsNotTheNextRecordIsAnErrorEvenAtTheEnd) {
  const std::string record = R"(,"utc":"2027-01-15T08:00:00.000Z","event":"stop","data":{})";
  write_text(file, first_line(R"({"seq":1)" + record));
  EXPECT_EQ(open().records().size(), 1U);
  write_text(file, first_line(R"({"seq":2)" + record));
  EXPECT_THAT(message_of([&] { open(); }), HasSubstr("line 1 counts 2"));
  write_text(file, first_line(R"({"number":1)"));
  EXPECT_THAT(message_of([&] { open(); }), HasSubstr("line 1 is not a record"));
}

TEST_F(JournalTest, AFailedAppendLeavesTheJournalAsItWas) {
  Journal journal = open();
  journal.append("start", nlohmann::json::object());
  const std::string before = text_of(file);
  disk.trouble = FakeFileSystem::Trouble::fail_once;
  disk.error = ENOSPC;
  for (const int call : {1, 2}) {  // write, sync
    disk.at_call = disk.calls + call;
    EXPECT_THAT(message_of([&] { journal.append("picture", {{"n", 1}}); }), HasSubstr("No space left on device"));
    EXPECT_EQ(text_of(file), before);
  }
  journal.append("stop", nlohmann::json::object());
  EXPECT_EQ(read_journal(file).records.size(), 2U);
}

TEST_F(JournalTest, AcceptsAMessageThatIsNotText) {
  open().append("stop", {{"message", "device said \xff\xfe"}});
  EXPECT_EQ(read_journal(file).records.size(), 1U);
}

}  // namespace
}  // namespace station
