// Embroidery files whose content is known because the test writes them, with encoders of its own.
#include "station/documents/motif_file.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "station/documents/dst_file.h"
#include "station/documents/pes_file.h"
#include "tests/station/documents/encoded_motifs.h"
#include "tests/station/documents/refusal.h"

namespace station_test {
namespace {

using Eigen::Vector2d;
using renderer::Motif;

std::vector<Record> random_records(int most, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> move(-most, most);
  std::vector<Record> records;
  for (int i = 0; i < 500; ++i) {
    records.push_back({Step::stitch, move(random), move(random)});
    if (i % 100 == 99) records.push_back({Step::colour});
  }
  records.push_back({Step::stitch, 1, 1});
  records.push_back({Step::stitch, 2, 2});
  return records;
}

void expect_points(const Motif& motif, const std::vector<Record>& records) {
  std::vector<Vector2d> expected, found;
  Vector2d at = Vector2d::Zero();
  for (const Record& record : records) {
    at += 0.1 * Vector2d(record.x, record.y);
    if (record.step == Step::stitch) expected.push_back(at);
  }
  for (const renderer::StitchRun& run : motif.runs)
    found.insert(found.end(), run.needle_points.begin(), run.needle_points.end());
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) ASSERT_LT((found[i] - expected[i]).norm(), 1e-9) << i;
}

TEST(MotifFile, EveryMoveOfADstFileIsRead) {
  std::vector<Record> records;
  for (int v = -121; v <= 121; ++v) records.push_back({Step::stitch, v, -v}), records.push_back({Step::stitch, 0, v});
  expect_points(station::parse_dst(dst(records), "rose.dst"), records);
  const std::vector<Record> coloured = random_records(121, 1);
  const Motif motif = station::parse_dst(dst(coloured), "rose.dst");
  EXPECT_EQ(motif.name, "rose");
  EXPECT_EQ(motif.threads.size(), 6U);
  expect_points(motif, coloured);
}

TEST(MotifFile, ThreeJumpsCutTheThreadAndTwoDoNot) {
  const Record sewn{Step::stitch, 10, 0}, jump{Step::jump, 100, 0};
  EXPECT_EQ(station::parse_dst(dst({sewn, sewn, jump, jump, sewn, sewn}), "a").runs.size(), 1U);
  EXPECT_EQ(station::parse_dst(dst({sewn, sewn, jump, jump, jump, sewn, sewn}), "a").runs.size(), 2U);
}

TEST(MotifFile, EveryMoveOfAPesFileIsReadWithItsColours) {
  std::vector<Record> records;
  for (int v = -2047; v <= 2047; v += 23)
    records.push_back({Step::stitch, v, -v}), records.push_back({Step::stitch, -v, 9});
  expect_points(station::parse_pes(pes(records, {5}), "rose.pes"), records);
  const std::vector<Record> coloured = random_records(300, 2);
  const Motif motif = station::parse_pes(pes(coloured, {5, 20, 29, 58, 2, 1}), "rose.pes");
  expect_points(motif, coloured);
  ASSERT_EQ(motif.threads.size(), 6U);
  EXPECT_EQ(motif.threads[0].name, "Red");
  EXPECT_EQ(motif.threads[3].srgb, (std::array<unsigned char, 3>{255, 217, 17}));
  EXPECT_EQ(
      station::parse_pes(
          pes({{Step::stitch, 9, 9}, {Step::jump, 100, 0}, {Step::stitch, 9, 9}, {Step::stitch, 9, 9}}, {200}), "a")
          .runs.size(),
      2U);
}

TEST(MotifFile, FilesCutShortAtAnyByteAreOneLineOrWhole) {
  const std::vector<Record> records = random_records(121, 3);
  for (const auto& [bytes, parse] :
       {std::pair(dst(records), &station::parse_dst), std::pair(pes(records, {1, 2, 3, 4, 5, 6}), &station::parse_pes)})
    for (std::size_t size = 0; size < bytes.size() - 3; ++size) {
      const std::string line = refusal([&] { parse(std::string_view(bytes).substr(0, size), "cut.file"); });
      ASSERT_NE(line.find("cut.file"), std::string::npos) << size << ": " << line;
    }
}

TEST(MotifFile, DamagedBytesNeverCrash) {
  std::mt19937 random(4);
  const std::string whole[] = {dst(random_records(121, 5)), pes(random_records(300, 6), {1, 2, 3, 4, 5, 6})};
  for (int i = 0; i < 2000; ++i)
    for (int kind = 0; kind < 2; ++kind) {
      std::string bytes = whole[kind];
      for (int k = 0; k < 4; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
      try {
        kind == 0 ? station::parse_dst(bytes, "a") : station::parse_pes(bytes, "a");
      } catch (const std::runtime_error& refused) {
        EXPECT_EQ(std::string(refused.what()).find('\n'), std::string::npos);
      }
    }
}

}  // namespace
}  // namespace station_test
