#include "station/documents/disk/stored_file.h"

#include <gmock/gmock.h>

#include <cerrno>
#include <span>

#include "tests/support/fake_file_system.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(StoredFileTest, ANameWithoutAFolderIsStoredInTheWorkingFolder) {
  const TemporaryFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder / "");
  FileSystem disk;
  EXPECT_NO_THROW(store_file(disk, "a.txt", std::as_bytes(std::span(std::string_view("abc")))));
  fs::current_path(before);
  EXPECT_EQ(text_of(folder / "a.txt"), "abc");
}

TEST(StoredFileTest, WhatCannotBeStoredIsKnownBeforeAndTryingLeavesNothing) {
  const TemporaryFolder folder;
  FileSystem disk;
  EXPECT_THAT(message_of([&] { check_can_store(disk, folder / "none/a.txt"); }),
              HasSubstr("could not write '" + (folder / "none/a.txt").string() + "': No such file or directory; make"));
  EXPECT_THAT(message_of([&] { check_can_store(disk, folder / ""); }), HasSubstr("Is a directory"));
  check_can_store(disk, folder / "a.txt");
  FakeFileSystem broken;
  broken.trouble = FakeFileSystem::Trouble::fail_from_then_on;
  broken.error = EROFS;
  for (broken.at_call = 1; broken.at_call <= 3; ++broken.at_call) {  // open, write, sync
    broken.calls = 0;
    EXPECT_THAT(message_of([&] { check_can_store(broken, folder / "a.txt"); }), HasSubstr("make that disk writable"));
  }
  EXPECT_TRUE(fs::is_empty(folder / ""));
}

}  // namespace
}  // namespace station
