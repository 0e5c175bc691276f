#include "station/documents/fiber_file.h"

#include "station/documents/degree.h"
#include "station/documents/parameter_ranges.h"
#include "station/documents/reader.h"

namespace station {

renderer::FiberParameters parse_fiber(const nlohmann::json& document, const std::string& source) {
  ObjectReader reader(document, source, "fiber");
  renderer::FiberParameters fiber;
  fiber.eta = reader.number("eta", kRefractiveIndex);
  fiber.sigma_a = reader.vector3("sigma_a", kAbsorption);
  fiber.beta_m = reader.number("beta_m", kRoughness);
  fiber.beta_n = reader.number("beta_n", kRoughness);
  fiber.tilt_rad = reader.number("tilt_deg", kTilt_deg) * kDegree;
  reader.finish();
  return fiber;
}

renderer::FiberParameters read_fiber(const std::filesystem::path& file) {
  return parse_fiber(read_json_file(file), file.string());
}

nlohmann::json to_json(const renderer::FiberParameters& fiber) {
  return {{"format", "threadstation/fiber"},     {"version", 1},           {"eta", fiber.eta},
          {"sigma_a", to_json(fiber.sigma_a)},   {"beta_m", fiber.beta_m}, {"beta_n", fiber.beta_n},
          {"tilt_deg", fiber.tilt_rad / kDegree}};
}

}  // namespace station
