// Drawings as line art: what is drawn follows from what each test writes.
#include "station/documents/svg_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "renderer/embroidery/digitise.h"
#include "tests/station/documents/refusal.h"

namespace station_test {
namespace {

using Eigen::Vector2d;
using renderer::LineArt;
using station::parse_svg;

// 100 x 100 mm, one unit a millimetre, fine lines unless the content says otherwise.
LineArt drawn(const std::string& content) {
  return parse_svg(R"svg(<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100")svg"
                   R"svg( stroke-width="0.3">)svg" +
                       content + "</svg>",
                   "motif.svg");
}

std::vector<Vector2d> line(const std::string& content) {
  const LineArt art = drawn(content);
  EXPECT_EQ(art.lines.size(), 1U) << content;
  return art.lines.front().points;
}

double length(const std::vector<Vector2d>& points) {
  double sum = 0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += (points[i] - points[i - 1]).norm();
  return sum;
}

TEST(SvgFile, LinesAreFollowedInSmallStepsInMillimetresYUp) {
  const std::vector<Vector2d> straight = line(R"svg(<path d="M 10 20 h 10.03" stroke="#c01830"/>)svg");
  EXPECT_LT((straight.front() - Vector2d(10, -20)).norm(), 1e-9);
  EXPECT_LT((straight.back() - Vector2d(20.03, -20)).norm(), 1e-9);
  const std::vector<Vector2d> circle = line(R"svg(<circle cx="50" cy="50" r="7" stroke="red" fill="none"/>)svg");
  for (const Vector2d& point : circle) EXPECT_NEAR((point - Vector2d(50, -50)).norm(), 7, 1e-6);
  EXPECT_LT((circle.front() - circle.back()).norm(), 1e-6);
  for (const auto& points : {straight, circle})
    for (std::size_t i = 1; i < points.size(); ++i)
      EXPECT_LE((points[i] - points[i - 1]).norm(), 1.01 * renderer::kLineStep_mm) << i;
}

TEST(SvgFile, CornersArePoints) {
  const std::vector<Vector2d> points =
      line(R"svg(<rect x="1" y="2" width="3.7" height="5.3" stroke="blue" fill="none"/>)svg");
  for (const Vector2d& corner : {Vector2d(1, -2), Vector2d(4.7, -2), Vector2d(4.7, -7.3), Vector2d(1, -7.3)})
    EXPECT_TRUE(std::ranges::any_of(points, [&](const Vector2d& p) { return (p - corner).norm() < 1e-9; }))
        << corner.transpose();
}

TEST(SvgFile, StrokesAreAsWideAsTheyAreDrawn) {
  const LineArt art = drawn(R"svg(<path d="M0 0 L9 0" stroke="red"/>
    <g transform="scale(2 8)"><path d="M0 0 L9 0" stroke="red" stroke-width="3"/></g>
    <path d="M0 0 L9 0" stroke="red" style="stroke-width:2mm"/>)svg");
  ASSERT_EQ(art.lines.size(), 3U);
  EXPECT_NEAR(art.lines[0].width_mm, 0.3, 1e-9);
  EXPECT_NEAR(art.lines[1].width_mm, 12, 1e-9);
  EXPECT_NEAR(art.lines[2].width_mm, 2 * 96 / 25.4, 1e-9) << "the unit of this drawing is a millimetre, not a pixel";
}

TEST(SvgFile, ShapesAreFilledBeforeTheirOutlineIsDrawnAndLinesHoldNothing) {
  const LineArt art = drawn(R"svg(<path d="M0 0 H9 V9 Z" fill="red" stroke="blue"/>
    <path d="M0 0 L9 0" stroke="blue"/>
    <path d="M0 0 H9 V9 H0 Z M3 3 H6 V6 H3 Z" fill-rule="evenodd"/>)svg");
  ASSERT_EQ(art.lines.size(), 4U);
  EXPECT_EQ(art.lines[0].srgb, (std::array<unsigned char, 3>{255, 0, 0}));
  EXPECT_EQ(art.lines[0].area.size(), 1U);
  EXPECT_FALSE(art.lines[0].along_rad || art.lines[0].even_odd);
  EXPECT_EQ(art.lines[1].srgb, (std::array<unsigned char, 3>{0, 0, 255}));
  EXPECT_TRUE(art.lines[1].area.empty() && art.lines[2].area.empty());
  EXPECT_EQ(art.lines[3].area.size(), 2U);
  EXPECT_TRUE(art.lines[3].even_odd);
  EXPECT_EQ(art.lines[3].srgb, (std::array<unsigned char, 3>{0, 0, 0})) << "black, as a drawing shows it";
}

TEST(SvgFile, DirectionsAreThoseOfTheirGroupAndNearestToTheShape) {
  const LineArt art = drawn(R"svg(<line class="direction" x1="0" y1="0" x2="10" y2="0"/>
    <g transform="rotate(90)"><path class="thin direction" d="M 0 -40 l 10 0"/>
      <path class="direction" d="M 0 -4 l 10 10"/>
      <rect x="0" y="-44" width="8" height="8"/><g><rect x="0" y="-8" width="8" height="8"/></g></g>
    <rect x="0" y="0" width="9" height="5"/>)svg");
  ASSERT_EQ(art.lines.size(), 3U);
  constexpr double kRight = std::numbers::pi / 2;
  EXPECT_NEAR(std::remainder(art.lines[0].along_rad.value() - kRight, 2 * kRight), 0, 1e-9);
  EXPECT_NEAR(std::remainder(art.lines[1].along_rad.value() - kRight / 2, 2 * kRight), 0, 1e-9);
  EXPECT_NEAR(std::remainder(art.lines[2].along_rad.value(), 2 * kRight), 0, 1e-9);
  EXPECT_NE(refusal([] { drawn(R"svg(<path id="d" class="direction" d="M 0 0 z"/>)svg"); }).find("leads nowhere"),
            std::string::npos);
}

TEST(SvgFile, TransformsOfGroupsAndElementsApplyFromTheInside) {
  const std::string turned =
      R"svg(<line x1="0" y1="0" x2="2" y2="0" stroke="red" transform="rotate(90) scale(0.5)"/>)svg";
  const std::vector<Vector2d> points =
      line(R"svg(<g transform="translate(10, 20)"><g transform="matrix(2 0 0 2 0 0)">)svg" + turned + "</g></g>");
  EXPECT_LT((points.front() - Vector2d(10, -20)).norm(), 1e-9);
  EXPECT_LT((points.back() - Vector2d(10, -22)).norm(), 1e-9);  // turned clockwise on the page
  const std::vector<Vector2d> about =
      line(R"svg(<line x1="1" y1="0" x2="2" y2="0" stroke="red" transform="rotate(180 1 1)"/>)svg");
  EXPECT_LT((about.front() - Vector2d(1, -2)).norm(), 1e-9);
  const std::vector<Vector2d> skewed =
      line(R"svg(<line x1="0" y1="0" x2="0" y2="2" stroke="red" transform="skewX(45)"/>)svg");
  EXPECT_LT((skewed.back() - Vector2d(2, -2)).norm(), 1e-9);
}

TEST(SvgFile, ColoursComeFromAttributesStylesClassesAndGroups) {
  const LineArt art = drawn(R"svg(<title> a rose </title><style>.leaf, .stem { stroke: #0f0; fill: none }</style>
    <g stroke="navy" fill="none"><path d="M0 0 L9 0"/><path d="M0 1 L9 1"/></g>
    <path class="leaf" d="M0 2 L9 2"/><path style="stroke:rgb(1, 2, 3);fill:none" d="M0 3 L9 3"/>
    <path fill="#abcdef" d="M0 4 L9 4 L9 9 Z"/><path d="M0 5 L9 5" fill="none"/>
    <path d="M0 6 L9 6" stroke="red" display="none"/><g style="display:none"><path d="M0 7 L9 7" stroke="red"/></g>
    <defs><path d="M0 8 L9 8" stroke="red"/></defs>)svg");
  EXPECT_EQ(art.name, "a rose");
  const std::vector<std::array<unsigned char, 3>> expected{
      {0, 0, 128}, {0, 0, 128}, {0, 255, 0}, {1, 2, 3}, {0xab, 0xcd, 0xef}};
  ASSERT_EQ(art.lines.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(art.lines[i].srgb, expected[i]) << i;
}

TEST(SvgFile, ThePageSaysHowLargeAUnitIs) {
  const auto on_page = [](const std::string& page) {
    const LineArt art =
        parse_svg("<svg " + page + R"svg(><line x1="0" y1="0" x2="96" y2="0" stroke="red"/></svg>)svg", "motif.svg");
    return length(art.lines.front().points);
  };
  EXPECT_NEAR(on_page(""), 25.4, 1e-9);
  EXPECT_NEAR(on_page(R"svg(width="2in" viewBox="0 0 96 96")svg"), 50.8, 1e-9);
  EXPECT_NEAR(on_page(R"svg(width="96" height="48" viewBox="0 0 96 96")svg"), 12.7, 1e-9);
  EXPECT_NEAR(on_page(R"svg(width="100%" viewBox="0 0 96 96")svg"), 25.4, 1e-9);
}

TEST(SvgFile, WhatCannotBeSewnIsOneLine) {
  const std::string open = R"svg(<line x1="0" y1="0" x2="9" y2="0" stroke="red")svg";
  const std::vector<std::pair<std::string, std::string>> cases{
      {R"svg(<text>rose</text>)svg", "convert it to paths"},
      {R"svg(<use href="#a"/>)svg", "convert it to paths"},
      {R"svg(<path id="p1" d="M 0 0 Q nonsense" stroke="red"/>)svg", "p1"},
      {R"svg(<path d="M 0 0 L 9 9" stroke="url(#gradient)"/>)svg", "#c01830"},
      {R"svg(<path d="M 0 0 L 9 9" stroke="mauvelous"/>)svg", "#c01830"},
      {R"svg(<path d="M 0 0 L 9 9" stroke="lab(40 60 30)"/>)svg", "#c01830"},
      {R"svg(<g><path d="M 0 0 L 9 9" fill="none"/></g>)svg", "no line to sew"},
      {R"svg(<line x1="0" y1="0" x2="9e9" y2="0" stroke="red"/>)svg", "check the drawing's size"},
      {R"svg(<line x1="a" y1="0" x2="9" y2="0" stroke="red"/>)svg", "x1"},
      {open + R"svg( transform="spin(3)"/>)svg", "spin(3)"},
      {open + R"svg( transform="rotate(3"/>)svg", "rotate(3"},
      {open + R"svg( stroke-width="wide"/>)svg", "stroke-width"},
      {R"svg(<polygon points="1 2 3" stroke="red"/>)svg", "pairs"}};
  for (const auto& [content, named] : cases) {
    const std::string said = refusal([&] { drawn(content); });
    EXPECT_NE(said.find(named), std::string::npos) << content << ": " << said;
    EXPECT_NE(said.find("motif.svg"), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
  EXPECT_NE(refusal([] { parse_svg("<svg", "motif.svg"); }).find("no drawing"), std::string::npos);
  EXPECT_NE(refusal([] { parse_svg("<html></html>", "motif.svg"); }).find("no <svg>"), std::string::npos);
  std::string deep;
  for (int i = 0; i < 5000; ++i) deep += "<g>";
  for (int i = 0; i < 5000; ++i) deep += "</g>";
  EXPECT_NE(refusal([&] { drawn(deep); }).find("within more than"), std::string::npos);
}

TEST(SvgFile, CutDrawingsAreRefusedAndDamagedOnesReadOrRefusedInOneLineThatNamesTheFile) {
  const std::string whole = R"svg(<svg width="40mm" viewBox="0 0 40 40"><style>.a{stroke:red}</style>
    <g transform="translate(3 4) rotate(20)">
    <path class="a" d="M1 2 C 3 4 5 6 7 8 S 9 1 2 3 Q 1 1 2 2 T 3 3 A 2 3 10 0 1 8 8 z"/>
    <rect x="1" y="2" width="3" height="4" rx="1" style="stroke:#123;stroke-width:2mm"/></g></svg>)svg";
  // Whether it is read, to stitches of a size that can be sewn.
  const auto is_read = [](const std::string& text) {
    try {
      const renderer::Motif motif = renderer::digitise(parse_svg(text, "motif.svg"), "motif.svg");
      EXPECT_FALSE(motif.threads.empty()) << text;
      const renderer::MotifMeasures measures = renderer::measure(motif);
      EXPECT_TRUE(measures.low.allFinite() && measures.high.allFinite()) << text;
      EXPECT_LE((measures.high - measures.low).maxCoeff(), 2000) << text;
      return true;
    } catch (const std::runtime_error& problem) {
      const std::string line = problem.what();
      EXPECT_TRUE(line.starts_with("motif.svg: ")) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      return false;
    }
  };
  EXPECT_TRUE(is_read(whole));
  for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_FALSE(is_read(whole.substr(0, size))) << size;
  std::mt19937 random(1);
  int read = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string damaged = whole;
    for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = static_cast<char>(32 + random() % 95);
    read += is_read(damaged);
  }
  EXPECT_GT(read, 50) << "a digit in place of another is no damage";
  EXPECT_LT(read, 2000);
}

}  // namespace
}  // namespace station_test
