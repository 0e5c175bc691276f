#include "station/cloth/render/white_card.h"

#include "renderer/picture/camera.h"
#include "renderer/trace/path_tracer.h"
#include "station/cloth/render/build_scene.h"

namespace station {

std::array<double, 3> radiance_of_white_card(SceneFile scene, const WhiteCard& card) {
  constexpr int kSide_px = 8, kSamples = 256;
  constexpr double kCard_mm = 10, kSeen_mm = 4, kAway_mm = 100;
  const Eigen::Vector3d eye = card.position_mm + kAway_mm * card.normal.normalized();
  const Eigen::Vector3d up = card.normal.unitOrthogonal();
  scene.cloths.clear();
  scene.embroideries.clear();
  scene.objects = {{.shape = renderer::SwatchShape{.width_mm = kCard_mm, .height_mm = kCard_mm},
                    .world_from_object = renderer::look_at(card.position_mm, eye, up).world_from_camera,
                    .albedo = {1, 1, 1}}};
  renderer::Camera camera = renderer::look_at(eye, card.position_mm, up);
  camera.width = camera.height = kSide_px;
  camera.fx = camera.fy = kSide_px * kAway_mm / kSeen_mm;
  camera.cx = camera.cy = (kSide_px - 1) / 2.0;
  const renderer::PathTracer tracer(build_scene(scene, {}));
  const cv::Scalar mean = cv::mean(tracer.render(camera, {.samples_per_pixel = kSamples, .seed = 1}));
  return {mean[0], mean[1], mean[2]};
}

}  // namespace station
