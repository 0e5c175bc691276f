#include "station/documents/draft_file.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "station/documents/reader.h"
#include "station/documents/wif_file.h"

namespace station {
namespace {

using nlohmann::json;

constexpr double kMost = 1000;
constexpr int kMostSeed = std::numeric_limits<int>::max();

std::vector<std::vector<bool>> parse_structure(ObjectReader& draft) {
  const json& rows = draft.raw("structure");
  if (!rows.is_array()) draft.refuse("structure", "expected a list with one text per pick, such as \"X.\"");
  std::vector<std::vector<bool>> warp_over;
  for (const json& row : rows) {
    const std::string where = "pick " + std::to_string(warp_over.size() + 1);
    if (!row.is_string()) draft.refuse("structure", where + " is not text such as \"X.\"");
    std::vector<bool> pick;
    for (char mark : row.get_ref<const std::string&>()) {
      if (mark != 'X' && mark != '.')
        draft.refuse("structure", where + " has a mark other than X (warp on top) and . (weft on top)");
      pick.push_back(mark == 'X');
    }
    warp_over.push_back(std::move(pick));
  }
  return warp_over;
}

renderer::YarnSystem parse_system(ObjectReader reader) {
  constexpr double kMostMechanics = 1e9;
  renderer::YarnSystem system;
  system.diameter_mm = reader.number("diameter_mm", -kMost, kMost);  // check_draft says what is wrong with its value
  system.pitch_mm = reader.number("pitch_mm", -kMost, kMost);
  system.threads.clear();
  for (double thread : reader.numbers("threads")) {
    if (thread != std::floor(thread) || std::abs(thread) > 1e6)
      reader.refuse("threads", "found " + json(thread).dump() + ", expected whole numbers");
    system.threads.push_back(static_cast<int>(thread));
  }
  const auto optional = [&](const char* key, double& value) {
    if (reader.has(key)) value = reader.number(key, -kMostMechanics, kMostMechanics);  // check_draft, as above
  };
  optional("tex", system.tex);
  optional("bending_n_mm2", system.bending_n_mm2);
  optional("tension_n", system.tension_n);
  optional("contraction", system.contraction);
  optional("flatness", system.flatness);
  reader.finish();
  return system;
}

void parse_unevenness(ObjectReader reader, renderer::Unevenness& uneven) {
  if (reader.has("radius")) uneven.radius = reader.number("radius", -kMost, kMost);  // check_draft, as below
  if (reader.has("pitch")) uneven.pitch = reader.number("pitch", -kMost, kMost);
  if (reader.has("shades")) uneven.shades = reader.integer("shades", 1, renderer::kMostShades);
  if (reader.has("seed")) uneven.seed = static_cast<std::uint64_t>(reader.integer("seed", 0, kMostSeed));
  reader.finish();
}

void parse_slubs(ObjectReader reader, renderer::Slubs& slubs) {
  if (reader.has("radius")) slubs.radius = reader.number("radius", -kMost, kMost);
  if (reader.has("twist")) slubs.twist = reader.number("twist", -kMost, kMost);
  if (reader.has("length_mm")) slubs.length_mm = reader.number("length_mm", -kMost, kMost);
  if (reader.has("shade_mm")) slubs.shade_mm = reader.number("shade_mm", -kMost, kMost);
  reader.finish();
}

void parse_plies(ObjectReader reader, renderer::Plies& plies) {
  plies.count = reader.integer("count", 1, renderer::kMostPlies);
  if (reader.has("turns_per_mm")) plies.turns_per_mm = reader.number("turns_per_mm", -kMost, kMost);
  if (reader.has("radius_mm")) plies.radius_mm = reader.number("radius_mm", -kMost, kMost);
  reader.finish();
}

json system_json(const renderer::YarnSystem& system) {
  return {{"diameter_mm", system.diameter_mm},
          {"pitch_mm", system.pitch_mm},
          {"threads", system.threads},
          {"tex", system.tex},
          {"bending_n_mm2", system.bending_n_mm2},
          {"tension_n", system.tension_n},
          {"contraction", system.contraction},
          {"flatness", system.flatness}};
}

}  // namespace

renderer::Draft parse_draft(const json& document, const std::string& source) {
  ObjectReader reader(document, source, "draft");
  renderer::Draft draft;
  draft.name = reader.text("name");
  draft.warp_over = parse_structure(reader);
  draft.warp = parse_system(reader.object("warp"));
  draft.weft = parse_system(reader.object("weft"));
  if (reader.has("height_scale")) draft.height_scale = reader.number("height_scale", -10, 10);
  if (reader.has("periods")) draft.free_periods = reader.choice("periods", {"fixed", "free"}) == "free";
  if (reader.has("relaxed")) draft.relaxed = reader.flag("relaxed");
  if (reader.has("transverse_modulus_n_mm2"))
    draft.transverse_modulus_n_mm2 = reader.number("transverse_modulus_n_mm2", -kMost, renderer::kMostModulus);
  if (reader.has("unevenness")) parse_unevenness(reader.object("unevenness"), draft.unevenness);
  if (reader.has("slubs")) parse_slubs(reader.object("slubs"), draft.slubs);
  if (reader.has("plies")) parse_plies(reader.object("plies"), draft.plies);
  reader.finish();
  if (const auto problem = renderer::check_draft(draft)) throw std::runtime_error(source + ": " + *problem);
  return draft;
}

renderer::Draft read_draft(const std::filesystem::path& file) {
  const std::string kind = file.extension().string();
  if (kind == ".wif" || kind == ".WIF") return read_wif(file);
  return parse_draft(read_json_file(file), file.string());
}

json to_json(const renderer::Draft& draft) {
  json structure = json::array();
  for (const std::vector<bool>& row : draft.warp_over) {
    std::string marks;
    for (bool warp : row) marks += warp ? 'X' : '.';
    structure.push_back(marks);
  }
  return {{"format", "threadstation/draft"},
          {"version", 1},
          {"name", draft.name},
          {"structure", structure},
          {"warp", system_json(draft.warp)},
          {"weft", system_json(draft.weft)},
          {"periods", draft.free_periods ? "free" : "fixed"},
          {"height_scale", draft.height_scale},
          {"relaxed", draft.relaxed},
          {"transverse_modulus_n_mm2", draft.transverse_modulus_n_mm2},
          {"unevenness",
           {{"radius", draft.unevenness.radius},
            {"pitch", draft.unevenness.pitch},
            {"shades", draft.unevenness.shades},
            {"seed", draft.unevenness.seed}}},
          {"slubs",
           {{"radius", draft.slubs.radius},
            {"twist", draft.slubs.twist},
            {"length_mm", draft.slubs.length_mm},
            {"shade_mm", draft.slubs.shade_mm}}},
          {"plies",
           {{"count", draft.plies.count},
            {"turns_per_mm", draft.plies.turns_per_mm},
            {"radius_mm", draft.plies.radius_mm}}}};
}

void replace_threads(ObjectReader& cloth, const std::string& key, renderer::YarnSystem& system) {
  if (!cloth.has(key)) return;
  system.threads.clear();
  for (const double thread : cloth.numbers(key)) {
    if (!(thread >= 0 && thread < renderer::kMostThreads && thread == std::floor(thread)))
      cloth.refuse(key, "found " + nlohmann::json(thread).dump() + ", expected numbers of threads, counted from 0");
    system.threads.push_back(static_cast<int>(thread));
  }
  if (system.threads.empty()) cloth.refuse(key, "the list is empty; name the thread of at least one yarn");
}

}  // namespace station
