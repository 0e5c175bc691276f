// The ready cloths: each draft as flat cloth, woven and drawn in two scales, against the same cloth as explicit yarns;
// each scene without pixels that outshine their neighbours.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "renderer/scene/patch_curves.h"
#include "renderer/trace/path_tracer.h"
#include "renderer/weave/woven_patch.h"
#include "station/cloth/render/build_scene.h"
#include "station/documents/draft_file.h"
#include "tests/places.h"
#include "tests/renderer/trace/cloth_scenes.h"
#include "tests/renderer/trace/picture_comparison.h"

namespace {

namespace fs = std::filesystem;
using namespace renderer;
using Eigen::Vector3d;

// Threads of colours that differ, as many as the patch asks for.
std::vector<ScatteringModel> threads_for(const YarnPatch& patch) {
  std::vector<ScatteringModel> threads;
  for (int i = 0; i <= threads_of(patch).back(); ++i)
    threads.push_back(ThreadParameters{
        .sigma_a = {0.05 + 0.4 * ((i + 1) % 2), 0.1 + 0.3 * (i % 3), 0.8 - 0.15 * (i % 4)}, .alpha = {0.2, 0.3, 0.4}});
  return threads;
}

// A view of whole periods, at least about 3 mm, as large as the picture whatever their proportions.
Camera view_of_periods(const YarnPatch& patch) {
  const Vector3d eye(40, 20, 300);
  Camera camera = camera_on(eye, {0, 0, 0}, {0, 1, 0}, 1, 40, 40);
  const auto whole = [](double period_mm) { return std::max(1.0, std::floor(3.6 / period_mm)) * period_mm; };
  camera.fx = camera.width * eye.norm() / whole(patch.period_x_mm);
  camera.fy = camera.height * eye.norm() / whole(patch.period_y_mm);
  return camera;
}

class ReadyDraft : public testing::TestWithParam<fs::path> {};

TEST_P(ReadyDraft, IsFlatTheClothThatItsExplicitYarnsAre) {
  const YarnPatch patch = woven_patch(station::read_draft(GetParam())).patch;
  const auto threads = threads_for(patch);
  // The border is far from the view.
  const int n = 2 * static_cast<int>(std::ceil(8 / std::min(patch.period_x_mm, patch.period_y_mm)));
  const SwatchShape swatch{n * patch.period_x_mm, n * patch.period_y_mm};
  Scene two_scale = two_scale_scene(swatch, patch, threads);
  Scene explicit_yarns = brute_force_scene(swatch, patch, threads);
  for (const double side : {1.0, -1.0}) {
    for (Scene* scene : {&two_scale, &explicit_yarns})
      scene->lights = {
          {.center = {-120, 90, side * 300}, .radius_mm = 30, .radiance = {100, 100, 100}, .visible = false}};
    const PictureComparison found = compare_pictures(two_scale, explicit_yarns, view_of_periods(patch), 2);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(found.ratio[c], 1, 0.005) << "channel " << c << ", light from " << side;
      EXPECT_LT(found.standard_error[c], 0.0015);
    }
    // Few paths differ at all, so that their differences are less even than normal noise: up to 2.03 was seen.
    EXPECT_LT(found.structure, found.expected_structure + 6 * found.structure_deviation) << side;
    std::printf(
        "%s, light %s: two scales / explicit = %.4f %.4f %.4f, +- %.4f; structure %.2f (noise %.2f +- %.2f), "
        "largest block %.4f\n",
        GetParam().stem().c_str(), side > 0 ? "in front" : "behind", found.ratio[0], found.ratio[1], found.ratio[2],
        found.standard_error[0], found.structure, found.expected_structure, found.structure_deviation,
        found.largest_block);
  }
}

// The picture of a scene with `side` pixels across.
Camera small(Camera camera, int side) {
  const double factor = static_cast<double>(camera.width) / side;
  camera.width = side, camera.height = static_cast<int>(std::lround(camera.height / factor));
  camera.fx /= factor, camera.fy /= factor;
  camera.cx = (camera.cx + 0.5) / factor - 0.5, camera.cy = (camera.cy + 0.5) / factor - 0.5;
  return camera;
}

class ReadyScene : public testing::TestWithParam<fs::path> {};

TEST_P(ReadyScene, HasNoFirefliesAt256Samples) {
  const station::SceneFile scene = station::read_scene(GetParam());
  station::ProgressDisplay quiet("test", station::ProgressStyle::quiet);
  const PathTracer tracer(station::build_scene(scene, station::build_cloths(scene, quiet)));
  const Camera camera = small(scene.camera, 24);
  const cv::Mat3f a = tracer.render(camera, {.samples_per_pixel = 256, .seed = 1}),
                  b = tracer.render(camera, {.samples_per_pixel = 256, .seed = 2});
  // The difference of two pictures is noise, here 0.14 to 0.2 of the light around (RMS; yarns are sub-pixel). A firefly
  // is a pixel that is brighter in one of them by twice the light around it.
  cv::Mat3f around;
  cv::blur(0.5 * (a + b), around, {3, 3});
  const cv::Scalar mean = cv::mean(around);
  double largest = 0, squares = 0;
  int count = 0;
  for (int row = 0; row < camera.height; ++row)
    for (int column = 0; column < camera.width; ++column)
      for (int c = 0; c < 3; ++c) {
        const double light = static_cast<double>(around(row, column)[c]) + 0.02 * mean[c];
        const double noise = std::abs(static_cast<double>(a(row, column)[c] - b(row, column)[c])) / light;
        largest = std::max(largest, noise);
        squares += noise * noise, ++count;
      }
  std::printf("%s: noise %.3f of the light around, at most %.3f\n", GetParam().stem().c_str(),
              std::sqrt(squares / count), largest);
  EXPECT_LT(largest, 2);
}

std::vector<fs::path> json_files(const char* folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(DATA_DIR) / folder))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string name_of(const testing::TestParamInfo<fs::path>& file) {
  return file.param.stem().string();
}

INSTANTIATE_TEST_SUITE_P(All, ReadyDraft, testing::ValuesIn(json_files("drafts")), name_of);
INSTANTIATE_TEST_SUITE_P(All, ReadyScene, testing::ValuesIn(json_files("scenes")), name_of);

}  // namespace
