// Mean radiance against programs that nobody here wrote.
#include "tests/renderer/trace/curve_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

#include "renderer/trace/path_tracer.h"
#include "tests/places.h"

namespace renderer {
namespace {

struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = 0;
};

// Smallest and largest mean of the other renderers, widened by 0.5 % (their Monte Carlo error is below 0.3 %; Cycles'
// approximate Bessel function makes its reflection 1.8 % dark here).
std::array<Interval, 3> reference(const std::string& scene, int vertices) {
  std::ifstream file(FIXTURES_DIR "/reference/curve_scenes.csv");
  std::array<Interval, 3> intervals;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream cells(line);
    std::string renderer, name;
    int count = 0;
    cells >> renderer >> name >> count;
    if (name != scene || count != vertices) continue;
    for (Interval& interval : intervals) {
      double mean = 0;
      cells >> mean;
      interval = {std::min(interval.low, 0.995 * mean), std::max(interval.high, 1.005 * mean)};
    }
  }
  return intervals;
}

void expect_means_inside(const std::string& name, const CurveScene& scene) {
  const PathTracer tracer(scene.scene);
  for (int vertices : {1, 2}) {
    const cv::Scalar mean = cv::mean(tracer.render(scene.camera, {.samples_per_pixel = 16, .max_vertices = vertices}));
    const auto intervals = reference(name, vertices);
    for (int c = 0; c < 3; ++c) {
      EXPECT_GE(mean[c], intervals[static_cast<std::size_t>(c)].low) << name << ' ' << vertices << ' ' << c;
      EXPECT_LE(mean[c], intervals[static_cast<std::size_t>(c)].high) << name << ' ' << vertices << ' ' << c;
    }
  }
}

TEST(CurveScenesTest, ParallelThreadsHaveTheMeanRadianceOfCyclesAndMitsuba) {
  expect_means_inside("a", parallel_threads_scene());
}

TEST(CurveScenesTest, PlainWeaveInTwoScalesHasTheMeanRadianceOfItsCurves) {
  const CurveScene curves = plain_weave_scene(), cloth = plain_weave_cloth();
  const RenderOptions options{.samples_per_pixel = 8, .max_vertices = 8};
  const cv::Scalar expected = cv::mean(PathTracer(curves.scene).render(curves.camera, options)),
                   found = cv::mean(PathTracer(cloth.scene).render(cloth.camera, options));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] / expected[c], 1, 2e-3) << c;  // the same seed: noise of half that
}

TEST(CurveScenesTest, PlainWeaveHasTheMeanRadianceOfCyclesAndMitsuba) {
  expect_means_inside("b", plain_weave_scene());
}

}  // namespace
}  // namespace renderer
