#include "station/render/render_jobs.h"

#include <map>
#include <stdexcept>

#include "station/capture/stored_file.h"
#include "station/documents/scene_file.h"
#include "station/interrupt.h"

namespace station {
namespace {

namespace fs = std::filesystem;

void check_scenes(const std::vector<fs::path>& scenes) {
  std::map<std::string, fs::path> names;
  for (const fs::path& scene : scenes) {
    const auto [other, is_new] = names.emplace(scene.stem().string(), scene);
    if (!is_new)
      throw std::runtime_error("cannot render " + scene.string() + ": its picture would have the name of that of " +
                               other->second.string() + "; rename one of the two");
    read_scene(scene);
  }
}

}  // namespace

std::vector<RenderReport> render_scenes(const std::vector<fs::path>& scenes, const RenderRequest& common) {
  if (common.out.extension() == ".exr" || common.out.extension() == ".png")
    throw std::runtime_error("cannot write " + std::to_string(scenes.size()) + " pictures to " + common.out.string() +
                             "; give --out the name of a folder");
  check_scenes(scenes);
  make_folder(common.out);
  std::vector<RenderReport> reports;
  for (const fs::path& scene : scenes) {
    RenderRequest request = common;
    request.scene = scene;
    request.out = common.out / (scene.stem().string() + ".exr");
    request.png = true;
    request.keep_finished = !common.fresh;
    request.task = "render " + scene.stem().string() + " (" + std::to_string(reports.size() + 1) + " of " +
                   std::to_string(scenes.size()) + ")";
    reports.push_back(render_scene(request));
    if (interrupted() && reports.size() < scenes.size())
      throw std::runtime_error("rendering was stopped on request after " + request.out.string() +
                               "; the same command goes on with the next scene");
  }
  return reports;
}

}  // namespace station
