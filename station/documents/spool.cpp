#include "station/documents/spool.h"

#include "station/documents/parameter_ranges.h"
#include "station/documents/reader.h"

namespace station {
namespace {

inversion::WrappedSpool parse_wrapping(ObjectReader& spool) {
  inversion::WrappedSpool wrapping;
  ObjectReader holder = spool.object("holder");
  wrapping.frame_width_mm = holder.number("frame_width_mm", 1, 1000);
  wrapping.frame_height_mm = holder.number("frame_height_mm", 1, 1000);
  wrapping.frame_depth_mm = holder.number("frame_depth_mm", 0.1, 500);
  wrapping.window_width_mm = holder.number("window_width_mm", 0.5, wrapping.frame_width_mm);
  wrapping.window_height_mm = holder.number("window_height_mm", 0.5, wrapping.frame_height_mm);
  holder.finish();
  wrapping.turns = spool.integer("turns", 1, 10000);
  wrapping.thread_diameter_mm = spool.number("thread_diameter_mm", 0.005, 20);
  wrapping.front_and_back = spool.choice("sheets", {"front", "front_and_back"}) == "front_and_back";
  if (wrapping.turns * wrapping.thread_diameter_mm > wrapping.frame_height_mm)
    spool.refuse("turns", std::to_string(wrapping.turns) +
                              " turns of this diameter are wider than the frame; correct one of them");
  return wrapping;
}

SimulatedFibers parse_fibers(ObjectReader fibers) {
  SimulatedFibers result;
  result.fibers_per_thread = fibers.integer("fibers_per_thread", 1, 2000);
  result.fiber_radius_mm = fibers.number("fiber_radius_mm", 0.0005, 10);
  result.min_gap_mm = fibers.number("min_gap_mm", 0, 10);
  result.scattering.eta = fibers.number("eta", kRefractiveIndex);
  result.scattering.sigma_a = fibers.vector3("sigma_a", kAbsorption);
  result.scattering.beta_m = fibers.number("beta_m", kRoughness);
  result.scattering.beta_n = fibers.number("beta_n", kRoughness);
  result.seed = static_cast<std::uint64_t>(fibers.integer("seed", 0, 1 << 30));
  fibers.finish();
  return result;
}

}  // namespace

Spool parse_spool(const nlohmann::json& document, const std::string& source) {
  ObjectReader reader(document, source, "spool", 1);
  Spool spool;
  spool.name = reader.text("name");
  spool.material = reader.text("material");
  spool.wrapping = parse_wrapping(reader);
  if (reader.has("simulation")) spool.simulation = parse_fibers(reader.object("simulation"));
  reader.finish();
  return spool;
}

Spool read_spool(const std::filesystem::path& file) {
  return parse_spool(read_json_file(file), file.string());
}

}  // namespace station
