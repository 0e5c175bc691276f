#include "station/cloth/patch_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "renderer/picture/camera.h"
#include "renderer/picture/image_file.h"
#include "renderer/scene/cloth_shape.h"
#include "renderer/scene/patch_curves.h"
#include "renderer/trace/ray_scene.h"
#include "station/documents/draft_drawing.h"
#include "station/documents/reader.h"
#include "station/thread/thread_colour.h"

namespace station {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using renderer::Yarn;
using renderer::YarnPatch;

constexpr int kSubpixels = 3, kLeastYarns = 8;
constexpr float kAmbient = 0.2f, kShadow = 0.4f;  // shares of the light

cv::Vec3f color_of(int thread, const ThreadColours& colours) {
  return renderer::linear_of_srgb(thread_color(thread, colours));
}

YarnPatch with_two_threads(YarnPatch patch) {
  if (renderer::threads_of(patch).size() > 1) return patch;
  for (Yarn& yarn : patch.yarns) yarn.thread = yarn.warp ? 0 : 1;
  return patch;
}

// Side of the square of cloth that is shown: whole repeats, and yarns enough to see the weave.
double shown_mm(const YarnPatch& patch) {
  double warp = 0, weft = 0;
  for (const Yarn& yarn : patch.yarns) ++(yarn.warp ? warp : weft);
  const double pitch = std::max(patch.period_x_mm / std::max(warp, 1.0), patch.period_y_mm / std::max(weft, 1.0));
  return std::max({patch.period_x_mm, patch.period_y_mm, kLeastYarns * pitch});
}

class ShadedCloth {
 public:
  ShadedCloth(const YarnPatch& patch, double side_mm, const ThreadColours& colours)
      : scene_(cloth_scene(patch, side_mm)), colours_(colours) {}

  cv::Vec3f seen_along(const Vector3d& origin, const Vector3d& direction) const {
    const auto hit = scene_.intersect({origin.cast<float>(), direction.cast<float>()});
    if (!hit) return {1, 1, 1};
    const auto& point = std::get<renderer::CurvePoint>(hit->point);
    const Eigen::Vector3f light = Eigen::Vector3f(-0.45f, 0.45f, 0.9f).normalized();
    const float facing = std::max(0.0f, point.normal.dot(light));
    const bool shaded = facing > 0 && scene_.occluded({point.position, light}, 1e3f);
    return (kAmbient + (1 - kAmbient) * facing * (shaded ? kShadow : 1)) *
           color_of(static_cast<int>(point.curve_set), colours_);
  }

  template <typename RayAt>
  cv::Mat3f picture(int size_px, RayAt&& ray_at) const {
    cv::Mat3f picture(size_px, size_px, cv::Vec3f(0, 0, 0));
    for (int row = 0; row < size_px; ++row) {
      for (int column = 0; column < size_px; ++column) {
        for (int s = 0; s < kSubpixels * kSubpixels; ++s) {
          const double x = column + (s % kSubpixels + 0.5) / kSubpixels, y = row + (s / kSubpixels + 0.5) / kSubpixels;
          const renderer::CameraRay ray = ray_at(x / size_px, y / size_px);
          picture(row, column) += seen_along(ray.origin, ray.direction) / (kSubpixels * kSubpixels);
        }
      }
    }
    return picture;
  }

 private:
  static renderer::RayScene cloth_scene(const YarnPatch& patch, double side_mm) {
    const int threads = renderer::threads_of(patch).back() + 1;
    renderer::Scene scene;
    scene.cloths.push_back(
        {.surface = surface_of(renderer::SwatchShape{side_mm, side_mm}, patch, Eigen::Isometry3d::Identity()),
         .patch = patch,
         .threads = std::vector<renderer::ScatteringModel>(static_cast<std::size_t>(threads))});
    return renderer::RayScene(std::move(scene));
  }

  renderer::RayScene scene_;
  const ThreadColours& colours_;
};

// The cut surfaces of all yarns at the height y of the first pick: each yarn is the union of ellipsoids along its line.
cv::Mat3f section(const YarnPatch& patch, double width_mm, int width_px, const ThreadColours& colours) {
  const double scale = width_px / width_mm,
               cut_mm = center_line(patch, *std::find_if(patch.yarns.begin(), patch.yarns.end(),
                                                         [](const Yarn&yarn) { return !yarn.warp; }))
                            .control_points.front()
                            .y();
  const int height_px = static_cast<int>(std::ceil(1.2 * patch.thickness_mm * scale)) + 4;
  cv::Mat3f picture(height_px, width_px, cv::Vec3f(1, 1, 1));
  constexpr int kSteps = 24, kShift = 8;
  for (const Yarn& yarn : patch.yarns) {
    const renderer::PeriodicSpline line = center_line(patch, yarn);
    for (std::size_t i = 0; i < line.control_points.size() * kSteps; ++i) {
      const double t = static_cast<double>(i) / kSteps, thick = thickness(yarn, t), wide = half_width(yarn) * thick,
                   high = half_height(yarn) * thick, along_cut = yarn.warp ? wide : high,
                   across_cut = yarn.warp ? high : wide;
      const Vector3d at = spline_value(line, t);
      const double off = std::remainder(at.y() - cut_mm, patch.period_y_mm) / across_cut;
      if (std::abs(off) >= 1) continue;
      const double share = std::sqrt(1 - off * off);
      const double first = at.x() - std::floor(at.x() / patch.period_x_mm + 1) * patch.period_x_mm;
      for (double x = first; x < width_mm + patch.period_x_mm; x += patch.period_x_mm) {
        const auto fixed = [](double px) { return static_cast<int>(std::lround(px * (1 << kShift))); };
        cv::ellipse(picture, cv::Point(fixed(x * scale), fixed(height_px / 2.0 - at.z() * scale)),
                    cv::Size(fixed(along_cut * share * scale), fixed(high * share * scale)), 0, 0, 360,
                    color_of(thread_of_segment(yarn, static_cast<int>(i) / kSteps), colours), cv::FILLED, cv::LINE_8,
                    kShift);
      }
    }
  }
  return picture;
}

}  // namespace

cv::Mat3f draw_patch(const YarnPatch& original, const ThreadColours& colours, int panel_px) {
  const YarnPatch patch = with_two_threads(original);
  const double side = shown_mm(patch), up = patch.thickness_mm + side;
  const ShadedCloth cloth(patch, side, colours);
  const cv::Mat3f above = cloth.picture(panel_px, [&](double x, double y) {
    return renderer::CameraRay{{(x - 0.5) * side, (0.5 - y) * side, up}, -Vector3d::UnitZ()};
  });
  const Vector3d eye = Vector3d(-0.5, -1.5, 1.1) * side;
  renderer::Camera camera = renderer::look_at(eye, {0, -0.05 * side, 0}, Vector3d::UnitZ());
  camera.fx = camera.fy = 1.3;  // the picture is 1 wide
  camera.cx = camera.cy = 0.5;
  const cv::Mat3f perspective =
      cloth.picture(panel_px, [&](double x, double y) { return renderer::ray_through(camera, x, y); });
  cv::Mat3f both, all;
  cv::hconcat(above, perspective, both);
  const cv::Mat3f fine = section(patch, 2 * side, 2 * panel_px * kSubpixels, colours);
  cv::Mat3f cut;
  cv::resize(fine, cut, {2 * panel_px, fine.rows / kSubpixels}, 0, 0, cv::INTER_AREA);
  cv::vconcat(both, cut, all);
  return all;
}

void write_patch_picture(const std::filesystem::path& file, const renderer::YarnPatch& patch,
                         const ThreadColours& colours) {
  const std::string kind = file.extension().string();
  if (kind != ".png" && kind != ".exr")
    throw std::runtime_error(file.string() + ": a view is a .png or an .exr file; change the name");
  const cv::Mat3f picture = draw_patch(patch, colours);
  if (kind == ".exr")
    renderer::write_exr(file, picture, {{"threadstation/content", "linear sRGB, plain shading"}});
  else
    renderer::write_png(file, renderer::encode_srgb(picture, 1));
}

ThreadColours colours_of_threads(const std::vector<std::filesystem::path>& files) {
  ThreadColours colours;
  for (const std::filesystem::path& file : files) {
    const bool bundle = read_json_file(file).value("format", "") == "threadstation/bundle";
    if (bundle) {
      colours.push_back(thread_color(static_cast<int>(colours.size())));
      continue;
    }
    const Eigen::Vector3f linear = colour_of(read_thread(file)).linear_srgb.cast<float>();
    const cv::Mat3f one(1, 1, cv::Vec3f(linear[0], linear[1], linear[2]));
    colours.push_back(renderer::encode_srgb(one, 1)(0, 0));
  }
  return colours;
}

}  // namespace station
