#include "station/documents/thread_file.h"

#include <algorithm>

#include "station/documents/digitized_thread.h"
#include "station/documents/parameter_ranges.h"
#include "station/documents/reader.h"

namespace station {
namespace {

using nlohmann::json;
using renderer::ThreadParameters;

constexpr Range kR{-1e6, 1e6}, kTint{0, 1}, kPower{0, 10};
constexpr double kRounding = 1e-9;
// Files that name no exit are from when there was this one.
constexpr renderer::ThreadExit kExitWhenLeftOut = renderer::ThreadExit::far_side;

std::array<double, 3> roughness(ObjectReader& reader, const std::string& key) {
  const std::vector<double> lobes = reader.numbers(key, 3, kRoughness);
  return {lobes[0], lobes[1], lobes[2]};
}

// Keys that may be left out, as most threads do.
void parse_options(ObjectReader& reader, ThreadParameters& p) {
  if (reader.has("lambda0_rgb")) p.lambda0_rgb = reader.vector3("lambda0_rgb", kTint);
  if (reader.has("transmittance_powers")) {
    const std::vector<double> powers = reader.numbers("transmittance_powers", 2, kPower);
    p.transmittance_powers = {powers[0], powers[1]};
  }
  if (reader.has("exit")) {
    const std::string exit = reader.text("exit");
    const auto found = thread_exits().find(exit);
    if (found == thread_exits().end())
      reader.refuse("exit", "is \"" + exit +
                                "\"; light leaves a thread by \"wandering\", at its \"far_side\" or at the "
                                "\"entry_point\"");
    p.exit = found->second;
  }
}

// Refuses a thread unless lambda_p >= 0 for every c in [0, 1].
void check_lobe_energies(const ObjectReader& reader, ThreadParameters parameters) {
  constexpr int kSteps = 100;
  constexpr std::array<const char*, 3> kKeys{"r0", "r1", "r2"};
  parameters.limit_energy = false;
  for (int i = 0; i <= kSteps; ++i) {
    const double c = static_cast<double>(i) / kSteps;
    const std::array<double, 3> lambda = renderer::thread_lobe_energies<double>(parameters, c);
    for (std::size_t p = 0; p < 3; ++p)
      if (!(lambda[p] >= -kRounding))
        reader.refuse(kKeys[p], "makes the lobe's energy " + json(lambda[p]).dump() + " at cos theta " +
                                    json(c).dump() + "; energies cannot be negative");
  }
}

ThreadParameters parse_thread_parameters(ObjectReader reader) {
  ThreadParameters p;
  p.sigma_a = reader.vector3("sigma_a", kAbsorption);
  p.alpha = roughness(reader, "alpha");
  p.beta = roughness(reader, "beta");
  const std::vector<double> r0 = reader.numbers("r0", 3, kR), r1 = reader.numbers("r1", 1, kR),
                            r2 = reader.numbers("r2", 3, kR);
  p.r0a = r0[0], p.r0b = r0[1], p.r0c = r0[2];
  p.r1a = r1[0];
  p.r2a = r2[0], p.r2b = r2[1], p.r2c = r2[2];
  p.exit = kExitWhenLeftOut;
  check_lobe_energies(reader, p);
  parse_options(reader, p);
  reader.finish();
  return p;
}

json parameters_json(const ThreadParameters& p) {
  const ThreadParameters plain;
  json parameters{{"sigma_a", to_json(p.sigma_a)}, {"alpha", p.alpha}, {"beta", p.beta},
                  {"r0", {p.r0a, p.r0b, p.r0c}},   {"r1", {p.r1a}},    {"r2", {p.r2a, p.r2b, p.r2c}}};
  if (p.lambda0_rgb != plain.lambda0_rgb) parameters["lambda0_rgb"] = to_json(p.lambda0_rgb);
  if (p.transmittance_powers != plain.transmittance_powers) parameters["transmittance_powers"] = p.transmittance_powers;
  for (const auto& [name, exit] : thread_exits())
    if (p.exit == exit && exit != kExitWhenLeftOut) parameters["exit"] = name;
  return parameters;
}

json thread_units() {
  return {{"sigma_a", "1 / thread radius; camera R, G, B"},
          {"alpha", "longitudinal roughness of R, TT, TRT; 0.02 to 1"},
          {"beta", "azimuthal roughness of R, TT, TRT; 0.02 to 1"},
          {"r0", "lambda_0 = r0[0] c^2 + r0[1] c + r0[2], c = |cos theta|"},
          {"r1", "lambda_1 = r1[0] c"},
          {"r2", "lambda_2 = 1 / (r2[0] c + r2[1]) + r2[2]"}};
}

}  // namespace

const std::map<std::string, renderer::ThreadExit>& thread_exits() {
  static const std::map<std::string, renderer::ThreadExit> names{{"entry_point", renderer::ThreadExit::entry_point},
                                                                 {"far_side", renderer::ThreadExit::far_side},
                                                                 {"wandering", renderer::ThreadExit::wandering}};
  return names;
}

ThreadFile parse_thread(const json& document, const std::string& source) {
  return parse_digitized<ThreadParameters>("thread", document, source, thread_units(), parse_thread_parameters);
}

ThreadFile read_thread(const std::filesystem::path& file) {
  return parse_thread(read_json_file(file), file.string());
}

json to_json(const ThreadFile& thread) {
  return digitized_json("thread", thread, parameters_json(thread.parameters), thread_units());
}

}  // namespace station
