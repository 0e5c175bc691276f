// A woven cloth as it is exported: flat, endless, of digitized threads. Frame: x along the weft, y along the warp, z
// towards the face; one period is [-width / 2, width / 2] x [-height / 2, height / 2].
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "renderer/scene/scene.h"
#include "renderer/trace/path_tracer.h"
#include "station/output/progress.h"

namespace station {

struct ClothSample {
  std::string name;
  renderer::YarnPatch patch;
  std::vector<renderer::ScatteringModel> threads;
  std::array<double, 9> linear_srgb_from_camera{1, 0, 0, 0, 1, 0, 0, 0, 1};  // the first thread's
};

// The cloth of a scene file. Errors: those of scene_file.h and of woven_cloth; std::runtime_error, one line, when it
// has not exactly one cloth, or one on anything but a flat swatch in two scales.
ClothSample cloth_of_scene(const std::filesystem::path& scene, ProgressDisplay& progress);
// The cloth of a draft with all its ends in one thread and all its picks in the other, whatever threads the draft
// names. Errors: those of draft_file.h, bundle_file.h and weave_watched; std::runtime_error, one line, when yarns and
// threads differ in diameter by more than a tenth.
ClothSample cloth_of_draft(const std::filesystem::path& draft, const std::filesystem::path& warp,
                           const std::filesystem::path& weft, ProgressDisplay& progress);

// A swatch about the origin, so large that its border is not seen; without lights.
renderer::Scene endless_cloth(const ClothSample& cloth);

// A camera that sees exactly `periods` periods both ways along direction `to_view`, from so far away that its rays are
// parallel. Picture up is +y, seen from above or below straight; otherwise the picture is upright with regard to +z.
// The azimuth of a slanted direction must be a multiple of 90 degrees: the period then is a rectangle.
renderer::Camera camera_of_period(const ClothSample& cloth, const Eigen::Vector3d& to_view, int width_px, int height_px,
                                  int periods = 1);

// Light of irradiance pi, perpendicular to its direction, from a disc of 3 degrees radius.
renderer::SphereLight distant_light(const Eigen::Vector3d& to_light);
// Surroundings of radiance 1 in one half of all directions, above the cloth or below it; the camera does not see them.
renderer::EnvironmentLight half_surroundings(bool above);

// The picture in linear sRGB instead of the threads' camera RGB.
cv::Mat3f in_linear_srgb(const ClothSample& cloth, const cv::Mat3f& camera_rgb);

// Called with the finished fraction of a piece of work; false: stop.
using PartProgress = std::function<bool(double)>;

// Renders the picture. Errors: std::runtime_error, one line, when `go_on` says to stop.
cv::Mat3f render_or_stop(const renderer::PathTracer& tracer, const renderer::Camera& camera, int samples_per_pixel,
                         std::uint64_t seed, const PartProgress& go_on);

}  // namespace station
