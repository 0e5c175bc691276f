#include "station/cloth/export/cloth_sheet.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "renderer/picture/image_file.h"
#include "station/output/compare/compare_pictures.h"
#include "station/output/display.h"
#include "station/output/plot.h"

namespace station {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

constexpr int kPanel_px = 256, kBlock_px = 8;

struct View {
  std::string name;
  Vector3d to_view;
  std::optional<Vector3d> to_light;  // none: even light on the viewer's side
};

std::vector<View> views() {
  const Vector3d straight = Vector3d::UnitZ();
  return {
      {"even light, seen straight on", straight, std::nullopt},
      {"light 45 deg along the weft, seen straight on", straight, direction_at(45, 180)},
      {"light 45 deg along the weft, seen at 50 deg from the other side", direction_at(50, 0), direction_at(45, 180)},
      {"light 45 deg along the warp, seen at 50 deg from the other side", direction_at(50, 90), direction_at(45, 270)},
      {"light from behind at 30 deg, seen straight on", straight, direction_at(150, 45)}};
}

// Draws maps: each pixel is the average of shade(texel) at four places.
template <class Shade>
cv::Mat3f drawn_maps(const PbrMaps& maps, double normal_scale, const Eigen::Vector2d& period_mm,
                     const renderer::Camera& camera, const Shade& shade) {
  const std::vector<PbrTexel> texels = texels_of(maps, normal_scale);
  const int columns = maps.opacity.cols, rows = maps.opacity.rows;
  const auto texel_at = [&](const renderer::CameraRay& ray) -> const PbrTexel& {
    const Vector3d at = ray.origin - ray.direction * (ray.origin.z() / ray.direction.z());
    const double u = at.x() / period_mm.x() + 0.5, v = 0.5 - at.y() / period_mm.y();
    const int column = std::min(columns - 1, static_cast<int>((u - std::floor(u)) * columns)),
              row = std::min(rows - 1, static_cast<int>((v - std::floor(v)) * rows));
    return texels[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
  };
  cv::Mat3f picture(camera.height, camera.width);
  picture.forEach([&](cv::Vec3f& pixel, const int* at) {
    Array3d sum = Array3d::Zero();
    for (const double dy : {-0.25, 0.25})
      for (const double dx : {-0.25, 0.25})
        sum += shade(texel_at(renderer::ray_through(camera, at[1] + dx, at[0] + dy))) / 4;
    pixel = color_of(sum);
  });
  return picture;
}

cv::Mat3f evenly_lit_maps(const PbrMaps& maps, const GltfShader& shader, const Eigen::Vector2d& period_mm,
                          const renderer::Camera& camera) {
  const EvenLight even(shader);
  return drawn_maps(maps, shader.material().normal_scale, period_mm, camera,
                    [&](const PbrTexel& texel) { return Array3d(texel.opacity * even.seen(texel).reflectance); });
}

// A sheet of rows of any width on white, each with its title above it.
class TitledRows {
 public:
  void add(const std::string& title, const cv::Mat3b& row) {
    rows_.push_back({title, row});
    width_ = std::max(width_, row.cols);
  }
  cv::Mat3b picture() const {
    constexpr int kTitle_px = 26;
    cv::Mat3b all;
    for (const auto& [title, row] : rows_) {
      cv::Mat3b strip(kTitle_px, width_, cv::Vec3b(255, 255, 255)), padded;
      cv::putText(strip, title, {6, 18}, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar(0, 0, 0), 1, cv::LINE_AA);
      cv::copyMakeBorder(row, padded, 0, 0, 0, width_ - row.cols, cv::BORDER_CONSTANT, cv::Scalar(255, 255, 255));
      all.push_back(strip);
      all.push_back(padded);
    }
    return all;
  }

 private:
  std::vector<std::pair<std::string, cv::Mat3b>> rows_;
  int width_ = 0;
};

// A scan of views in a plane through the cloth's normal; the light is in it at 45 degrees on the side of negative
// angles, in front or behind.
struct Scan {
  std::string title;
  std::vector<double> view_deg;
  std::vector<DirectionPair> pairs;
};

Scan scan(const std::string& title, double azimuth_deg, double light_deg) {
  Scan made{.title = title};
  for (double angle = -75; angle <= 75; angle += 15) {
    made.view_deg.push_back(angle);
    made.pairs.push_back({direction_at(std::abs(angle), angle < 0 ? azimuth_deg + 180 : azimuth_deg),
                          direction_at(light_deg, azimuth_deg + 180)});
  }
  return made;
}

double luminance(const Array3d& linear) {
  return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
}

cv::Mat3b curves(const ClothSample& cloth, const PbrMaps& maps, const GltfShader& shader, const SheetOptions& options,
                 int width_px) {
  const Scan scans[] = {scan("along the weft, light at -45 deg", 0, 45),
                        scan("along the warp, light at -45 deg", 90, 45),
                        scan("along the weft, light behind at -45 deg", 0, 135),
                        scan("along the warp, light behind at -45 deg", 90, 135)};
  const std::vector<PbrTexel> texels = texels_of(maps, shader.material().normal_scale);
  PlotSheet sheet{.columns = 2, .panel_width_px = width_px / 2, .panel_height_px = 260, .key_outside = false};
  double done = 0;
  for (const Scan& s : scans) {
    const std::vector<Array3d> measured =
        far_field(cloth, s.pairs,
                  {.samples_per_pair = options.samples_per_pair, .seed = options.seed, .progress = [&](double part) {
                     return options.progress((done + part) / static_cast<double>(std::size(scans)));
                   }});
    ++done;
    PlotLine original{.title = "cloth"}, exported{.title = "glTF", .style = PlotStyle::dashed};
    for (std::size_t i = 0; i < s.pairs.size(); ++i) {
      original.points.emplace_back(s.view_deg[i], luminance(measured[i]));
      exported.points.emplace_back(s.view_deg[i],
                                   luminance(mean_radiance(texels, shader, s.pairs[i].to_view, s.pairs[i].to_light)));
    }
    sheet.panels.push_back({.title = s.title,
                            .x_label = "view, degrees from the normal",
                            .y_label = "luminance",
                            .lines = {original, exported}});
  }
  const std::string png = draw(sheet, PlotFormat::png);
  return renderer::decode_png(png);
}

}  // namespace

cv::Mat3f shaded_maps(const PbrMaps& maps, const GltfShader& shader, const Eigen::Vector2d& period_mm,
                      const renderer::Camera& camera, const Vector3d& to_view, const Vector3d& to_light) {
  return drawn_maps(maps, shader.material().normal_scale, period_mm, camera,
                    [&](const PbrTexel& texel) { return radiance(texel, shader, to_view, to_light); });
}

double paths_of_sheet(const ClothSample& cloth, const SheetOptions& options) {
  constexpr double kCurves = 44;  // directions
  return static_cast<double>(views().size()) * bake_size(cloth, kPanel_px).area() * options.samples_per_pixel +
         kCurves * options.samples_per_pair;
}

ClothSheet draw_sheet(const ClothSample& cloth, const PbrMaps& maps, const GltfShader& shader,
                      const SheetOptions& options) {
  const Eigen::Vector2d period_mm(cloth.patch.period_x_mm, cloth.patch.period_y_mm);
  const cv::Size panel = bake_size(cloth, kPanel_px);
  const std::vector<View> all = views();
  const double steps = static_cast<double>(all.size()) + 1;
  const CompareOptions compared{.fit_scale = false, .block_px = kBlock_px};
  ClothSheet sheet;
  TitledRows rows;
  for (const View& view : all) {
    const bool along_x = std::abs(view.to_view.x()) > 1e-9;
    const cv::Size size = along_x ? cv::Size(panel.height, panel.width) : panel;
    const renderer::Camera camera = camera_of_period(cloth, view.to_view, size.width, size.height, kSheetPeriods);
    renderer::Scene scene = endless_cloth(cloth);
    if (view.to_light)
      scene.lights = {distant_light(*view.to_light)};
    else
      scene.surroundings = half_surroundings(true);
    const double done = static_cast<double>(sheet.views.size());
    const cv::Mat3f original = in_linear_srgb(
        cloth, render_or_stop(renderer::PathTracer(std::move(scene)), camera, options.samples_per_pixel, options.seed,
                              [&](double part) { return options.progress((done + part) / steps); }));
    const cv::Mat3f exported = view.to_light
                                   ? shaded_maps(maps, shader, period_mm, camera, view.to_view, *view.to_light)
                                   : evenly_lit_maps(maps, shader, period_mm, camera);
    if (!view.to_light) sheet.preview = display(original, display_scale(original), {1, 0, 0, 0, 1, 0, 0, 0, 1});
    const Comparison found = compare_pictures(original, exported, {}, compared);
    sheet.views.push_back({view.name, found.mean_delta_e, found.delta_e_95});
    char text[200];
    std::snprintf(text, sizeof text, "%s: CIEDE2000 %.1f, 95 %% below %.1f", view.name.c_str(), found.mean_delta_e,
                  found.delta_e_95);
    rows.add(text, comparison_picture(original, exported, {}, compared));
  }
  const double done = static_cast<double>(all.size());
  SheetOptions last = options;
  last.progress = [&](double part) { return options.progress((done + part) / steps); };
  rows.add("from afar: cloth and exported material", curves(cloth, maps, shader, last, 3 * kPanel_px));
  sheet.picture = rows.picture();
  return sheet;
}

nlohmann::json to_json(const ComparedView& view) {
  return {{"view", view.name}, {"mean_delta_e_2000", view.mean_delta_e}, {"delta_e_2000_95", view.delta_e_95}};
}

}  // namespace station
