#include "station/cloth/pattern/jacquard_cloth.h"

#include <Eigen/Dense>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "renderer/picture/image_file.h"
#include "renderer/scene/cloth_shape.h"
#include "renderer/trace/path_tracer.h"
#include "renderer/weave/woven_patch.h"
#include "station/cloth/pattern/flat_scene.h"
#include "station/cloth/pattern/picture_of_crossings.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/draft_file.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/scene_names.h"
#include "station/documents/thread_file.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

using Eigen::Vector3d;
using nlohmann::json;
using renderer::kSatinEnds;
using renderer::kShades;
namespace fs = std::filesystem;

using Shades = std::array<cv::Vec3f, kShades>;  // linear sRGB, weft-faced first

// The mean radiance (camera RGB) of an endless cloth of one shade, seen from above in light of 1 from everywhere.
cv::Scalar shade_radiance(renderer::Draft draft, int shade, const std::vector<renderer::ScatteringModel>& threads,
                          std::uint64_t seed) {
  constexpr int kPixels = 64, kSamples = 64, kPeriods = 7;  // the cloth has so many periods; the middle one is seen
  draft.warp_over = renderer::shaded_structure(cv::Mat1b(kSatinEnds, kSatinEnds, static_cast<uchar>(shade)));
  const renderer::YarnPatch patch = renderer::woven_patch(draft).patch;
  renderer::Scene scene;
  const renderer::SwatchShape swatch{kPeriods * patch.period_x_mm, kPeriods * patch.period_y_mm};
  scene.cloths.push_back(
      {renderer::surface_of(swatch, patch, Eigen::Isometry3d::Identity()), patch, threads, std::nullopt});
  scene.surroundings = renderer::EnvironmentLight{.radiance = cv::Mat3f(8, 16, cv::Vec3f(1, 1, 1))};
  const double eye_mm = 1e3 * patch.period_y_mm;
  renderer::Camera camera = renderer::look_at({0, 0, eye_mm}, {0, 0, 0}, {0, 1, 0});
  camera.width = camera.height = kPixels;
  camera.fx = kPixels * eye_mm / patch.period_x_mm, camera.fy = kPixels * eye_mm / patch.period_y_mm;
  camera.cx = camera.cy = (kPixels - 1) / 2.0;
  return cv::mean(renderer::PathTracer(scene).render(camera, {.samples_per_pixel = kSamples, .seed = seed}));
}

cv::Vec3f linear_srgb_of(const cv::Scalar& camera_rgb, const std::array<double, 9>& matrix) {
  cv::Vec3f linear;
  for (std::size_t c = 0; c < 3; ++c)
    linear[static_cast<int>(c)] = static_cast<float>(matrix[3 * c] * camera_rgb[0] + matrix[3 * c + 1] * camera_rgb[1] +
                                                     matrix[3 * c + 2] * camera_rgb[2]);
  return linear;
}

int nearest(const Shades& shades, const cv::Vec3f& colour) {
  const auto away = [&](const cv::Vec3f& shade) { return cv::norm(shade - colour); };
  return 1 +
         static_cast<int>(std::min_element(shades.begin(), shades.end(),
                                           [&](const cv::Vec3f& a, const cv::Vec3f& b) { return away(a) < away(b); }) -
                          shades.begin());
}

// The picture with its tones moved onto the line from the first to the last shade: its own range of tones, without the
// outermost fiftieths, becomes the range between the two.
cv::Mat3f toned(const cv::Mat3f& picture, const Shades& shades) {
  constexpr double kOutermost = 0.02;
  const cv::Vec3f whole = shades.back() - shades.front();
  std::vector<double> tones;
  for (const cv::Vec3f& colour : picture) tones.push_back((colour - shades.front()).dot(whole));
  std::vector<double> sorted = tones;
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double share) {
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  };
  const double low = at(kOutermost), range = std::max(1e-12, at(1 - kOutermost) - low);
  cv::Mat3f wanted(picture.size());
  std::transform(tones.begin(), tones.end(), wanted.begin(), [&](double tone) {
    return shades.front() + static_cast<float>(std::clamp((tone - low) / range, 0.0, 1.0)) * whole;
  });
  return wanted;
}

cv::Mat1b shades_of(const cv::Mat3f& picture, const Shades& shades) {
  cv::Mat3f wanted = toned(picture, shades);
  cv::Mat1b chosen(picture.size());
  for (int row = 0; row < picture.rows; ++row)
    for (int column = 0; column < picture.cols; ++column) {
      const int shade = nearest(shades, wanted(row, column));
      chosen(row, column) = static_cast<uchar>(shade);
      const cv::Vec3f error = wanted(row, column) - shades[static_cast<std::size_t>(shade - 1)];
      const auto pass = [&](int down, int right, float share) {
        if (row + down < picture.rows && column + right >= 0 && column + right < picture.cols)
          wanted(row + down, column + right) += share * error;
      };
      pass(0, 1, 7 / 16.0F), pass(1, -1, 3 / 16.0F), pass(1, 0, 5 / 16.0F), pass(1, 1, 1 / 16.0F);
    }
  return chosen;
}

// The mean colour error over squares of about a satin's repeat, which the eye takes together.
double mean_error(const cv::Mat3f& shown, const cv::Mat3f& picture) {
  const cv::Size blocks(std::max(1, picture.cols / kSatinEnds), std::max(1, picture.rows / kSatinEnds));
  cv::Mat3f a, b;
  cv::resize(shown, a, blocks, 0, 0, cv::INTER_AREA);
  cv::resize(picture, b, blocks, 0, 0, cv::INTER_AREA);
  return cv::mean(colour_errors(a, b))[0];
}

}  // namespace

Jacquard weave_jacquard(const JacquardRequest& request) {
  watch_interrupts();
  const ThreadFile warp = read_thread(request.warp_thread), weft = read_thread(request.weft_thread);
  renderer::Draft draft = read_draft(request.draft);
  draft.warp.threads = {0}, draft.weft.threads = {1};
  draft.free_periods = false, draft.transverse_modulus_n_mm2 = 0, draft.relaxed = false;
  draft.name = "jacquard of " + request.image.filename().string();
  const cv::Mat3f picture =
      picture_of_crossings(request.image, request.ends, request.brightness, {draft.warp.pitch_mm, draft.weft.pitch_mm},
                           renderer::kMostUnrelaxedCrossings);
  make_folder(request.out);
  ProgressDisplay progress("jacquard", request.progress_style);
  Jacquard jacquard{.ends = picture.cols,
                    .picks = picture.rows,
                    .width_mm = picture.cols * draft.warp.pitch_mm,
                    .height_mm = picture.rows * draft.weft.pitch_mm};
  Shades shades;
  for (int shade = 1; shade <= kShades; ++shade) {
    progress.show(shade - 1, kShades, "colours of the satins");
    const auto number = static_cast<std::size_t>(shade - 1);
    shades[number] = linear_srgb_of(shade_radiance(draft, shade, {warp.parameters, weft.parameters}, request.seed),
                                    warp.linear_srgb_from_camera);
    for (std::size_t c = 0; c < 3; ++c)
      jacquard.shades[number][c] = static_cast<double>(shades[number][static_cast<int>(c)]);
    if (interrupted()) throw std::runtime_error("the jacquard was stopped on request; start it again");
  }
  const cv::Mat1b chosen = shades_of(picture, shades);
  cv::Mat3f shown(picture.size());
  std::transform(chosen.begin(), chosen.end(), shown.begin(),
                 [&](uchar shade) { return shades[static_cast<std::size_t>(shade - 1)]; });
  jacquard.delta_e_2000 = mean_error(shown, picture);
  draft.warp_over = renderer::shaded_structure(chosen);
  if (const auto problem = renderer::check_draft(draft))
    throw std::runtime_error(request.image.string() + ": " + *problem);

  write_json_file(request.out / "draft.json", to_json(draft));
  json scene =
      flat_scene(request.warp_thread, request.out / "draft.json", {jacquard.width_mm, jacquard.height_mm}, request.out);
  scene["threads"].push_back(name_from(request.out, request.weft_thread));
  write_json_file(request.out / "scene.json", scene);
  cv::Mat3b sheet;
  const double crossing_height = draft.weft.pitch_mm / draft.warp.pitch_mm;
  cv::hconcat(panel_of(renderer::encode_srgb(picture, 1), crossing_height),
              panel_of(renderer::encode_srgb(shown, 1), crossing_height), sheet);
  renderer::write_png(request.out / "jacquard.png", sheet);
  write_json_file(request.out / "jacquard.json", to_json(jacquard));
  progress.finish(request.out.string());
  return jacquard;
}

std::string describe(const Jacquard& jacquard) {
  return formatted("%d ends x %d picks, %.1f x %.1f mm\nCIEDE2000 %.2f on average over squares of %d x %d crossings\n",
                   jacquard.ends, jacquard.picks, jacquard.width_mm, jacquard.height_mm, jacquard.delta_e_2000,
                   kSatinEnds, kSatinEnds);
}

json to_json(const Jacquard& jacquard) {
  return {{"format", "threadstation/jacquard"},
          {"version", 1},
          {"ends", jacquard.ends},
          {"picks", jacquard.picks},
          {"width_mm", jacquard.width_mm},
          {"height_mm", jacquard.height_mm},
          {"shades_linear_srgb", jacquard.shades},
          {"delta_e_2000", jacquard.delta_e_2000}};
}

}  // namespace station
