// One photograph of the wrapped spool as the fit sees it, everything in the holder frame (wrapped_spool.h).
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "inversion/view/noise_law.h"
#include "inversion/view/wrapped_spool.h"
#include "renderer/picture/camera.h"
#include "renderer/scene/scene.h"

namespace inversion {

struct NearLight {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();   // mm, holder frame
  Eigen::Vector3d intensity = Eigen::Vector3d::Ones();  // RGB, radiance unit x mm^2: irradiance on its axis is I / d^2
  double radius_mm = 4;
  // Intensity falls off as cos^beam_exponent of the angle from beam_axis (unit); `intensity` is along the axis.
  Eigen::Vector3d beam_axis = -Eigen::Vector3d::UnitX();
  double beam_exponent = 0.0;
};

struct View {
  std::string id;
  renderer::Camera camera;  // undistorted; world = holder frame
  NearLight light;
  bool transmission = false;
  cv::Mat3f image;                  // linear camera RGB, radiance unit; may be empty
  std::optional<NoiseLaw> noise{};  // noise of the image; nothing: not known
  cv::Mat1b mask;                   // 255 where threads are; the image's size
};

// How large a millimetre is in the picture, in the middle of the holder.
double px_per_mm(const View& view);

// The light as a light of the renderer.
renderer::SphereLight sphere_light(const NearLight& light);

// The scene of a view: the holder, threads with the given scattering and the view's light; the camera does not see the
// lamp.
renderer::Scene view_scene(const WrappedSpool& spool, const renderer::ScatteringModel& scattering,
                           const NearLight& light);

// The same with these threads in place of even ones.
renderer::Scene view_scene(const WrappedSpool& spool, std::vector<renderer::CurveSet> threads, const NearLight& light);

// The mask of the threads, 255 inside: the non-zero region of a rendering of the threads from this view before anything
// is fitted [Xia 2025, section 4], less a border of two pixels where photographs mix threads with what is beside them.
// `samples_per_pixel` rays per pixel decide. Pictures wider than 1024 pixels are rendered, and lose their border, in
// larger pixels of two by two, three by three, and so on.
cv::Mat1b thread_mask(const WrappedSpool& spool, const renderer::Camera& camera, const NearLight& light,
                      int samples_per_pixel);

// The radiance of a perfect diffuser at the holder frame's origin facing the light: I cos^beam / (pi d^2). The
// objective of eq. 6 divides pictures by its mean.
Eigen::Vector3d diffuser_radiance(const NearLight& light);

}  // namespace inversion
