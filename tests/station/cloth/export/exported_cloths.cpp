#include "tests/station/cloth/export/exported_cloths.h"

#include "tests/renderer/trace/cloth_scenes.h"

namespace station_test {

using station::ClothSample;

ClothSample plain_cloth(const renderer::ThreadParameters& warp, const renderer::ThreadParameters& weft) {
  return {.name = "plain", .patch = renderer::plain_patch(), .threads = {warp, weft}};
}

ClothSample satin_cloth(const renderer::ThreadParameters& warp, const renderer::ThreadParameters& weft) {
  return {.name = "satin", .patch = renderer::satin_patch(), .threads = {warp, weft}};
}

renderer::ThreadParameters black_thread() {
  return {.sigma_a = {20, 20, 20}, .r0a = 0, .r0b = 0, .r0c = 0};
}

renderer::ThreadParameters red_thread() {
  return {.sigma_a = {0.05, 0.9, 1.1}};
}

Eigen::Array3d furnace(const ClothSample& cloth, bool light_above) {
  renderer::Scene scene = station::endless_cloth(cloth);
  scene.surroundings = station::half_surroundings(light_above);
  const renderer::PathTracer tracer(std::move(scene));
  return mean_of(tracer.render(station::camera_of_period(cloth, Eigen::Vector3d::UnitZ(), 16, 16),
                               {.samples_per_pixel = 512, .seed = 4711}));
}

Eigen::Array3d mean_of(const cv::Mat3f& picture) {
  const cv::Scalar mean = cv::mean(picture);
  return {mean[0], mean[1], mean[2]};
}

}  // namespace station_test
