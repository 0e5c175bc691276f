#include "station/cloth/render/render_channels.h"

#include <array>

#include "renderer/scene/patch_curves.h"

namespace station {
namespace {

// The scene's thread for each scattering model of build_scene(): curves of brute force first, then the cloths in two
// scales.
std::vector<int> threads_of_models(const SceneFile& scene, const std::vector<BuiltCloth>& cloths) {
  std::vector<int> threads, of_cloths;
  for (std::size_t cloth = 0; cloth < cloths.size(); ++cloth) {
    const std::vector<int> used = renderer::threads_of(cloths[cloth].patch);
    if (!scene.cloths[cloth].two_scale)
      threads.insert(threads.end(), used.begin(), used.end());
    else
      for (std::size_t i = 0; i < scene.threads.size(); ++i) of_cloths.push_back(static_cast<int>(i));
    if (scene.cloths[cloth].fibers && scene.cloths[cloth].fibers->flyaways)  // counted as the first thread's
      of_cloths.push_back(used.front());
  }
  threads.insert(threads.end(), of_cloths.begin(), of_cloths.end());
  return threads;
}

void append(std::vector<renderer::ExrChannel>& channels, const cv::Mat3f& values,
            const std::array<const char*, 3>& names, bool half) {
  for (int c = 0; c < 3; ++c) {
    cv::Mat plane;
    cv::extractChannel(values, plane, c);
    channels.push_back({names.at(static_cast<std::size_t>(c)), plane, half});
  }
}

}  // namespace

std::vector<renderer::ExrChannel> render_channels(const cv::Mat3f& image, const renderer::PictureLayers* layers,
                                                  const SceneFile& scene, const std::vector<BuiltCloth>& cloths,
                                                  bool half) {
  std::vector<renderer::ExrChannel> channels;
  append(channels, image, {"R", "G", "B"}, half);
  if (!layers) return channels;
  append(channels, layers->albedo, {"albedo.R", "albedo.G", "albedo.B"}, half);
  append(channels, layers->normal, {"normal.X", "normal.Y", "normal.Z"}, half);
  channels.push_back({"depth.Z", layers->depth_mm});
  channels.push_back({"cover.A", layers->cover, half});
  const std::vector<int> threads = threads_of_models(scene, cloths);
  cv::Mat1i thread = layers->model.clone();
  for (int& id : thread)
    if (id > 0) id = 1 + threads.at(static_cast<std::size_t>(id - 1));
  channels.push_back({"thread.id", thread});
  channels.push_back({"yarn.id", layers->yarn});
  return channels;
}

}  // namespace station
