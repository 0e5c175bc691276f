#include "station/documents/yarn_file.h"

#include "station/documents/parameter_ranges.h"
#include "station/documents/reader.h"

namespace station {

renderer::YarnParameters parse_yarn(const nlohmann::json& document, const std::string& source) {
  ObjectReader reader(document, source, "yarn");
  renderer::YarnParameters yarn;
  yarn.fiber_count = reader.integer("fiber_count", 1, 10000);
  yarn.radius_ratio = reader.number("radius_ratio", 0.001, 1);
  yarn.eta = reader.number("eta", kRefractiveIndex);
  yarn.sigma_a = reader.vector3("sigma_a", kAbsorption);
  yarn.beta_r = reader.number("beta_r", kRoughness);
  yarn.beta_tt = reader.number("beta_tt", kRoughness);
  yarn.gamma_tt = reader.number("gamma_tt", kRoughness);
  if (yarn.fiber_count * yarn.radius_ratio * yarn.radius_ratio > 1)
    reader.refuse("radius_ratio",
                  "the fibers' cross sections together are larger than the yarn's; take fewer or "
                  "thinner fibers");
  if (reader.has("origin")) reader.text("origin");
  reader.finish();
  return yarn;
}

renderer::YarnParameters read_yarn(const std::filesystem::path& file) {
  return parse_yarn(read_json_file(file), file.string());
}

nlohmann::json to_json(const renderer::YarnParameters& yarn) {
  return {{"format", "threadstation/yarn"},
          {"version", 1},
          {"origin", "reconstruction in the manner of Zhu et al. 2023"},
          {"fiber_count", yarn.fiber_count},
          {"radius_ratio", yarn.radius_ratio},
          {"eta", yarn.eta},
          {"sigma_a", to_json(yarn.sigma_a)},
          {"beta_r", yarn.beta_r},
          {"beta_tt", yarn.beta_tt},
          {"gamma_tt", yarn.gamma_tt}};
}

}  // namespace station
