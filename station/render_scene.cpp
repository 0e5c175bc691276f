#include "station/render_scene.h"

#include <chrono>
#include <cstdio>
#include <stdexcept>

#include "renderer/image_file.h"
#include "renderer/path_tracer.h"
#include "station/documents/scene_file.h"
#include "station/documents/session_file.h"
#include "station/interrupt.h"
#include "station/report/display.h"

namespace station {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Before the work, not after it.
void check_destination(const std::filesystem::path& out) {
  const std::string ending = out.extension().string();
  if (ending != ".exr" && ending != ".png")
    throw std::runtime_error("cannot write " + out.string() + ": found the ending \"" + ending +
                             "\", expected .exr (linear) or .png (display)");
  const std::filesystem::path folder = out.has_parent_path() ? out.parent_path() : ".";
  if (!std::filesystem::is_directory(folder))
    throw std::runtime_error("cannot write " + out.string() + ": there is no folder " + folder.string() +
                             "; make it first");
}

void write_picture(const RenderRequest& request, const SceneFile& scene, const cv::Mat3f& image,
                   RenderReport& report) {
  if (request.out.extension() == ".exr") {
    renderer::write_exr(request.out, image,
                        {{"threadstation/content", "linear camera RGB, radiance; not white-balanced"},
                         {"threadstation/scene", scene.name},
                         {"threadstation/software", software_version()},
                         {"threadstation/samples_per_pixel", std::to_string(report.samples_per_pixel)},
                         {"threadstation/seed", std::to_string(request.seed)}});
    return;
  }
  report.exposure = request.exposure ? *request.exposure : scene.exposure ? *scene.exposure : display_scale(image);
  renderer::write_png(request.out, display(image, report.exposure, scene.linear_srgb_from_camera));
}

}  // namespace

RenderReport render_scene(const RenderRequest& request) {
  watch_interrupts();
  check_destination(request.out);
  const Clock::time_point start = Clock::now();
  const SceneFile scene = read_scene(request.scene);
  const renderer::PathTracer tracer(to_scene(scene));
  RenderReport report{.image = request.out.string(),
                      .width = scene.camera.width,
                      .height = scene.camera.height,
                      .samples_per_pixel = request.samples_per_pixel.value_or(scene.samples_per_pixel),
                      .build_s = seconds_since(start)};
  ProgressDisplay progress("render", request.progress);
  constexpr int kSteps = 20;
  int shown = -1;
  const auto show = [&](double fraction) {
    const int step = static_cast<int>(kSteps * fraction);
    if (step != shown) progress.show(100 / kSteps * step, 100, "%");
    shown = step;
    return !interrupted();
  };
  renderer::RenderStatistics statistics;
  const Clock::time_point render_start = Clock::now();
  const cv::Mat3f image = tracer.render(scene.camera, {.samples_per_pixel = report.samples_per_pixel,
                                                       .seed = request.seed,
                                                       .threads = request.threads,
                                                       .progress = show,
                                                       .statistics = &statistics});
  report.render_s = seconds_since(render_start);
  report.samples = statistics.samples;
  report.rays = statistics.rays;
  write_picture(request, scene, image, report);
  progress.finish("wrote " + report.image);
  return report;
}

nlohmann::json to_json(const RenderReport& report) {
  return {{"image", report.image},       {"width_px", report.width},
          {"height_px", report.height},  {"samples_per_pixel", report.samples_per_pixel},
          {"exposure", report.exposure}, {"build_s", report.build_s},
          {"render_s", report.render_s}, {"samples", report.samples},
          {"rays", report.rays}};
}

std::string describe_times(const RenderReport& report) {
  const double seconds = std::max(report.render_s, 1e-9);
  char text[256];
  std::snprintf(text, sizeof text,
                "read and built in %.2f s\nrendered in %.2f s: %.4g samples/s, %.4g rays, %.4g rays/s\n",
                report.build_s, report.render_s, static_cast<double>(report.samples) / seconds,
                static_cast<double>(report.rays), static_cast<double>(report.rays) / seconds);
  return text;
}

}  // namespace station
