// The exported material in Debian's Blender beside our own pictures: the same scene with the thread, with the fiber
// that stands for it, and by Cycles with that fiber.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

#include "renderer/picture/image_file.h"
#include "renderer/trace/path_tracer.h"
#include "station/documents/fiber_file.h"
#include "station/documents/thread_file.h"
#include "station/output/compare/compare_pictures.h"
#include "tests/places.h"
#include "tests/renderer/trace/curve_scenes.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
constexpr int kSamples = 32;

cv::Mat3f picture(renderer::CurveScene scene, const renderer::ScatteringModel& model) {
  for (renderer::CurveSet& curves : scene.scene.curves) curves.scattering = model;
  return renderer::PathTracer(scene.scene).render(scene.camera, {.samples_per_pixel = kSamples});
}

double difference(const char* what, const cv::Mat3f& a, const cv::Mat3f& b) {
  const station::Comparison found = station::compare_pictures(a, b, {}, {.fit_scale = false});
  const cv::Scalar mean_a = cv::mean(a), mean_b = cv::mean(b);
  std::printf("  %s: CIEDE2000 mean %.2f, 95 %% below %.2f; means %.4f %.4f %.4f and %.4f %.4f %.4f\n", what,
              found.mean_delta_e, found.delta_e_95, mean_a[0], mean_a[1], mean_a[2], mean_b[0], mean_b[1], mean_b[2]);
  return found.mean_delta_e;
}

// Of the thread too, for a person to look at: all pictures stay in the folder that THREADSTATION_PICTURES names.
void keep_pictures(const std::string& name, const fs::path& thread, const renderer::CurveScene& scene,
                   const cv::Mat3f& of_fiber, const cv::Mat3f& of_cycles) {
  const char* named = std::getenv("THREADSTATION_PICTURES");
  if (named == nullptr) return;
  const fs::path folder = named;
  const cv::Mat3f of_thread = picture(scene, station::read_thread(thread).parameters);
  difference("ours, thread and fiber", of_thread, of_fiber);
  difference("thread ours, fiber Cycles", of_thread, of_cycles);
  renderer::write_exr(folder / (name + "_thread.exr"), of_thread);
  renderer::write_exr(folder / (name + "_fiber.exr"), of_fiber);
  renderer::write_exr(folder / (name + "_cycles.exr"), of_cycles);
}

void expect_cycles_to_show_the_fiber(const std::string& thread, const std::string& scene) {
  const fs::path file = fs::path(DATA_DIR) / "threads" / (thread + ".json");
  TemporaryFolder folder;
  const fs::path out = folder / "exported", cycles_file = folder / "cycles.exr";
  const ProgramResult exported =
      run_threadstation({"export", "thread", file.string(), "--out", out.string(), "--only", "blender"});
  ASSERT_EQ(exported.status, 0) << exported.error;
  const ProgramResult drawn =
      run_shell("blender --background --factory-startup --python-exit-code 1 --python " + std::string(SOURCE_DIR) +
                "/tests/station/cloth/export/blender_picture.py -- " + (out / "thread_material.py").string() + " " +
                scene + " " + std::to_string(kSamples) + " " + cycles_file.string());
  ASSERT_EQ(drawn.status, 0) << drawn.out << drawn.error;
  EXPECT_EQ(drawn.out.find("Error"), std::string::npos) << drawn.out;

  const renderer::CurveScene curves = scene == "a" ? renderer::parallel_threads_scene() : renderer::plain_weave_scene();
  const cv::Mat3f of_fiber = picture(curves, station::read_fiber(out / "fiber.json")),
                  of_cycles = renderer::read_exr(cycles_file);
  std::printf("%s, scene %s\n", thread.c_str(), scene.c_str());
  const double by_cycles = difference("fiber, ours and Cycles", of_fiber, of_cycles);
  keep_pictures(thread + "_" + scene, file, curves, of_fiber, of_cycles);
  EXPECT_LT(by_cycles, 2.0);  // Cycles is a few per cent dark (fixtures/reference/README.md)
}

TEST(BlenderExport, ParallelThreadsLookAsOurFiber) {
  expect_cycles_to_show_the_fiber("silk_red", "a");
  expect_cycles_to_show_the_fiber("cotton_white", "a");
}

TEST(BlenderExport, WovenThreadsLookAsOurFiber) {
  expect_cycles_to_show_the_fiber("silk_blue", "b");
}

}  // namespace
}  // namespace station_test
