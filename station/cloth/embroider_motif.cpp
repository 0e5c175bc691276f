#include "station/cloth/embroider_motif.h"

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "calibration/light/colour_chart.h"
#include "inversion/texture/absorption_curve.h"
#include "renderer/embroidery/stitch_curves.h"
#include "renderer/picture/image_file.h"
#include "renderer/trace/path_tracer.h"
#include "station/cloth/cloth_colour.h"
#include "station/cloth/motif_colours.h"
#include "station/cloth/render/render_scene.h"
#include "station/documents/matrix_rows.h"
#include "station/documents/motif_file.h"
#include "station/documents/reader.h"
#include "station/documents/scene_names.h"
#include "station/documents/session_file.h"
#include "station/documents/thread_file.h"
#include "station/output/display.h"
#include "station/output/interrupt.h"
#include "station/output/picture_destination.h"

namespace station {
namespace {

using Eigen::Array3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSamplesPerPixel = 64;                // per pixel, of the curves and without a scene
constexpr double kEye_mm = 1000;                    // above the cloth
constexpr double kInGamut = 0.1;                    // CIEDE2000
constexpr double kCurveShare = 20, kFitShare = 30;  // of the work, %
constexpr double kSatinPitch = 0.875;               // of the diameter: stitches side by side

Vector3d linear_of(const Srgb8& colour) {
  const cv::Vec3f decoded = renderer::linear_of_srgb({colour[0], colour[1], colour[2]});
  return {decoded[0], decoded[1], decoded[2]};
}

renderer::Camera camera_above(const Vector2d& low, const Vector2d& high, double pixels_per_mm) {
  const Vector2d middle = (low + high) / 2, size = (high - low) * pixels_per_mm;
  if (!(size.prod() < renderer::kMostPicturePixels))
    throw std::runtime_error("the picture would have " + std::to_string(size.prod() / 1e6) +
                             " million pixels, at most 100 million are rendered; ask for fewer pixels per millimetre");
  renderer::Camera camera =
      renderer::look_at({middle.x(), middle.y(), kEye_mm}, {middle.x(), middle.y(), 0}, {0, 1, 0});
  camera.width = std::max(1, static_cast<int>(std::ceil(size.x())));
  camera.height = std::max(1, static_cast<int>(std::ceil(size.y())));
  camera.fx = camera.fy = pixels_per_mm * kEye_mm;
  camera.cx = (camera.width - 1) / 2.0, camera.cy = (camera.height - 1) / 2.0;
  return camera;
}

// The motif on its cloth, in a light of 1 from everywhere: radiance is reflectance.
renderer::Scene scene_of(const renderer::Motif& motif, const std::vector<renderer::ThreadParameters>& threads,
                         double diameter_mm, const Array3d& ground) {
  constexpr float kGround_mm = 5000;
  renderer::Scene scene;
  renderer::StitchCurves stitches = renderer::stitch_curves(motif, diameter_mm);
  for (std::size_t i = 0; i < threads.size(); ++i) {
    if (stitches.threads[i].segments.empty()) continue;
    stitches.threads[i].scattering = threads[i];
    scene.curves.push_back(std::move(stitches.threads[i]));
  }
  renderer::TriangleMesh cloth;
  for (const auto& [x, y] : {std::pair(-1.F, -1.F), std::pair(1.F, -1.F), std::pair(1.F, 1.F), std::pair(-1.F, 1.F)})
    cloth.vertices.push_back({x * kGround_mm, y * kGround_mm, 0});
  cloth.triangles = {{0, 1, 2}, {0, 2, 3}};
  cloth.albedo = cv::Mat3f(
      1, 1, cv::Vec3f(static_cast<float>(ground[0]), static_cast<float>(ground[1]), static_cast<float>(ground[2])));
  scene.meshes.push_back(std::move(cloth));
  scene.surroundings = renderer::EnvironmentLight{.radiance = cv::Mat3f(8, 16, cv::Vec3f(1, 1, 1))};
  return scene;
}

// Satin stitches side by side, all in one thread.
renderer::Motif satin_block(double diameter_mm) {
  constexpr int kStitches = 40;
  const double length_mm = 15 * diameter_mm;
  renderer::Motif satin{.name = "satin", .threads = {{}}, .runs = {{.thread = 0, .needle_points = {}}}};
  for (int i = 0; i <= kStitches; ++i)
    satin.runs[0].needle_points.push_back({i % 2 == 0 ? 0 : length_mm, i * kSatinPitch * diameter_mm});
  return satin;
}

// The colours of satin stitches of the thread on the cloth, seen from above.
AbsorptionCurves curves_of_satin(const renderer::ThreadParameters& thread, double diameter_mm, const Array3d& ground,
                                 std::uint64_t seed, const std::function<void(double)>& done) {
  const renderer::Motif satin = satin_block(diameter_mm);
  const renderer::MotifMeasures extents = renderer::measure(satin);
  const Vector2d middle = (extents.low + extents.high) / 2, half = 0.2 * (extents.high - extents.low);
  const renderer::Camera camera = camera_above(middle - half, middle + half, 6 / diameter_mm);
  const auto seen = [&](const renderer::ThreadParameters& coloured) {
    const renderer::PathTracer tracer(scene_of(satin, {coloured}, diameter_mm, ground));
    const cv::Scalar mean = cv::mean(tracer.render(camera, {.samples_per_pixel = kSamplesPerPixel, .seed = seed}));
    return Array3d(mean[0], mean[1], mean[2]);
  };
  return absorption_curves(thread, 14, seen, done);
}

std::optional<Srgb8> wanted_colour(const renderer::Motif& motif, std::size_t thread, const EmbroiderRequest& request) {
  if (!request.colours.empty()) return request.colours[thread % request.colours.size()];
  return motif.threads[thread].srgb;
}

// The digitized thread with the absorption that has the colour; with its own where no colour is wanted.
EmbroideredThread dyed_thread(const std::optional<Srgb8>& wanted, const ThreadFile& digitized,
                              const AbsorptionCurves& curves) {
  EmbroideredThread made;
  for (int c = 0; c < 3; ++c) made.sigma_a[static_cast<std::size_t>(c)] = digitized.parameters.sigma_a[c];
  if (!wanted) return made;
  const ColouredThread coloured = coloured_thread(digitized, curves, *wanted);
  for (int c = 0; c < 3; ++c) made.sigma_a[static_cast<std::size_t>(c)] = coloured.parameters.sigma_a[c];
  made.wanted = *wanted;
  made.delta_e_2000 = made.by_curve_delta_e_2000 = coloured.delta_e_2000;
  made.out_of_gamut = coloured.delta_e_2000 > kInGamut;
  return made;
}

std::filesystem::path sewn_scene_of(const std::filesystem::path& picture) {
  return std::filesystem::path(picture).replace_extension(".json");
}

// A scene to sew on, as it is before the work.
struct ReadyScene {
  nlohmann::json document;
  std::vector<BuiltCloth> cloths;
};

// Asked before the work: that the scene can be read and built and has the cloth, and that it is not written over.
ReadyScene ready_scene(const EmbroiderRequest& request, ProgressDisplay& progress) {
  nlohmann::json document = read_json_file(request.scene);
  const SceneFile scene = parse_scene(document, request.scene.string(), request.scene.parent_path());
  const auto count = static_cast<int>(scene.cloths.size());
  if (request.cloth < 0 || request.cloth >= count)
    throw std::runtime_error(request.scene.string() + ": cloth " + std::to_string(request.cloth) +
                             " was asked for, the scene has " + std::to_string(count) + " (counted from 0)");
  std::error_code none;
  if (std::filesystem::equivalent(sewn_scene_of(request.out), request.scene, none))
    throw std::runtime_error(request.out.string() + ": the scene of it would be written over " +
                             request.scene.string() + "; choose another name");
  return {std::move(document), build_cloths(scene, progress)};
}

// The scene with the motif on its cloth, beside the picture, and the picture of it.
void render_on_scene(const EmbroiderRequest& request, const Embroidery& embroidery, ReadyScene ready) {
  const std::filesystem::path file = sewn_scene_of(request.out),
                              folder = file.has_parent_path() ? file.parent_path() : ".";
  nlohmann::json scene = moved_scene(std::move(ready.document), request.scene.parent_path(), folder);
  nlohmann::json absorptions = nlohmann::json::array();
  for (const EmbroideredThread& thread : embroidery.threads) absorptions.push_back(thread.sigma_a);
  nlohmann::json sewn{{"cloth", request.cloth},
                      {"motif", name_from(folder, request.motif)},
                      {"thread", scene["threads"].size()},
                      {"diameter_mm", request.diameter_mm},
                      {"sigma_a", absorptions},
                      {"turn_deg", request.turn_deg}};
  if (request.at_mm) sewn["at_mm"] = {request.at_mm->x(), request.at_mm->y()};
  scene["threads"].push_back(name_from(folder, request.thread));
  scene["embroideries"].push_back(sewn);
  write_json_file(file, scene);
  render_scene({.scene = file,
                .out = request.out,
                .samples_per_pixel = request.samples_per_pixel,
                .seed = request.seed,
                .progress = request.progress_style},
               std::move(ready.cloths));
}

std::vector<EmbroideredThread> embroidered_threads(const renderer::Motif& motif,
                                                   const renderer::MotifMeasures& measures, const ThreadFile& digitized,
                                                   const AbsorptionCurves& curves, const EmbroiderRequest& request) {
  std::vector<EmbroideredThread> threads;
  for (std::size_t i = 0; i < motif.threads.size(); ++i) {
    EmbroideredThread made = dyed_thread(wanted_colour(motif, i, request), digitized, curves);
    made.name = motif.threads[i].name;
    made.stitches = measures.stitches_of_threads[i];
    made.length_mm = measures.lengths_mm[i];
    threads.push_back(made);
  }
  return threads;
}

std::vector<renderer::ThreadParameters> scattering_of(const std::vector<EmbroideredThread>& threads,
                                                      const ThreadFile& digitized) {
  std::vector<renderer::ThreadParameters> scattering;
  for (const EmbroideredThread& thread : threads) {
    scattering.push_back(digitized.parameters);
    for (int c = 0; c < 3; ++c) scattering.back().sigma_a[c] = thread.sigma_a[static_cast<std::size_t>(c)];
  }
  return scattering;
}

// Moves the threads' absorptions to what shows their colours on the motif.
void fit_on_motif(std::vector<EmbroideredThread>& threads, const renderer::Motif& motif, const ThreadFile& digitized,
                  const AbsorptionCurves& curves, const EmbroiderRequest& request, const renderer::Camera& camera,
                  const Array3d& ground, const std::function<void(double)>& done) {
  const Eigen::Matrix3d to_srgb = matrix_of(digitized.linear_srgb_from_camera);
  MotifColourRequest fit{.threads = scattering_of(threads, digitized),
                         .wanted = {},
                         .scene =
                             [&](const std::vector<renderer::ThreadParameters>& coloured) {
                               return scene_of(motif, coloured, request.diameter_mm, ground);
                             },
                         .thread_of_set = {},
                         .camera = camera,
                         .seed = request.seed,
                         .done = done};
  const renderer::StitchCurves stitches = renderer::stitch_curves(motif, request.diameter_mm);
  for (std::size_t k = 0; k < threads.size(); ++k) {
    fit.wanted.emplace_back();
    if (const auto wanted = wanted_colour(motif, k, request))
      fit.wanted[k] = (to_srgb.inverse() * linear_of(*wanted)).array();
    if (!stitches.threads[k].segments.empty()) fit.thread_of_set.push_back(k);
  }
  const MotifColours found = fit_motif_colours(fit, curves);
  for (std::size_t k = 0; k < threads.size(); ++k) {
    if (!fit.wanted[k] || !found.seen[k]) continue;
    EmbroideredThread& thread = threads[k];
    for (int c = 0; c < 3; ++c) thread.sigma_a[static_cast<std::size_t>(c)] = found.threads[k].sigma_a[c];
    const Vector3d wanted = calibration::lab_of_linear_srgb(linear_of(thread.wanted));
    const auto off = [&](const Array3d& seen) {
      return calibration::delta_e_2000(wanted, calibration::lab_of_linear_srgb((to_srgb * seen.matrix()).cwiseMax(0)));
    };
    thread.delta_e_2000 = off(*found.seen[k]);
    thread.by_curve_delta_e_2000 = off(*found.by_curve[k]);
  }
}

void write_reflectance(const std::filesystem::path& file, const cv::Mat3f& image, const std::string& motif,
                       const ThreadFile& digitized) {
  if (file.extension() == ".exr")
    renderer::write_exr(file, image,
                        {{"threadstation/content", "linear camera RGB, reflectance under even light"},
                         {"threadstation/motif", motif},
                         {"threadstation/software", software_version()}});
  else
    renderer::write_png(file, display(image, 1, digitized.linear_srgb_from_camera));
}

}  // namespace

Embroidery embroider(const EmbroiderRequest& request) {
  watch_interrupts();
  check_picture_destination(request.out);
  const renderer::Motif motif = read_motif(request.motif);
  const ThreadFile digitized = read_thread(request.thread);
  const renderer::MotifMeasures measures = renderer::measure(motif);
  const Vector2d margin = Vector2d::Constant(3 * request.diameter_mm);
  const renderer::Camera camera = camera_above(measures.low - margin, measures.high + margin, request.pixels_per_mm);
  ProgressDisplay progress("embroider", request.progress_style);
  ReadyScene scene;
  if (!request.scene.empty()) scene = ready_scene(request, progress);
  const Eigen::Matrix3d to_camera = matrix_of(digitized.linear_srgb_from_camera).inverse();
  const Array3d ground = (to_camera * linear_of(request.ground)).cwiseMax(0).cwiseMin(1).array();
  int shown = -1;
  const auto show = [&](double percent, const char* what) {
    if (static_cast<int>(percent) != shown) progress.show(shown = static_cast<int>(percent), 100, what);
  };
  const auto curves =
      curves_of_satin(digitized.parameters, request.diameter_mm, ground, request.seed,
                      [&](double share) { show(kCurveShare * share, "what absorption makes of the thread"); });
  Embroidery embroidery{.name = motif.name,
                        .width_mm = measures.high.x() - measures.low.x(),
                        .height_mm = measures.high.y() - measures.low.y(),
                        .threads = embroidered_threads(motif, measures, digitized, curves, request),
                        .image = request.out.string()};
  if (!request.by_curve_only)
    fit_on_motif(embroidery.threads, motif, digitized, curves, request, camera, ground,
                 [&](double share) { show(kCurveShare + kFitShare * share, "the motif's colours"); });
  if (!request.scene.empty()) {
    progress.finish("sewing on " + request.scene.string());
    render_on_scene(request, embroidery, std::move(scene));
    return embroidery;
  }
  const renderer::PathTracer tracer(
      scene_of(motif, scattering_of(embroidery.threads, digitized), request.diameter_mm, ground));
  const cv::Mat3f image =
      tracer.render(camera, {.samples_per_pixel = request.samples_per_pixel.value_or(kSamplesPerPixel),
                             .seed = request.seed,
                             .progress = [&](double share) {
                               constexpr double kBegun = kCurveShare + kFitShare;
                               show(kBegun + (100 - kBegun) * share, "rendering");
                               return !interrupted();
                             }});
  write_reflectance(request.out, image, motif.name, digitized);
  progress.finish(request.out.string());
  return embroidery;
}

std::string describe(const Embroidery& embroidery) {
  char line[200];
  std::snprintf(line, sizeof line,
                "\"%s\", %.1f x %.1f mm\nthread                 colour   stitches   length m   sigma_a"
                "                 CIEDE2000  by curve\n",
                embroidery.name.c_str(), embroidery.width_mm, embroidery.height_mm);
  std::string text = line;
  for (const EmbroideredThread& of : embroidery.threads) {
    std::snprintf(line, sizeof line, "%-22s #%02x%02x%02x  %8d   %8.2f   %6.3f %6.3f %6.3f   %9.2f  %8.2f%s\n",
                  of.name.c_str(), of.wanted[0], of.wanted[1], of.wanted[2], of.stitches, of.length_mm / 1000,
                  of.sigma_a[0], of.sigma_a[1], of.sigma_a[2], of.delta_e_2000, of.by_curve_delta_e_2000,
                  of.out_of_gamut ? "  (out of gamut)" : "");
    text += line;
  }
  return text;
}

nlohmann::json to_json(const Embroidery& embroidery) {
  nlohmann::json threads = nlohmann::json::array();
  for (const EmbroideredThread& of : embroidery.threads)
    threads.push_back({{"name", of.name},
                       {"srgb", of.wanted},
                       {"sigma_a", of.sigma_a},
                       {"delta_e_2000", of.delta_e_2000},
                       {"by_curve_delta_e_2000", of.by_curve_delta_e_2000},
                       {"out_of_gamut", of.out_of_gamut},
                       {"stitches", of.stitches},
                       {"length_mm", of.length_mm}});
  return {{"motif", embroidery.name},
          {"width_mm", embroidery.width_mm},
          {"height_mm", embroidery.height_mm},
          {"threads", threads},
          {"image", embroidery.image}};
}

}  // namespace station
