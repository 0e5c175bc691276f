#include "station/documents/spool.h"

#include "station/documents/draft_file.h"
#include "station/documents/holder.h"
#include "station/documents/parameter_ranges.h"
#include "station/documents/reader.h"
#include "station/documents/thread_file.h"

namespace station {

namespace {

constexpr std::size_t kFewestPlies = 2, kMostPlies = 6;

inversion::WrappedSpool parse_wrapping(ObjectReader& spool) {
  inversion::WrappedSpool wrapping;
  read_holder(spool.object("holder"), wrapping);
  wrapping.turns = spool.integer("turns", 1, 10000);
  wrapping.thread_diameter_mm = spool.number("thread_diameter_mm", 0.005, 20);
  wrapping.front_and_back = spool.choice("sheets", {"front", "front_and_back"}) == "front_and_back";
  if (wrapping.turns * wrapping.thread_diameter_mm > wrapping.frame_height_mm)
    spool.refuse("turns", std::to_string(wrapping.turns) +
                              " turns of this diameter are wider than the frame; correct one of them");
  return wrapping;
}

void read_plies(ObjectReader& fibers, SimulatedPlies& plies) {
  for (ObjectReader& ply : fibers.objects("plies")) {
    plies.sigma_a.push_back(ply.vector3("sigma_a", kAbsorption));
    ply.finish();
  }
  if (plies.sigma_a.size() < kFewestPlies || plies.sigma_a.size() > kMostPlies)
    fibers.refuse("plies", std::to_string(plies.sigma_a.size()) + " are listed; a thread of plies has " +
                               std::to_string(kFewestPlies) + " to " + std::to_string(kMostPlies));
  plies.turn_mm = fibers.number("ply_turn_mm", 0.5, 1000);
}

SimulatedFibers parse_fibers(ObjectReader fibers) {
  SimulatedFibers result;
  result.fibers_per_thread = fibers.integer("fibers_per_thread", 1, 2000);
  result.fiber_radius_mm = fibers.number("fiber_radius_mm", 0.0005, 10);
  result.min_gap_mm = fibers.number("min_gap_mm", 0, 10);
  if (fibers.has("reflectance")) {
    result.reflectance = fibers.vector3("reflectance", {0, 1});
  } else {
    result.scattering.eta = fibers.number("eta", kRefractiveIndex);
    if (fibers.has("plies"))
      read_plies(fibers, result.plies.emplace());
    else
      result.scattering.sigma_a = fibers.vector3("sigma_a", kAbsorption);
  }
  if (fibers.has("uneven")) {
    if (result.reflectance || result.plies)
      fibers.refuse("uneven", "is for threads of one bundle of fibers with \"eta\" and \"sigma_a\"; leave it out");
    ObjectReader reader = fibers.object("uneven");
    SimulatedUnevenness& uneven = result.uneven.emplace();
    uneven.shade = reader.number("shade", 0, 1);
    uneven.diameter = reader.number("diameter", 0, 0.15);
    uneven.length_mm = reader.number("length_mm", 20, 1e5);
    reader.finish();
  }
  result.scattering.beta_m = fibers.number("beta_m", kRoughness);
  result.scattering.beta_n = fibers.number("beta_n", kRoughness);
  result.seed = static_cast<std::uint64_t>(fibers.integer("seed", 0, 1 << 30));
  fibers.finish();
  return result;
}

Weave parse_weave(ObjectReader reader) {
  Weave weave{.draft = parse_draft(reader.raw("draft"), reader.source() + " (draft)"), .threads = {}};
  const nlohmann::json& threads = reader.raw("threads");
  if (!threads.is_array()) reader.refuse("threads", "expected a list of threads");
  for (const nlohmann::json& thread : threads)
    weave.threads.push_back(parse_thread(thread, reader.source() + " (threads)").parameters);
  replace_threads(reader, "warp_threads", weave.draft.warp);
  replace_threads(reader, "weft_threads", weave.draft.weft);
  if (const auto problem = renderer::check_draft(weave.draft)) reader.refuse("draft", *problem);
  for (const renderer::YarnSystem* system : {&weave.draft.warp, &weave.draft.weft})
    for (const int thread : system->threads)
      if (static_cast<std::size_t>(thread) >= weave.threads.size())
        reader.refuse("threads", std::to_string(weave.threads.size()) +
                                     " are listed and the draft has a yarn of thread " + std::to_string(thread) +
                                     " (counted from 0); list one more");
  reader.finish();
  return weave;
}

Spool parse_fabric(const nlohmann::json& document, const std::string& source) {
  ObjectReader reader(document, source, "fabric");
  Spool spool;
  spool.name = reader.text("name");
  spool.material = reader.text("material");
  Fabric& fabric = spool.fabric.emplace();
  ObjectReader cylinder = reader.object("cylinder");
  fabric.cylinder.radius_mm = cylinder.number("radius_mm", 5, 500);
  fabric.cylinder.height_mm = cylinder.number("height_mm", 5, 1000);
  cylinder.finish();
  if (reader.has("weave")) fabric.weave = parse_weave(reader.object("weave"));
  reader.finish();
  return spool;
}

bool is_fabric(const nlohmann::json& document) {
  return document.is_object() && document.value("format", nlohmann::json()) == "threadstation/fabric";
}

}  // namespace

nlohmann::json read_spool_document(const std::filesystem::path& file) {
  nlohmann::json document = read_json_file(file);
  if (!is_fabric(document) || !document.contains("weave") || !document["weave"].is_object()) return document;
  nlohmann::json& weave = document["weave"];
  if (weave.contains("draft") && weave["draft"].is_string())
    weave["draft"] = to_json(read_draft(file.parent_path() / weave["draft"].get<std::string>()));
  if (weave.contains("threads") && weave["threads"].is_array())
    for (nlohmann::json& thread : weave["threads"])
      if (thread.is_string()) thread = read_json_file(file.parent_path() / thread.get<std::string>());
  return document;
}

Spool parse_spool(const nlohmann::json& document, const std::string& source) {
  if (is_fabric(document)) return parse_fabric(document, source);
  ObjectReader reader(document, source, "spool");
  Spool spool;
  spool.name = reader.text("name");
  spool.material = reader.text("material");
  spool.wrapping = parse_wrapping(reader);
  if (reader.has("simulation")) spool.simulation = parse_fibers(reader.object("simulation"));
  reader.finish();
  return spool;
}

Spool read_spool(const std::filesystem::path& file) {
  return parse_spool(read_spool_document(file), file.string());
}

}  // namespace station
