#include "station/documents/disk/file_name.h"

#include <gtest/gtest.h>

#include "station/documents/disk/sha256.h"

namespace station {
namespace {

TEST(FileName, NamesOfStepsAndPicturesAreAllowed) {
  for (const char* name : {"pose-horizontal-1", "dark-reflection-vertical-6.arw", "Spool_12", "a", "console.arw"})
    EXPECT_FALSE(problem_with_name(name)) << *problem_with_name(name);
}

TEST(FileName, NamesThatLeaveTheFolderHideOrMeanADeviceAreRefused) {
  const std::string with_nul("a\0b", 3);
  for (const std::string& name : std::initializer_list<std::string>{
           "", "..", "../x", "a/b", "/etc/passwd", "a\\b", ".hidden", "-rf", "a..b", "ends.", "CON", "con.arw",
           "lpt1.txt", "two words", "line\nbreak", with_nul, "\xc3\xa4", "\xd0\xb0", std::string(300, 'a')}) {
    const auto problem = problem_with_name(name);
    ASSERT_TRUE(problem) << name;
    EXPECT_EQ(problem->find('\n'), std::string::npos) << "one line";
  }
}

TEST(Sha256, AgreesWithTheStandardsExample) {
  // FIPS 180-4, the message "abc".
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace station
