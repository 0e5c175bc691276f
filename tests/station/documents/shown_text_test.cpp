#include "station/documents/disk/shown_text.h"

#include <gtest/gtest.h>

#include "station/documents/disk/file_name.h"
#include "station/documents/reader.h"
#include "tests/station/documents/refusal.h"

namespace station {
namespace {

TEST(ShownText, IsWhatWasTyped) {
  for (const char* text : {"", "silk", "Grüne Seide", "絹", "🧵 thread"}) EXPECT_EQ(shown_text(text), text);
}

TEST(ShownText, IsCutBetweenCharacters) {
  EXPECT_EQ(shown_text("üüü", 3), "üüü");
  EXPECT_EQ(shown_text("üüüü", 3), "üüü...");
  EXPECT_EQ(shown_text("絹🧵ü", 2), "絹🧵...");
}

TEST(ShownText, BreaksNoLineAndNoTerminal) {
  EXPECT_EQ(shown_text("a\nb\x1b[2J\x7f\t"), "a?b?[2J??");
  EXPECT_EQ(shown_text("\xfc\xc3"), "??") << "Latin 1, and a character that is cut short";
  EXPECT_EQ(shown_text("\xc0\x8a"), "??") << "a line feed in two bytes";
  EXPECT_EQ(shown_text("\xc2\x9b"), "??") << "a control character of Latin 1";
  EXPECT_EQ(shown_text("\xed\xa0\x80"), "???") << "half of a pair";
  EXPECT_EQ(shown_text("\xe2\x80\xae"), "???") << "text from right to left";
}

TEST(ShownText, IsHowNamesAndDocumentsAreQuoted) {
  EXPECT_NE(problem_with_name("Grüne Seide")->find("'Grüne Seide'"), std::string::npos);
  const nlohmann::json document{{"format", "threadstation/draft"}, {"version", 1}, {"name", {"Grüne Seide"}}};
  EXPECT_NE(
      station_test::refusal([&] { ObjectReader(document, "x.json", "draft").text("name"); }).find("[\"Grüne Seide\"]"),
      std::string::npos);
}

}  // namespace
}  // namespace station
