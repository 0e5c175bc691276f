// The keys that files of digitized threads share, whatever the model of their scattering.
#pragma once

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "station/documents/reader.h"

namespace station {

// A digitized thread by any model of its scattering.
template <class Parameters>
struct DigitizedThread {
  std::string name;
  double diameter_mm = 0.5;
  Parameters parameters;
  std::array<double, 9> linear_srgb_from_camera{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major; for display only
  nlohmann::json fit = nlohmann::json::object();         // how well it agrees with its views; may be empty
  nlohmann::json provenance = nlohmann::json::object();  // session, software, date; may be empty
};

// Reads a document of this kind, version 1; `parse` makes the parameters of the object "parameters". Errors: those of
// reader.h and of `parse`.
template <class Parameters, class Parse>
DigitizedThread<Parameters> parse_digitized(const std::string& kind, const nlohmann::json& document,
                                            const std::string& source, const nlohmann::json& units,
                                            const Parse& parse) {
  ObjectReader reader(document, source, kind);
  DigitizedThread<Parameters> thread;
  thread.name = reader.text("name");
  thread.diameter_mm = reader.number("diameter_mm", 0.005, 20);
  thread.parameters = parse(reader.object("parameters"));
  if (reader.has("units") && reader.raw("units") != units)
    reader.refuse("units", "are not those of version 1; leave the key out or write the file again");
  if (reader.has("linear_srgb_from_camera")) {
    const std::vector<double> colour = reader.numbers("linear_srgb_from_camera", 9);
    std::copy(colour.begin(), colour.end(), thread.linear_srgb_from_camera.begin());
  }
  for (const auto& [key, member] : {std::pair{"fit", &thread.fit}, std::pair{"provenance", &thread.provenance}})
    if (reader.has(key)) {
      *member = reader.raw(key);
      if (!member->is_object()) reader.refuse(key, "expected an object");
    }
  reader.finish();
  return thread;
}

template <class Parameters>
nlohmann::json digitized_json(const std::string& kind, const DigitizedThread<Parameters>& thread,
                              const nlohmann::json& parameters, const nlohmann::json& units) {
  return {{"format", "threadstation/" + kind},
          {"version", 1},
          {"name", thread.name},
          {"diameter_mm", thread.diameter_mm},
          {"parameters", parameters},
          {"units", units},
          {"linear_srgb_from_camera", thread.linear_srgb_from_camera},
          {"fit", thread.fit},
          {"provenance", thread.provenance}};
}

}  // namespace station
