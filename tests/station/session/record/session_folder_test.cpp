#include "station/session/record/session_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "station/documents/disk/folder_lock.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "tests/station/session/capture/fakes.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

class SessionFolderTest : public testing::Test {
 protected:
  TemporaryFolder folder;
  fs::path path = folder / "session";
  FakeStation fake;
};

TEST_F(SessionFolderTest, HasWhatArchitectureSays) {
  fake.create(path, small_plan());
  for (const char* name : {"raw", "calibration", "linear", "masks", "result"})
    EXPECT_TRUE(fs::is_directory(path / name)) << name;
  EXPECT_EQ(nlohmann::json::parse(text_of(path / "session.json")), session_document(small_plan()));
  EXPECT_EQ(text_of(path / "calibration/calibration.json"), "{}");
  EXPECT_TRUE(fs::exists(path / "journal.jsonl"));
}

TEST_F(SessionFolderTest, IsNotMadeWhereASessionOrOtherFilesAre) {
  fake.create(path, small_plan());
  EXPECT_THAT(message_of([&] { fake.create(path, small_plan()); }), HasSubstr("is a session already; resume it"));

  fs::create_directory(folder / "photos");
  write_text(folder / "photos/cat.jpg", "cat");
  EXPECT_THAT(message_of([&] { fake.create(folder / "photos", small_plan()); }), HasSubstr("holds other files"));

  write_text(folder / "note", "text");
  EXPECT_THAT(message_of([&] { fake.create(folder / "note", small_plan()); }), HasSubstr("is a file"));
  EXPECT_THAT(message_of([&] { fake.create(folder / "note" / "inside", small_plan()); }), HasSubstr("could not write"));
}

TEST_F(SessionFolderTest, RefusesNamesThatAreNotPlain) {
  EXPECT_THAT(message_of([&] { fake.create(folder / "CON", small_plan()); }), HasSubstr("Windows"));
  SessionFolder session = fake.create(path, small_plan());
  EXPECT_THAT(message_of([&] { session.store_picture("../../x", bytes_of("x")); }), HasSubstr("'../../x'"));
}

TEST_F(SessionFolderTest, OfAnotherFolderIsNotOpened) {
  EXPECT_THAT(message_of([&] { fake.open(folder / "nowhere"); }), HasSubstr("is no session"));
  fake.create(path, small_plan());
  fs::remove_all(path / "raw");
  EXPECT_THAT(message_of([&] { fake.open(path); }), HasSubstr("has no folder raw/"));
}

TEST_F(SessionFolderTest, DoesNotFollowALinkInThePlaceOfItsPictures) {
  fake.create(path, small_plan());
  fs::remove_all(path / "raw");
  fs::create_directory(folder / "elsewhere");
  fs::create_directory_symlink(folder / "elsewhere", path / "raw");
  EXPECT_THAT(message_of([&] { fake.open(path); }), HasSubstr("has no folder raw/"));
}

TEST_F(SessionFolderTest, DoesNotWriteItsJournalThroughALink) {
  fake.create(path, small_plan());
  fs::rename(path / "journal.jsonl", folder / "elsewhere");
  fs::create_symlink(folder / "elsewhere", path / "journal.jsonl");
  EXPECT_THAT(message_of([&] { fake.open(path); }), HasSubstr("could not write"));
}

TEST_F(SessionFolderTest, MayItselfBeCalledByALink) {
  fs::create_directory(folder / "disk");
  fs::create_directory_symlink(folder / "disk", path);
  fake.create(path, small_plan()).store_picture("a.arw", bytes_of("abc"));
  EXPECT_EQ(text_of(folder / "disk/raw/a.arw"), "abc");
}

TEST_F(SessionFolderTest, StoresAPictureOnceAndReturnsItsHash) {
  SessionFolder session = fake.create(path, small_plan());
  EXPECT_EQ(session.store_picture("a.arw", bytes_of("abc")), sha256_hex("abc"));
  EXPECT_EQ(text_of(path / "raw/a.arw"), "abc");
  EXPECT_THAT(message_of([&] { session.store_picture("a.arw", bytes_of("other")); }), HasSubstr("never overwritten"));
  EXPECT_EQ(text_of(path / "raw/a.arw"), "abc");
}

TEST_F(SessionFolderTest, LeavesNothingBehindWhenTheDiskFailsAtAnyCall) {
  SessionFolder session = fake.create(path, small_plan());
  const std::map<int, std::string> errors = {{ENOSPC, "free space"},
                                             {EROFS, "make that disk writable"},
                                             {EACCES, "give this user the right"},
                                             {EIO, "disk or its cable"}};
  for (const auto& [error, advice] : errors) {
    for (int call = 1; call <= 6; ++call) {  // open, write, sync, rename, open and sync of the folder
      fake.disk.trouble = FakeFileSystem::Trouble::fail_once;
      fake.disk.error = error;
      fake.disk.at_call = fake.disk.calls + call;
      const std::string message = message_of([&] { session.store_picture("a.arw", bytes_of("abc")); });
      EXPECT_THAT(message, HasSubstr("could not write '" + (path / "raw/a.arw").string() + "'")) << call;
      EXPECT_THAT(message, HasSubstr(advice));
      EXPECT_TRUE(fs::is_empty(path / "raw")) << call;
    }
  }
}

TEST_F(SessionFolderTest, ClearsAwayWhatAKilledProcessLeftAndSaysSo) {
  fake.create(path, small_plan());
  write_text(path / "raw/.a.arw.partial", "half");
  const SessionFolder session = fake.open(path);
  EXPECT_TRUE(fs::is_empty(path / "raw"));
  ASSERT_FALSE(session.records().empty());
  EXPECT_EQ(session.records().back().data.at("files").at(0), "raw/.a.arw.partial");
}

TEST_F(SessionFolderTest, WithPicturesAndNoJournalIsNotOpenedBecauseThePicturesWouldBeLost) {
  fake.create(path, small_plan()).store_picture("a.arw", bytes_of("abc"));
  fs::remove(path / "journal.jsonl");
  EXPECT_THAT(message_of([&] { fake.open(path); }), HasSubstr("journal is missing or empty"));
  EXPECT_TRUE(fs::exists(path / "raw/a.arw"));
}

// A second process opens the session and waits; pipes say when it has, and when it may end.
TEST_F(SessionFolderTest, IsOpenInOneProcessAtATime) {
  fake.create(path, small_plan());
  std::array<int, 2> opened{}, may_end{};
  ASSERT_EQ(::pipe(opened.data()), 0);
  ASSERT_EQ(::pipe(may_end.data()), 0);
  char byte = 0;
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(may_end[1]);
    const SessionFolder session = fake.open(path);
    const bool told = ::write(opened[1], "x", 1) == 1;
    const bool ended = ::read(may_end[0], &byte, 1) == 0;
    ::_exit(told && ended ? 0 : 1);
  }
  ASSERT_EQ(::read(opened[0], &byte, 1), 1);
  const std::string message = message_of([&] { fake.open(path); });
  EXPECT_THAT(message, HasSubstr("in use by process " + std::to_string(child)));
  for (const int descriptor : {may_end[1], may_end[0], opened[0], opened[1]}) ::close(descriptor);
  int status = 1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(message_of([&] { fake.open(path); }), "") << "the lock ends with its process";
}

// After a power cut the file is still there, and the number in it may be another process's by now.
TEST_F(SessionFolderTest, ALockOfAnotherBootIsStale) {
  fake.create(path, small_plan());
  const std::string of_another_boot = std::to_string(::getppid()) + "\n";
  write_text(path / kLockFile, of_another_boot);
  EXPECT_FALSE(folder_in_use(path));
  EXPECT_EQ(fake.run(path, small_plan()), RunState::complete);
  EXPECT_NE(text_of(path / kLockFile), of_another_boot);
  const SessionFolder session = fake.open(path);
  EXPECT_TRUE(folder_in_use(path));
  EXPECT_EQ(std::stol(text_of(path / kLockFile)), ::getpid());
}

}  // namespace
}  // namespace station
