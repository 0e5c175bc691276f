#include "station/cloth/render/render_jobs.h"

#include <chrono>
#include <map>
#include <stdexcept>

#include "station/cloth/render/render_identity.h"
#include "station/documents/disk/stored_file.h"
#include "station/output/interrupt.h"
#include "station/output/progress.h"

namespace station {
namespace {

namespace fs = std::filesystem;

void check_names(const std::vector<fs::path>& scenes) {
  std::map<std::string, fs::path> names;
  for (const fs::path& scene : scenes) {
    const auto [other, is_new] = names.emplace(scene.stem().string(), scene);
    if (!is_new)
      throw std::runtime_error("cannot render " + scene.string() + ": its picture would have the name of that of " +
                               other->second.string() + "; rename one of the two");
  }
}

// A rendering whose cloths are built before the first one is rendered: a draft that cannot be woven is told of at once.
struct RenderJob {
  RenderRequest request;
  std::string scene_sha256;  // of the scene that the cloths are of
  std::vector<BuiltCloth> cloths;
  double build_s = 0;
};

RenderJob prepared(RenderRequest request, RenderRanks& ranks) {
  const auto start = std::chrono::steady_clock::now();
  RenderJob job;
  if (fs::exists(request.scene)) job.scene_sha256 = sha256_of_scene(request.scene);  // read_scene refuses it otherwise
  const SceneFile scene = read_scene(request.scene);
  if (!ranks.of_first(ranks.first() && is_kept(request, scene))) {
    ProgressDisplay progress(request.task, ranks.first() ? request.progress : ProgressStyle::quiet);
    job.cloths = build_cloths(scene, progress);
  }
  job.request = std::move(request);
  job.build_s = seconds_since(start);
  return job;
}

}  // namespace

std::vector<RenderReport> render_scenes(const std::vector<fs::path>& scenes, const RenderRequest& common,
                                        RenderRanks& ranks) {
  if (common.out.extension() == ".exr" || common.out.extension() == ".png")
    throw std::runtime_error("cannot write " + std::to_string(scenes.size()) + " pictures to " + common.out.string() +
                             "; give --out the name of a folder");
  check_names(scenes);
  watch_interrupts();
  std::vector<RenderJob> jobs;
  for (const fs::path& scene : scenes) {
    RenderRequest request = common;
    request.scene = scene;
    request.out = common.out / (scene.stem().string() + ".exr");
    request.png = true;
    request.keep_finished = !common.fresh;
    request.task = "render " + scene.stem().string() + " (" + std::to_string(jobs.size() + 1) + " of " +
                   std::to_string(scenes.size()) + ")";
    jobs.push_back(prepared(std::move(request), ranks));
  }
  if (ranks.first()) make_folder(common.out);
  std::vector<RenderReport> reports;
  for (RenderJob& job : jobs) {
    if (sha256_of_scene(job.request.scene) != job.scene_sha256) job.cloths.clear();  // built again as it is now
    reports.push_back(render_scene(job.request, ranks, std::move(job.cloths)));
    if (!reports.back().kept) reports.back().build_s += job.build_s;
    if (interrupted() && reports.size() < scenes.size())
      throw std::runtime_error("rendering was stopped on request after " + job.request.out.string() +
                               "; the same command goes on with the next scene");
  }
  return reports;
}

}  // namespace station
