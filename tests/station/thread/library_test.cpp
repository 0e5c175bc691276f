// The collection of digitized threads.
#include "station/thread/library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "station/documents/manifest.h"
#include "tests/places.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
constexpr const char* kNow = "2026-11-21T10:20:30.123Z";

struct ThreadLibrary : testing::Test {
  static fs::path thread(const std::string& name) { return fs::path(DATA_DIR) / "threads" / (name + ".json"); }
  TemporaryFolder folder;
  fs::path place = folder / "library";
};

TEST_F(ThreadLibrary, KeepsWhatIsAddedAndFindsItByAnyOfItsTexts) {
  Library(place, true).add(thread("silk_blue"), kNow);
  Library(place, true).add(thread("silk_red"), kNow);
  const Library again(place, false);
  ASSERT_EQ(again.list().size(), 2U);
  ASSERT_EQ(again.list("RED").size(), 1U);
  EXPECT_EQ(again.list("red").front().number, 2);
  EXPECT_EQ(again.list("o'brien; DROP TABLE threads").size(), 0U);
  EXPECT_EQ(again.show(2).added_utc, kNow);
  EXPECT_THAT(message_of([&] { again.show(3); }), HasSubstr("no thread number 3"));
}

TEST_F(ThreadLibrary, RefusesWhatItHasAlreadyAndWhatIsNoThread) {
  Library library(place, true);
  library.add(thread("silk_blue"), kNow);
  EXPECT_THAT(message_of([&] { library.add(thread("silk_blue"), kNow); }), HasSubstr("already, as number 1"));
  EXPECT_THAT(message_of([&] { library.add(fs::path(DATA_DIR) / "spools/silk_red.json", kNow); }),
              HasSubstr("threadstation/thread"));
  EXPECT_EQ(library.list().size(), 1U);
  EXPECT_THAT(message_of([&] { Library(folder / "none", false); }), HasSubstr("no library"));
  write_text(folder / "letter.txt", "not ours");
  EXPECT_THAT(message_of([&] { Library((folder / "letter.txt").parent_path(), true); }), HasSubstr("other files"));
}

// A flipped bit is not passed on.
TEST_F(ThreadLibrary, ExportsTheFileAsItWasAddedOrNothing) {
  Library library(place, true);
  library.add(thread("silk_blue"), kNow);
  library.export_thread(1, folder / "out");
  EXPECT_EQ(text_of(folder / "out/thread.json"), text_of(thread("silk_blue")));
  EXPECT_THAT(check_manifest(folder / "out").problems, testing::IsEmpty());
  EXPECT_THAT(message_of([&] { library.export_thread(1, folder / "out"); }), HasSubstr("not an empty folder"));
  std::string text = text_of(library.thread_file(1));
  text[text.size() / 2] = static_cast<char>(text[text.size() / 2] ^ 1);
  write_text(library.thread_file(1), text);
  EXPECT_THAT(message_of([&] { library.export_thread(1, folder / "other"); }),
              HasSubstr("not the file that was added"));
  EXPECT_FALSE(fs::exists(folder / "other"));
}

TEST_F(ThreadLibrary, ADamagedIndexIsOneClearLine) {
  Library(place, true).add(thread("silk_blue"), kNow);
  write_text(place / "index.sqlite", "this is no data base, it only looks like one from afar ............");
  EXPECT_THAT(message_of([&] {
                Library library(place, false);
                library.list();
              }),
              HasSubstr("index.sqlite"));
}

}  // namespace
}  // namespace station
