// The collection of digitized threads.
#include "station/thread/library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <random>

#include "station/documents/manifest.h"
#include "station/documents/reader.h"
#include "station/documents/thread_file.h"
#include "station/thread/thread_colour.h"
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

// Threads drawn at random, found by colour, by number and by words, as a plain search through their files finds them.
TEST_F(ThreadLibrary, FindsByColourAndNumbersWhatASearchThroughAllFilesFinds) {
  constexpr unsigned kSeed = 20261130;
  constexpr int kThreads = 60;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<> any(0, 1);
  Library library(place, true);
  std::vector<ThreadFile> files;
  for (int i = 0; i < kThreads; ++i) {
    ThreadFile one = read_thread(thread("silk_red"));
    one.fit = nlohmann::json::object();  // its colour is the model's then
    one.name = i % 3 == 0 ? "Linen " + std::to_string(i) : "cotton " + std::to_string(i);
    for (double& sigma : one.parameters.sigma_a) sigma = 3 * any(random) * any(random);
    one.parameters.alpha[0] = 0.1 + 0.4 * any(random);
    one.diameter_mm = 0.1 + any(random);
    write_json_file(folder / "one.json", to_json(one));
    library.add(folder / "one.json", kNow);
    files.push_back(read_thread(folder / "one.json"));
  }
  for (int search = 0; search < 20; ++search) {
    const Eigen::Vector3d wanted = colour_of(files[static_cast<std::size_t>(search)]).lab + Eigen::Vector3d(3, -2, 4);
    const LibraryQuery query{.words = search % 2 == 0 ? "linen" : "",
                             .near_lab = wanted,
                             .within = 25,
                             .diameter_mm = std::array{0.3, 0.9},
                             .highlight_rad = std::array{0.1, 0.4}};
    std::vector<std::pair<double, int>> expected;
    for (int i = 0; i < kThreads; ++i) {
      const ThreadFile& file = files[static_cast<std::size_t>(i)];
      const double distance = (colour_of(file).lab - wanted).norm();
      if ((query.words.empty() || i % 3 == 0) && distance <= 25 && file.diameter_mm >= 0.3 && file.diameter_mm <= 0.9 &&
          file.parameters.alpha[0] <= 0.4)
        expected.emplace_back(distance, i + 1);
    }
    std::ranges::sort(expected);
    const std::vector<LibraryThread> found = library.find(query);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].number, expected[i].second);
      EXPECT_NEAR(found[i].distance.value(), expected[i].first, 1e-9);
    }
    if (expected.size() > 2) EXPECT_EQ(library.find({.near_lab = wanted, .within = 25, .most = 2}).size(), 2U);
  }
}

TEST_F(ThreadLibrary, EditsTheSampleOfOneThreadOnly) {
  Library library(place, true);
  library.add(thread("silk_blue"), kNow);
  library.add(thread("silk_red"), kNow);
  Sample sample = library.show(1).sample;
  sample.barcode = "4006381333948";
  sample.lot = "B 7";
  EXPECT_EQ(library.edit(1, sample).sample.lot, "B 7");
  EXPECT_EQ(library.list("b 7").size(), 1U);
  EXPECT_EQ(library.show(2).sample.lot, "");
  EXPECT_EQ(text_of(library.thread_file(1)), text_of(thread("silk_blue"))) << "the file stays as it was added";
  EXPECT_THAT(message_of([&] { library.edit(1, {}); }), HasSubstr("neither name nor barcode"));
  EXPECT_THAT(message_of([&] { library.edit(3, sample); }), HasSubstr("no thread number 3"));
}

TEST_F(ThreadLibrary, HasTagsOfTheLabsOwnByWhichThreadsAreFound) {
  Library library(place, true);
  library.add(thread("silk_blue"), kNow);
  library.add(thread("silk_red"), kNow);
  library.tag(2, tags_of(" summer, Sari 4,, summer ,"));
  EXPECT_THAT(Library(place, false).show(2).tags, testing::ElementsAre("summer", "Sari 4"));
  ASSERT_EQ(library.list("sari").size(), 1U);
  EXPECT_EQ(library.list("sari").front().number, 2);
  EXPECT_THAT(library.tag(2, {}).tags, testing::IsEmpty());
  EXPECT_EQ(library.list("sari").size(), 0U);
  EXPECT_THAT(message_of([&] { tags_of(std::string(41, 'x')); }), HasSubstr("40 characters"));
  std::string many;
  for (int i = 0; i < 21; ++i) many += std::to_string(i) + ",";
  EXPECT_THAT(message_of([&] { tags_of(many); }), HasSubstr("21 tags"));
}

TEST_F(ThreadLibrary, TakesOutAndPutsBackWithoutLosingAnything) {
  Library library(place, true);
  library.add(thread("silk_blue"), kNow);
  library.add(thread("silk_red"), kNow);
  library.remove(1, kNow);
  ASSERT_EQ(library.list().size(), 1U);
  EXPECT_EQ(library.list().front().number, 2);
  EXPECT_THAT(message_of([&] { library.remove(1, kNow); }), HasSubstr("out of the library"));
  EXPECT_THAT(message_of([&] { library.add(thread("silk_blue"), kNow); }), HasSubstr("library restore 1"));
  library.restore(1);
  EXPECT_EQ(library.list().size(), 2U);
  EXPECT_THAT(message_of([&] { library.restore(1); }), HasSubstr("in the library"));
  library.export_thread(1, folder / "out");
}

// Libraries as they were made before threads could be taken out, before there were tags and before colours.
TEST_F(ThreadLibrary, ReadsThoseOfTheVersionsBefore) {
  std::string without_measures;
  for (const char* column : {"lab_l", "lab_a", "lab_b", "highlight_rad"})
    without_measures += std::string("ALTER TABLE threads DROP COLUMN ") + column + "; ";
  const std::string without_tags = without_measures + "ALTER TABLE threads DROP COLUMN tags; ",
                    without_removed = without_tags + "ALTER TABLE threads DROP COLUMN removed_utc; ";
  for (const std::string& before :
       {without_removed + "PRAGMA user_version = 1", without_tags + "PRAGMA user_version = 2",
        without_measures + "PRAGMA user_version = 3"}) {
    fs::remove_all(place);
    Library(place, true).add(thread("silk_blue"), kNow);
    sqlite3* index = nullptr;
    ASSERT_EQ(sqlite3_open((place / "index.sqlite").c_str(), &index), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(index, before.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << before;
    sqlite3_close(index);
    Library library(place, false);
    ASSERT_EQ(library.list().size(), 1U);
    const Eigen::Vector3d lab = colour_of(read_thread(thread("silk_blue"))).lab;
    EXPECT_EQ(library.find({.near_lab = lab, .within = 0.01}).size(), 1U) << "measured when it is asked for";
    EXPECT_EQ(library.tag(1, {"old"}).tags.size(), 1U);
    library.remove(1, kNow);
    EXPECT_EQ(Library(place, false).list().size(), 0U);
  }
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
