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

TEST(FileName, WhatPeopleWriteBecomesANameThatTheyCanRead) {
  EXPECT_EQ(safe_name("Seide, rot/2"), "Seide-rot-2");
  EXPECT_EQ(safe_name("Wei\u00dfe Baumwolle, Gr\u00f6\u00dfe 7"), "Weisse-Baumwolle-Groesse-7");
  EXPECT_EQ(safe_name("Gro\u0308sse"), "Groesse") << "as macOS writes it, in two parts";
  EXPECT_EQ(safe_name("soie gr\u00e8ge"), "soie-grege");
  EXPECT_EQ(safe_name("\u0448\u0451\u043b\u043a"), "selk");
  EXPECT_EQ(safe_name("\u7d72"), "si");
  EXPECT_EQ(safe_name("\U0001f9f6"), "u1f9f6");
  EXPECT_EQ(safe_name("../../etc"), "etc");
  for (const char* name : {"a", "Blau 7", "\u7d72", "x..y", "-rf", "\xff\xfe", "\u00bd"})
    EXPECT_FALSE(problem_with_name(safe_name(name))) << safe_name(name);
}

TEST(Sha256, AgreesWithTheStandardsExample) {
  // FIPS 180-4, the message "abc".
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace station
