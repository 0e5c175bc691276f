#include "station/documents/bundle_file.h"

#include "station/documents/digitized_thread.h"
#include "station/documents/fiber_file.h"
#include "station/documents/number_text.h"
#include "station/documents/parameter_ranges.h"
#include "station/documents/reader.h"
#include "station/documents/yarn_file.h"

namespace station {
namespace {

using nlohmann::json;
using renderer::BundleParameters;

constexpr int kMostFibers = 1000;
constexpr double kMostPacking = 0.5;  // placed at random, fibers do not get denser

BundleParameters parse_bundle_parameters(ObjectReader reader) {
  BundleParameters p;
  p.fiber_count = reader.integer("fiber_count", 1, kMostFibers);
  p.radius_ratio = reader.number("radius_ratio", 0.001, 1);
  p.fiber.eta = reader.number("eta", kRefractiveIndex);
  p.fiber.sigma_a = reader.vector3("sigma_a", kAbsorption);
  p.fiber.beta_m = reader.number("beta_m", kRoughness);
  p.fiber.beta_n = reader.number("beta_n", kRoughness);
  const double packing = p.fiber_count * p.radius_ratio * p.radius_ratio;
  if (p.fiber_count > 1 && packing > kMostPacking)
    reader.refuse("radius_ratio", "makes the fibers fill " + number_text(packing, 2) + " of the thread; at most " +
                                      number_text(kMostPacking, 2) +
                                      " find room at random, take fewer or thinner ones");
  reader.finish();
  return p;
}

json parameters_json(const BundleParameters& p) {
  return {{"fiber_count", p.fiber_count},        {"radius_ratio", p.radius_ratio}, {"eta", p.fiber.eta},
          {"sigma_a", to_json(p.fiber.sigma_a)}, {"beta_m", p.fiber.beta_m},       {"beta_n", p.fiber.beta_n}};
}

json bundle_units() {
  return {{"fiber_count", "fibers of the thread"},
          {"radius_ratio", "fiber radius / thread radius"},
          {"eta", "relative index of refraction of a fiber"},
          {"sigma_a", "1 / fiber radius; camera R, G, B"},
          {"beta_m", "longitudinal roughness of a fiber; 0.02 to 1"},
          {"beta_n", "azimuthal roughness of a fiber; 0.02 to 1"}};
}

template <class File>
ClothThread cloth_thread(const File& file) {
  return {file.parameters, file.diameter_mm, file.linear_srgb_from_camera};
}

}  // namespace

BundleFile parse_bundle(const json& document, const std::string& source) {
  return parse_digitized<BundleParameters>("bundle", document, source, bundle_units(), parse_bundle_parameters);
}

BundleFile read_bundle(const std::filesystem::path& file) {
  return parse_bundle(read_json_file(file), file.string());
}

json to_json(const BundleFile& bundle) {
  return digitized_json("bundle", bundle, parameters_json(bundle.parameters), bundle_units());
}

ClothThread read_cloth_thread(const std::filesystem::path& file) {
  const json document = read_json_file(file);
  const bool bundle = document.is_object() && document.value("format", json()) == "threadstation/bundle";
  return bundle ? cloth_thread(parse_bundle(document, file.string()))
                : cloth_thread(parse_thread(document, file.string()));
}

renderer::ScatteringModel read_model(const std::filesystem::path& file) {
  const json document = read_json_file(file);
  const json format = document.is_object() ? document.value("format", json()) : json();
  if (format == "threadstation/fiber") return parse_fiber(document, file.string());
  if (format == "threadstation/yarn") return parse_yarn(document, file.string());
  return read_cloth_thread(file).scattering;
}

}  // namespace station
