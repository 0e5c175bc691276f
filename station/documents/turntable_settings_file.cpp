#include "station/documents/turntable_settings_file.h"

#include "station/documents/reader.h"

namespace station {
namespace {

constexpr int kLargestNumber = 9999;
constexpr double kLargestValue = 1e9;

}  // namespace

nlohmann::json to_json(const TurntableSettings& settings) {
  nlohmann::json list = nlohmann::json::array();
  for (const auto& [number, value] : settings.settings) list.push_back({{"number", number}, {"value", value}});
  return {{"format", "threadstation/turntable-settings"},
          {"version", 1},
          {"firmware", settings.firmware},
          {"settings", list}};
}

TurntableSettings parse_turntable_settings(const nlohmann::json& document, const std::string& source) {
  ObjectReader reader(document, source, "turntable-settings");
  TurntableSettings settings{.firmware = reader.text("firmware"), .settings = {}};
  for (ObjectReader entry : reader.objects("settings")) {
    const int number = entry.integer("number", 0, kLargestNumber);
    settings.settings[number] = entry.number("value", 0, kLargestValue);
    entry.finish();
  }
  reader.finish();
  return settings;
}

TurntableSettings read_turntable_settings(const std::filesystem::path& file) {
  return parse_turntable_settings(read_json_file(file), file.string());
}

}  // namespace station
