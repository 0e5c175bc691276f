// One table of the settings by make: what libgphoto2 calls them, what they have to read, and where a person sets them.
// A camera is known by the names that it offers. The names and values are those of libgphoto2 2.5.30
// (camlibs/ptp2/config.c).
#pragma once

#include <set>
#include <string>
#include <vector>

namespace rig {

// A setting that has to read one of `values`, and where a person sets it.
struct RequiredSetting {
  std::string name;
  std::vector<std::string> values;
  std::string where;
};

struct MakeSettings {
  std::string make;  // part of the manufacturer's name
  RequiredSetting mode, focus, quality;
  std::string shutter, iso, aperture;
  std::vector<RequiredSetting> off;  // automatics that must be off on a camera that has them
  std::string connection;            // what makes the camera offer its settings
};

// The settings of a camera that has settings of these names.
MakeSettings settings_of_make(const std::string& manufacturer, const std::set<std::string>& offered);

// Those without which no picture can be taken here and which the camera does not offer, as "iso, shutterspeed"; empty
// when there are none. The aperture is not among them: a lens may have none that a computer can set.
std::string missing_settings(const MakeSettings& settings, const std::set<std::string>& offered);

}  // namespace rig
