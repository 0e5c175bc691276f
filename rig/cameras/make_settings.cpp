#include "rig/cameras/make_settings.h"

#include <algorithm>
#include <array>

namespace rig {
namespace {

constexpr const char* kDialAtM = "the mode dial on its top to M";

std::vector<MakeSettings> table() {
  return {
      {.make = "Sony",
       .mode = {"expprogram", {"M"}, kDialAtM},
       .focus = {"focusmode", {"Manual"}, "MENU > Focus Mode > MF (or the switch on the lens)"},
       .quality = {"imagequality", {"RAW"}, "MENU > Image Quality > RAW"},
       .shutter = "shutterspeed",
       .iso = "iso",
       .aperture = "f-number",
       .off = {},
       .connection = "MENU > Setup > USB Connection to PC Remote"},
      {.make = "Canon",
       .mode = {"autoexposuremode", {"Manual"}, kDialAtM},
       .focus = {"focusmode", {"Manual"}, "the switch on the lens to MF"},
       .quality = {"imageformat", {"RAW"}, "MENU > Image quality > RAW (no JPEG beside it)"},
       .shutter = "shutterspeed",
       .iso = "iso",
       .aperture = "aperture",
       .off = {},
       .connection = "MENU > Wi-Fi to Disable (it switches USB off)"},
      // The fractions of "shutterspeed2" are exact, the tenths of a millisecond of "shutterspeed" are not.
      {.make = "Nikon",
       .mode = {"expprogram", {"M"}, kDialAtM},
       .focus = {"focusmode", {"Manual"}, "the lever beside the lens to M (or Focus mode > MF)"},
       .quality = {"imagequality", {"NEF (Raw)", "RAW"}, "MENU > Photo shooting > Image quality > NEF (RAW)"},
       .shutter = "shutterspeed2",
       .iso = "iso",
       .aperture = "f-number",
       .off = {{"isoauto", {"Off"}, "MENU > Photo shooting > ISO sensitivity settings > Auto ISO > Off"},
               {"autoiso", {"Off"}, "MENU > Photo shooting > ISO sensitivity settings > Auto ISO > Off"}},
       .connection = "MENU > Setup > USB to MTP/PTP (where it has that entry)"},
  };
}

std::array<const std::string*, 6> names_in(const MakeSettings& settings) {
  return {&settings.mode.name, &settings.focus.name, &settings.quality.name,
          &settings.iso,       &settings.shutter,    &settings.aperture};
}

// How many of its names are offered; among equals the manufacturer's own comes first.
long fit(const MakeSettings& settings, const std::string& manufacturer, const std::set<std::string>& offered) {
  const long known =
      std::ranges::count_if(names_in(settings), [&](const std::string* name) { return offered.contains(*name); });
  return 2 * known + (manufacturer.find(settings.make) == std::string::npos ? 0 : 1);
}

}  // namespace

MakeSettings settings_of_make(const std::string& manufacturer, const std::set<std::string>& offered) {
  const std::vector<MakeSettings> all = table();
  MakeSettings best = *std::ranges::max_element(
      all, {}, [&](const MakeSettings& settings) { return fit(settings, manufacturer, offered); });
  if (!offered.contains(best.shutter)) best.shutter = "shutterspeed";  // the one that every make has
  return best;
}

std::string missing_settings(const MakeSettings& settings, const std::set<std::string>& offered) {
  std::string missing;
  for (const std::string* name : names_in(settings))
    if (name != &settings.aperture && !offered.contains(*name)) missing += (missing.empty() ? "" : ", ") + *name;
  return missing;
}

}  // namespace rig
