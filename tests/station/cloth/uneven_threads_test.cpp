#include "station/cloth/uneven_threads.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "renderer/weave/woven_patch.h"
#include "tests/places.h"
#include "tests/support/message_of.h"

namespace station {
namespace {

using nlohmann::json;
using testing::HasSubstr;

ThreadFile silk() {
  return read_thread(std::filesystem::path(DATA_DIR) / "threads" / "silk_red.json");
}

TEST(UnevenThreads, ShadesAreAsFarApartAsTheThreadVaries) {
  const ThreadFile thread = silk();
  const std::vector<ThreadFile> shades = shades_of(thread, 0.3);
  double mean = 0, squares = 0, last = -1e9;
  for (const ThreadFile& shade : shades) {
    const double darker = std::log(shade.parameters.sigma_a.y() / thread.parameters.sigma_a.y());
    EXPECT_GT(darker, last);
    last = darker, mean += darker / kThreadShades, squares += darker * darker / kThreadShades;
    EXPECT_EQ(shade.parameters.alpha, thread.parameters.alpha);
  }
  EXPECT_NEAR(mean, 0, 1e-9);
  EXPECT_NEAR(std::sqrt(squares), 0.3, 1e-9);
}

TEST(UnevenThreads, ADraftShowsManyYarnsThatDiffer) {
  const renderer::Draft even = renderer::plain_draft();
  const renderer::Draft slow = uneven_draft(even, {0.2, 0.06, 500}, {0.1, 0.08, 300});
  ASSERT_GE(slow.warp_over.size(), 20U);
  ASSERT_GE(slow.warp_over.front().size(), 20U);
  for (std::size_t pick = 0; pick < slow.warp_over.size(); ++pick)
    for (std::size_t end = 0; end < slow.warp_over[pick].size(); ++end)
      EXPECT_EQ(slow.warp_over[pick][end], even.warp_over[pick % 2][end % 2]);
  EXPECT_NEAR(slow.unevenness.radius, std::hypot(0.06, 0.08) / std::sqrt(2.0), 1e-12);
  EXPECT_EQ(slow.slubs.radius, 0);
  renderer::Draft begun = slow;
  begun.relaxed = false;
  const renderer::YarnPatch patch = renderer::woven_patch(begun).patch;
  std::set<int> warp, weft;
  for (const renderer::Yarn& yarn : patch.yarns) (yarn.warp ? warp : weft).insert(yarn.thread);
  EXPECT_GE(warp.size(), 4U);
  EXPECT_GE(weft.size(), 4U);
  EXPECT_LT(*warp.rbegin(), kThreadShades);
  const renderer::Draft fast = uneven_draft(even, {0.2, 0.06, 2}, {0.2, 0.06, 2});
  EXPECT_NEAR(fast.slubs.radius, 0.06, 1e-12);
  EXPECT_EQ(fast.slubs.shade_mm, 2);
  EXPECT_EQ(fast.unevenness.radius, 0);
}

TEST(UnevenThreads, WhatWasNotMeasuredIsOneLine) {
  ThreadFile thread = silk();
  EXPECT_THAT(message_of([&] { irregularity_of(thread, "silk.json"); }),
              AllOf(HasSubstr("silk.json"), HasSubstr("invert"), HasSubstr("--uneven")));
  thread.fit["irregularity"] = {
      {"shade", nullptr}, {"diameter", {{"value", 0.05}, {"sigma", 0.01}}}, {"length_mm", 80}};
  const ThreadIrregularity found = irregularity_of(thread, "silk.json");
  EXPECT_EQ(found.shade, 0);
  EXPECT_EQ(found.diameter, 0.05);
  EXPECT_EQ(found.length_mm, 80);
}

}  // namespace
}  // namespace station
