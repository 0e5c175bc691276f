#include "renderer/picture/film.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <set>

#include "renderer/trace/path_tracer.h"

namespace renderer {
namespace {

// Light and shade: a sphere's light on a floor that ends inside the picture.
Scene lit_floor() {
  return {.meshes = {{.vertices = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}},
                      .triangles = {{0, 1, 2}, {0, 2, 3}},
                      .albedo = cv::Mat3f(1, 1, cv::Vec3f(0.6f, 0.5f, 0.4f))}},
          .lights = {{.center = {0, 30, 40}, .radius_mm = 25, .visible = false}}};
}

// Not a whole number of tiles.
Camera camera_above(int width = 40, int height = 36) {
  Camera camera = look_at({0, 5, 50}, {0, 0, 0}, {0, 1, 0});
  camera.width = width, camera.height = height;
  camera.fx = camera.fy = 2.0 * width;
  camera.cx = (width - 1) / 2.0, camera.cy = (height - 1) / 2.0;
  return camera;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

// As several processes do that hand over their tiles after each pass.
TEST(FilmTest, SharesDrawnApartAreTheSamePictureBitForBit) {
  const PathTracer tracer(lit_floor());
  const Camera camera = camera_above(100, 70);
  constexpr int kShares = 3, kSamples = 100;
  constexpr double kNoise = 0.05;
  Film whole = empty_film(camera.width, camera.height);
  ASSERT_TRUE(tracer.refine(camera, {.samples_per_pixel = kSamples, .noise = kNoise, .seed = 3}, whole));
  std::vector<Film> films;
  for (int i = 0; i < kShares; ++i) films.push_back(empty_film(camera.width, camera.height));
  std::set<int> drawn;
  for (bool more = true; more;) {
    for (int i = 0; i < kShares; ++i) {
      const TileShare share{i, kShares};
      RenderStatistics statistics;
      const auto stop = [](Film&) { return PassEnd::stopped; };
      EXPECT_FALSE(tracer.refine(camera,
                                 {.samples_per_pixel = kSamples,
                                  .noise = kNoise,
                                  .seed = 3,
                                  .statistics = &statistics,
                                  .share = share,
                                  .end_pass = stop},
                                 films[static_cast<std::size_t>(i)]));
      for (const int tile : tiles_in(share, whole.goals.cols)) {
        put(record_of(films[static_cast<std::size_t>(i)], tile), films[0]);
        drawn.insert(tile);
      }
    }
    more = raise_goals(films[0], kSamples, kNoise);
    for (Film& film : films) films[0].goals.copyTo(film.goals);
  }
  EXPECT_EQ(static_cast<int>(drawn.size()), whole.goals.cols);
  EXPECT_TRUE(same(films[0].sums, whole.sums));
  EXPECT_TRUE(same(films[0].squares, whole.squares));
  EXPECT_TRUE(same(films[0].counts, whole.counts));
}

TEST(FilmTest, InterruptedAnywhereItEndsWithTheSamePictureBitForBit) {
  const PathTracer tracer(lit_floor());
  const Camera camera = camera_above();
  const cv::Mat3f whole = tracer.render(camera, {.samples_per_pixel = 37, .seed = 3});
  Film in_one_go = empty_film(camera.width, camera.height);
  ASSERT_TRUE(tracer.refine(camera, {.samples_per_pixel = 37, .seed = 3, .threads = 1}, in_one_go));
  EXPECT_TRUE(same(mean_radiance(in_one_go), whole));
  for (const int calls_per_part : {1, 7, 50}) {
    Film film = empty_film(camera.width, camera.height);
    int parts = 0;
    for (bool finished = false; !finished && parts < 2000; ++parts) {
      int calls = 0;
      RenderStatistics statistics;
      const std::uint64_t before = samples_in(film);
      const auto stop = [&](double) { return ++calls < calls_per_part; };
      finished = tracer.refine(
          camera,
          {.samples_per_pixel = 37, .seed = 3, .threads = parts % 2 + 1, .progress = stop, .statistics = &statistics},
          film);
      EXPECT_EQ(statistics.samples, samples_in(film) - before);
    }
    EXPECT_GT(parts, 2);
    EXPECT_TRUE(same(mean_radiance(film), whole)) << calls_per_part;
    EXPECT_TRUE(same(film.squares, in_one_go.squares)) << "as the noise is judged by them";
    EXPECT_TRUE(same(film.counts, in_one_go.counts));
  }
}

// Threads across and along over the floor, lit by a lamp and faintly from all around: single paths that matter much.
Scene threads_on_floor() {
  Scene scene = lit_floor();
  CurveSet set{.scattering = ThreadParameters{.sigma_a = {0.1, 0.5, 0.9}}};
  for (int i = -8; i <= 8; ++i) {
    const float at = 0.8f * static_cast<float>(i);
    set.add_clamped_curve({{-7, at, 1, 0.35f}, {7, at, 1, 0.35f}});
    set.add_clamped_curve({{at, -7, 1.7f, 0.35f}, {at, 7, 1.7f, 0.35f}});
  }
  scene.curves = {set};
  scene.lights.push_back({.radius_mm = 1e6, .radiance = {0.05, 0.05, 0.06}});
  return scene;
}

Film refined(const PathTracer& tracer, const Camera& camera, const RenderOptions& options) {
  Film film = empty_film(camera.width, camera.height);
  EXPECT_TRUE(tracer.refine(camera, options, film));
  return film;
}

// Root mean square over the pixels of a tile, as relative_error() has it.
double difference(const cv::Mat3f& a, const cv::Mat3f& b, const cv::Rect& tile) {
  double brightness = 0;
  for (const cv::Vec3f& pixel : cv::Mat3f(b(tile).clone())) brightness += cv::norm(pixel);
  return cv::norm(a(tile), b(tile)) * std::sqrt(tile.area()) / brightness;
}

TEST(FilmTest, TheErrorThatItTellsIsThatOfIndependentPictures) {
  const PathTracer tracer(threads_on_floor());
  const Camera camera = camera_above(32, 32);
  const cv::Rect whole(0, 0, 32, 32);
  for (const int samples : {64, 104}) {  // the second ends with half a batch
    const Film film = refined(tracer, camera, {.samples_per_pixel = samples});
    double error2 = 0;
    constexpr int kOthers = 6;
    for (int i = 0; i < kOthers; ++i) {
      const cv::Mat3f other =
          tracer.render(camera, {.samples_per_pixel = samples, .seed = 2u + static_cast<unsigned>(i)});
      error2 += std::pow(difference(mean_radiance(film), other, whole), 2) / 2 / kOthers;
    }
    const double told = relative_error(film, whole);
    EXPECT_LT(std::sqrt(error2), 1.05 * told) << samples;  // 1024 pixels with long tails
    EXPECT_GT(std::sqrt(error2), 0.6 * told) << samples << ": batches of 16 miss what larger sets gain by their order";
  }
}

TEST(FilmTest, EveryTileReachesTheNoiseAskedForAndHardlyMore) {
  const PathTracer tracer(threads_on_floor());
  const Camera camera = camera_above(48, 32);
  constexpr double kNoise = 0.1;
  const Film film = refined(tracer, camera, {.samples_per_pixel = 4096, .noise = kNoise});
  const Film reference = refined(tracer, camera, {.samples_per_pixel = 1024, .seed = 77});
  const std::vector<cv::Rect> tiles = tiles_of(film.counts.size());
  const std::vector<double> told = relative_errors_of_tiles(film);
  double mean2 = 0;
  std::set<int> counts;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    counts.insert(film.goals(static_cast<int>(i)));
    EXPECT_LE(told[i], kNoise);
    const double apart = difference(mean_radiance(film), mean_radiance(reference), tiles[i]);
    const double reached2 = apart * apart - std::pow(relative_error(reference, tiles[i]), 2);
    EXPECT_LT(reached2, std::pow(1.15 * kNoise, 2)) << "tile " << i;  // 256 pixels with long tails
    mean2 += reached2 / static_cast<double>(tiles.size());
  }
  EXPECT_LT(std::sqrt(mean2), 1.03 * kNoise);
  EXPECT_GT(std::sqrt(mean2), 0.5 * kNoise);
  EXPECT_GT(counts.size(), 2u) << "tiles differ in what they need";
  EXPECT_LT(*counts.rbegin(), 1024);
}

TEST(FilmTest, StoppingByTheNoiseDoesNotMakeThePictureDarkerOrBrighter) {
  const PathTracer tracer(threads_on_floor());
  const Camera camera = camera_above(32, 32);
  double sum = 0, squares = 0;
  constexpr int kPictures = 16;
  for (int i = 0; i < kPictures; ++i) {
    const RenderOptions options{.samples_per_pixel = 2048, .noise = 0.15, .seed = 100u + static_cast<std::uint64_t>(i)};
    const double brightness = cv::sum(cv::sum(mean_radiance(refined(tracer, camera, options))))[0];
    sum += brightness;
    squares += brightness * brightness;
  }
  const double mean = sum / kPictures, error = std::sqrt((squares / kPictures - mean * mean) / (kPictures - 1));
  const Film reference = refined(tracer, camera, {.samples_per_pixel = 2048, .seed = 7});
  const double expected = cv::sum(cv::sum(mean_radiance(reference)))[0];
  const double of_reference = expected * relative_error(reference, {0, 0, 32, 32}) / 32;  // of the mean of 1024 pixels
  EXPECT_LT(error, 2e-3 * mean) << "the test sees a bias of this size";
  EXPECT_NEAR(mean, expected, 3 * std::hypot(error, of_reference));
  std::printf("stopped at a noise of 15 %%: %.5f +- %.5f of the brightness\n", mean / expected,
              std::hypot(error, of_reference) / expected);
}

TEST(FilmTest, WithANoiseToReachItIsTheSameBitForBitToo) {
  const PathTracer tracer(threads_on_floor());
  const Camera camera = camera_above(48, 20);
  const RenderOptions options{.samples_per_pixel = 300, .noise = 0.06, .threads = 1};
  const Film whole = refined(tracer, camera, options);
  Film film = empty_film(camera.width, camera.height);
  RenderOptions part = options;
  part.threads = 2;
  for (bool finished = false; !finished;) {
    int calls = 0;
    part.progress = [&](double) { return ++calls < 9; };
    finished = tracer.refine(camera, part, film);
  }
  EXPECT_TRUE(same(film.counts, whole.counts));
  EXPECT_TRUE(same(film.sums.reshape(1), whole.sums.reshape(1)));
  double least = 0, most = 0;
  cv::minMaxLoc(film.counts, &least, &most);
  EXPECT_LT(least, most);
}

TEST(FilmTest, WhatIsEvenOrDarkIsNotSampledMoreThanItTakesToKnow) {
  const Camera camera = camera_above(64, 16);
  const Film black = refined(PathTracer(Scene{}), camera, {.samples_per_pixel = 4096, .noise = 0.001});
  EXPECT_EQ(samples_in(black), 64u * 16 * kLeastJudged);
  // A tile of hardly any light beside bright ones: what is left of its noise is nothing beside them.
  Film film = empty_film(32, 16);
  for (int column = 0; column < 32; ++column) {
    for (int row = 0; row < 16; ++row) {
      const double level = column < 16 ? 1e-4 : 1;
      film.counts(row, column) = kLeastJudged;
      film.sums(row, column) = cv::Vec3d::all(level * kLeastJudged);
      film.squares(row, column) = 3 * level * level * kLeastJudged * (1 + (column < 16 ? 0.5 : 1e-6));
    }
  }
  film.goals = kLeastJudged;
  EXPECT_GT(relative_error(film, {0, 0, 16, 16}), 0.1);
  EXPECT_FALSE(raise_goals(film, 4096, 0.01));
}

TEST(FilmTest, OneBatchTellsNoError) {
  const Film film = refined(PathTracer(lit_floor()), camera_above(), {.samples_per_pixel = kBatch});
  EXPECT_TRUE(std::isinf(relative_error(film, {0, 0, 40, 36})));
}

TEST(FilmTest, EveryPassRefinesTheWholePicture) {
  Film film = empty_film(40, 36);
  ASSERT_EQ(film.goals.total(), 9u);
  std::vector<int> goals;
  while (raise_goals(film, 100)) {
    goals.push_back(film.goals(0));
    for (const int goal : film.goals) EXPECT_EQ(goal, goals.back());
  }
  EXPECT_EQ(goals, (std::vector<int>{16, 32, 64, 100}));
}

TEST(FilmTest, TilesCoverEveryPixelOnce) {
  const cv::Size picture(40, 36);
  cv::Mat1i covered(picture, 0);
  const std::vector<cv::Rect> tiles = tiles_of(picture);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    covered(tiles[i]) += 1;
    EXPECT_EQ(tile_at(picture, tiles[i].x, tiles[i].y), static_cast<int>(i));
    EXPECT_EQ(tile_at(picture, tiles[i].br().x - 1, tiles[i].br().y - 1), static_cast<int>(i));
  }
  EXPECT_TRUE(same(covered, cv::Mat1i(picture, 1)));
}

TEST(FilmTest, WhereThereIsNoSampleItIsBlack) {
  Film film = empty_film(4, 3);
  film.sums(1, 2) = {3, 6, 9};
  film.counts(1, 2) = 3;
  const cv::Mat3f image = mean_radiance(film);
  EXPECT_EQ(image(1, 2), cv::Vec3f(1, 2, 3));
  EXPECT_EQ(cv::countNonZero(image.reshape(1)), 3);
  EXPECT_EQ(samples_in(film), 3u);
}

TEST(FilmTest, AFilmOfAnotherSizeIsRefused) {
  Film film = empty_film(4, 3);
  EXPECT_THROW(PathTracer(lit_floor()).refine(camera_above(), {}, film), std::runtime_error);
}

}  // namespace
}  // namespace renderer
