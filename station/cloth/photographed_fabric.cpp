#include "station/cloth/photographed_fabric.h"

#include <stdexcept>

#include "inversion/view/view.h"
#include "renderer/trace/path_tracer.h"
#include "station/bench/cloth_on_cylinder.h"
#include "station/documents/bundle_file.h"
#include "station/output/interrupt.h"
#include "station/session/results.h"

namespace station {
namespace {

Weave own_weave_of(const SaidFabric& said, const Spool& photographed) {
  if (!photographed.fabric)
    throw std::runtime_error(said.session.string() + " is a session of a wrapped thread (" + photographed.name +
                             "); give one of a cloth on the cylinder, or use invert");
  const Spool asked = said.fabric.empty() ? photographed : read_spool(said.fabric);
  if (asked.fabric && asked.fabric->weave) return *asked.fabric->weave;
  throw std::runtime_error((said.fabric.empty() ? said.session : said.fabric).string() +
                           " does not say what the cloth is woven of; give --fabric with a \"weave\"");
}

renderer::ScatteringModel digitized(const std::filesystem::path& session_or_file, const std::string& model) {
  if (!std::filesystem::is_directory(session_or_file)) return read_model(session_or_file);
  const std::filesystem::path file = model_file_of(session_or_file, model);
  if (!std::filesystem::exists(file))
    throw std::runtime_error(session_or_file.string() + " has no fitted " + model + "; run: threadstation invert " +
                             session_or_file.string() + (model == "thread" ? "" : " --model " + model));
  return read_model(file);
}

}  // namespace

WovenModels woven_models(const SaidFabric& said, const Spool& photographed) {
  const Weave weave = own_weave_of(said, photographed);
  WovenModels woven{.draft = weave.draft, .threads = {weave.threads.begin(), weave.threads.end()}};
  if (said.warp.empty() != said.weft.empty())
    throw std::runtime_error(std::string("only the ") + (said.warp.empty() ? "weft" : "warp") +
                             " was given; give both, --warp and --weft, as sessions or model files");
  if (said.warp.empty() && said.model != "thread")
    throw std::runtime_error(
        "the fabric's own threads are thread models; give the sessions of its warp and weft, each "
        "fitted with invert --model " +
        said.model + ", as --warp and --weft");
  if (said.warp.empty()) return woven;
  woven.draft.warp.threads = {0}, woven.draft.weft.threads = {1};
  woven.threads = {digitized(said.warp, said.model), digitized(said.weft, said.model)};
  return woven;
}

DevelopedViews pictures_of_fabric(const std::filesystem::path& session) {
  DevelopedViews developed = read_views(session);
  read_view_pictures(session, developed);
  return developed;
}

cv::Mat3f predicted_picture(const Fabric& photographed, const renderer::YarnPatch& patch,
                            const std::vector<renderer::ScatteringModel>& threads, const inversion::View& view,
                            int samples_per_pixel, std::uint64_t seed) {
  renderer::Scene scene;
  add_cloth_on_cylinder(scene, photographed.cylinder, patch, threads);
  scene.lights.push_back(inversion::sphere_light(view.light));
  const renderer::PathTracer tracer(scene);
  return tracer.render(
      view.camera, {.samples_per_pixel = samples_per_pixel, .seed = seed, .only = view.mask, .progress = [](double) {
                      return !interrupted();
                    }});
}

}  // namespace station
