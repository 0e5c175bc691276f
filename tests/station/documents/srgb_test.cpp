#include "station/documents/srgb.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/station/documents/refusal.h"

namespace station {
namespace {

using station_test::refusal;

// Names and numbers from the tables of CSS Color Module Level 4.
TEST(Srgb, ColoursAreWrittenAsNumbersAndByName) {
  EXPECT_EQ(parse_colour("#c01830"), (Srgb8{0xc0, 0x18, 0x30}));
  EXPECT_EQ(parse_colour("crimson"), (Srgb8{220, 20, 60}));
  EXPECT_EQ(parse_colour("RebeccaPurple"), (Srgb8{102, 51, 153}));
  EXPECT_EQ(parse_colour("aliceblue"), (Srgb8{240, 248, 255}));
  EXPECT_EQ(parse_colour("yellowgreen"), (Srgb8{154, 205, 50}));
}

// Squares of the ColorChecker 2005, through the matrix for D50 that Lindbloom publishes and sRGB's curve.
TEST(Srgb, LabIsThatOfColourCards) {
  const std::vector<std::pair<std::string, std::array<int, 3>>> squares{
      {"lab(37.986, 13.555, 14.059)", {115, 81, 67}},
      {"lab(65.711 18.130 17.810)", {199, 147, 129}},
      {"lab( 51.935 49.986 -14.574 )", {193, 84, 151}},
      {"lab(50.867 -0.153 -0.270)", {121, 121, 122}}};
  for (const auto& [text, expected] : squares) {
    const Srgb8 found = parse_colour(text);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_LE(std::abs(found[c] - expected[c]), 1) << text << " " << c;
  }
  EXPECT_EQ(parse_colour("lab(100 0 0)"), (Srgb8{255, 255, 255}));
  EXPECT_EQ(hex_text(parse_colour("lab(37.986 13.555 14.059)")), "#735143");
}

TEST(Srgb, WhatIsNoColourIsOneLineThatSaysHowToWriteOne) {
  for (const char* text :
       {"", "#c0183", "#c0183g", "mauvelous", "lab(40 60)", "lab(40 60 30", "lab(a b c)", "lab(1e3 0 0)"})
    EXPECT_NE(refusal([&] { parse_colour(text); }).find("a name like crimson"), std::string::npos) << text;
  const std::string digits(400, '9');
  EXPECT_NE(refusal([&] { parse_colour("lab(" + digits + " 0 0)"); }).find("a name like crimson"), std::string::npos);
  const std::string outside = refusal([] { parse_colour("lab(50 -90 60)"); });
  EXPECT_NE(outside.find("sRGB does not hold; near it is #00"), std::string::npos) << outside;
}

}  // namespace
}  // namespace station
