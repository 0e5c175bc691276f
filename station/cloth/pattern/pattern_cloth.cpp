#include "station/cloth/pattern/pattern_cloth.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "inversion/texture/texture_fit.h"
#include "renderer/picture/image_file.h"
#include "station/cloth/pattern/flat_scene.h"
#include "station/cloth/pattern/picture_of_crossings.h"
#include "station/cloth/render/build_scene.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/matrix_rows.h"
#include "station/documents/reader.h"
#include "station/documents/scene_names.h"
#include "station/documents/session_file.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

cv::Mat3f transformed(const cv::Mat3f& colours, const Eigen::Matrix3d& matrix) {
  const Eigen::Matrix3f m = matrix.cast<float>();
  cv::Mat3f result(colours.size());
  result.forEach([&](cv::Vec3f& to, const int* at) {
    const cv::Vec3f& from = colours(at[0], at[1]);
    const Eigen::Vector3f made = m * Eigen::Vector3f(from[0], from[1], from[2]);
    to = {made[0], made[1], made[2]};
  });
  return result;
}

ColourError summed_up(const cv::Mat1f& errors, const cv::Mat1b& counted) {
  std::vector<float> values;
  double sum = 0;
  for (int row = 0; row < errors.rows; ++row)
    for (int column = 0; column < errors.cols; ++column)
      if (counted(row, column)) {
        values.push_back(errors(row, column));
        sum += static_cast<double>(errors(row, column));
      }
  if (values.empty()) return {};
  const auto rank = values.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), rank, values.end());
  return {sum / static_cast<double>(values.size()), static_cast<double>(*rank)};
}

// The scene that is asked for, as a document and the folder that its names are relative to.
struct Base {
  json document;
  std::string source;
  fs::path folder;
};

Base base_of(const PatternRequest& request) {
  const bool cloth = !request.thread.empty() && !request.draft.empty();
  if (request.scene.empty() != cloth || (!request.scene.empty() && !(request.thread.empty() && request.draft.empty())))
    throw std::runtime_error(
        "a pattern needs either a thread and a draft, or a scene with a cloth; give one of the two");
  if (cloth) return {flat_scene(request.thread, request.draft, {1, 1}, "."), request.draft.string(), "."};
  return {read_json_file(request.scene), request.scene.string(), request.scene.parent_path()};
}

// Warp ends and weft picks in the cloth's patch.
Eigen::Vector2i crossings_of(const SceneCloth& cloth) {
  if (const auto* draft = std::get_if<renderer::Draft>(&cloth.weave))
    return {renderer::ends_in_patch(*draft), renderer::picks_in_patch(*draft)};
  const auto& yarns = std::get<renderer::YarnPatch>(cloth.weave).yarns;
  const auto warp = static_cast<int>(std::ranges::count(yarns, true, &renderer::Yarn::warp));
  return {warp, static_cast<int>(yarns.size()) - warp};
}

std::vector<renderer::ThreadParameters> threads_of(const SceneFile& scene, const PatternRequest& request) {
  std::vector<renderer::ThreadParameters> threads;
  for (const renderer::ScatteringModel& model : scene.threads) {
    const auto* thread = std::get_if<renderer::ThreadParameters>(&model);
    if (!thread)
      throw std::runtime_error((request.scene.empty() ? request.thread : request.scene).string() +
                               ": pictures are woven by the absorption of threads, and a bundle file was given; give "
                               "the thread file of the same spool");
    threads.push_back(*thread);
  }
  return threads;
}

inversion::TexturedCloth cloth_of(const SceneFile& scene, const PatternRequest& request, ProgressDisplay& progress) {
  const auto count = static_cast<int>(scene.cloths.size());
  if (request.cloth < 0 || request.cloth >= count)
    throw std::runtime_error(request.scene.string() + ": cloth " + std::to_string(request.cloth) +
                             " was asked for, the scene has " + std::to_string(count) + " (counted from 0)");
  const auto place = static_cast<std::size_t>(request.cloth);
  if (!scene.cloths[place].two_scale)
    throw std::runtime_error(request.scene.string() +
                             ": the cloth is rendered by brute force, which shows no pictures; leave its method out");
  return {woven_cloth(scene, place, progress), crossings_of(scene.cloths[place]), threads_of(scene, request)};
}

// A sheet of panels beside each other: pictures, a map of errors (white: a CIEDE2000 of 20), a mask.
cv::Mat3b sheet(const std::vector<cv::Mat3f>& pictures, const cv::Mat1f& errors, const cv::Mat1b& mask,
                double crossing_height) {
  constexpr double kWhiteError = 20;
  std::vector<cv::Mat> panels;
  for (const cv::Mat3f& picture : pictures)
    panels.push_back(panel_of(renderer::encode_srgb(picture, 1), crossing_height));
  cv::Mat1b error_map;
  errors.convertTo(error_map, CV_8U, 255 / kWhiteError);
  for (const cv::Mat1b& grey : {error_map, mask}) {
    cv::Mat3b colour;
    cv::cvtColor(grey, colour, cv::COLOR_GRAY2RGB);
    panels.push_back(panel_of(colour, crossing_height));
  }
  cv::Mat3b all;
  cv::hconcat(panels, all);
  return all;
}

}  // namespace

Pattern weave_pattern(const PatternRequest& request) {
  watch_interrupts();
  Base base = base_of(request);
  const SceneFile scene = parse_scene(base.document, base.source, base.folder);
  ProgressDisplay progress("pattern", request.progress_style);
  const inversion::TexturedCloth woven = cloth_of(scene, request, progress);
  const cv::Mat3f picture = picture_of_crossings(request.image, request.ends, request.brightness, woven.crossing_mm());
  make_folder(request.out);
  const Eigen::Matrix3d to_srgb = matrix_of(scene.linear_srgb_from_camera);
  int shown = -1;
  const auto show = [&](double share) {
    const int percent = static_cast<int>(100 * share);
    if (percent != shown) progress.show(shown = percent, 100, "absorption of the crossings");
    return !interrupted();
  };
  const inversion::TextureFit fit = inversion::fit_texture(
      woven, transformed(picture, to_srgb.inverse()),
      {.within_gamut = request.within_gamut, .steps = request.steps, .seed = request.seed, .progress = show});

  const cv::Mat3f by_curves = transformed(fit.curve_reflectance, to_srgb),
                  refined = transformed(fit.refined_reflectance, to_srgb), asked = transformed(fit.asked, to_srgb);
  const cv::Mat1f errors = colour_errors(refined, asked);
  const cv::Mat1b everywhere(picture.size(), uchar{255}), counted = request.within_gamut ? everywhere : fit.in_gamut;
  const Eigen::Vector2d size_mm = woven.crossing_mm().cwiseProduct(Eigen::Vector2d(picture.cols, picture.rows));
  const Pattern pattern{
      .ends = picture.cols,
      .picks = picture.rows,
      .width_mm = size_mm.x(),
      .height_mm = size_mm.y(),
      .out_of_gamut = 1 - static_cast<double>(cv::countNonZero(fit.in_gamut)) / static_cast<double>(picture.total()),
      .by_curves = summed_up(colour_errors(by_curves, asked), counted),
      .refined = summed_up(errors, counted),
      .by_curves_of_picture = summed_up(colour_errors(by_curves, picture), everywhere),
      .refined_of_picture = summed_up(colour_errors(refined, picture), everywhere)};

  renderer::write_exr(request.out / "absorption.exr", fit.refined.sigma_a,
                      {{"threadstation/content", "sigma_a per thread radius, camera RGB, a texel per crossing"},
                       {"threadstation/picture", request.image.filename().string()},
                       {"threadstation/software", software_version()}});
  renderer::write_exr(request.out / "asked.exr", fit.asked,
                      {{"threadstation/content", "reflectance under even light, camera RGB, a pixel per crossing"},
                       {"threadstation/picture", request.image.filename().string()},
                       {"threadstation/software", software_version()}});
  renderer::write_png(request.out / "pattern.png", sheet({picture, asked, by_curves, refined}, errors, fit.in_gamut,
                                                         fit.refined.texel_mm.y() / fit.refined.texel_mm.x()));
  if (request.scene.empty()) base.document = flat_scene(request.thread, request.draft, size_mm, base.folder);
  base.document = moved_scene(base.document, base.folder, request.out);
  base.document["cloths"][static_cast<std::size_t>(request.cloth)]["absorption"] = {
      {"file", "absorption.exr"}, {"texel_mm", {fit.refined.texel_mm.x(), fit.refined.texel_mm.y()}}};
  write_json_file(request.out / "scene.json", base.document);
  write_json_file(request.out / "pattern.json", to_json(pattern));
  progress.finish(request.out.string());
  return pattern;
}

std::string describe(const Pattern& pattern) {
  char text[600];
  std::snprintf(text, sizeof text,
                "%d ends x %d picks, %.1f x %.1f mm\n"
                "%.2f %% of the picture is out of the thread's gamut\n"
                "CIEDE2000                      by the curves    refined\n"
                "to what was asked for, mean       %10.2f %10.2f\n"
                "                       95 %%        %10.2f %10.2f\n"
                "to the picture,        mean       %10.2f %10.2f\n"
                "                       95 %%        %10.2f %10.2f\n",
                pattern.ends, pattern.picks, pattern.width_mm, pattern.height_mm, 100 * pattern.out_of_gamut,
                pattern.by_curves.mean, pattern.refined.mean, pattern.by_curves.percentile_95,
                pattern.refined.percentile_95, pattern.by_curves_of_picture.mean, pattern.refined_of_picture.mean,
                pattern.by_curves_of_picture.percentile_95, pattern.refined_of_picture.percentile_95);
  return text;
}

json to_json(const Pattern& pattern) {
  const auto error = [](const ColourError& of) { return json{{"mean", of.mean}, {"percentile_95", of.percentile_95}}; };
  return {{"format", "threadstation/pattern"},
          {"version", 1},
          {"ends", pattern.ends},
          {"picks", pattern.picks},
          {"width_mm", pattern.width_mm},
          {"height_mm", pattern.height_mm},
          {"out_of_gamut", pattern.out_of_gamut},
          {"delta_e_2000",
           {{"by_curves", error(pattern.by_curves)},
            {"refined", error(pattern.refined)},
            {"by_curves_of_picture", error(pattern.by_curves_of_picture)},
            {"refined_of_picture", error(pattern.refined_of_picture)}}}};
}

}  // namespace station
