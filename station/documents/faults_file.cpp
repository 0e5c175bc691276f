#include "station/documents/faults_file.h"

#include <algorithm>
#include <array>
#include <utility>

#include "station/documents/reader.h"

namespace station {
namespace {

using rig::CameraFault;
using rig::LineFault;

constexpr int kMostOperations = 1000000;

// The words of fault files are the enumerators' own names.
constexpr std::array<std::pair<const char*, LineFault>, 13> kLineFaults{{{"silence", LineFault::silence},
                                                                         {"lost_reply", LineFault::lost_reply},
                                                                         {"garbage", LineFault::garbage},
                                                                         {"wrong_digit", LineFault::wrong_digit},
                                                                         {"glued", LineFault::glued},
                                                                         {"split", LineFault::split},
                                                                         {"late", LineFault::late},
                                                                         {"repeated", LineFault::repeated},
                                                                         {"reset", LineFault::reset},
                                                                         {"alarm", LineFault::alarm},
                                                                         {"jam", LineFault::jam},
                                                                         {"unplug", LineFault::unplug},
                                                                         {"wrong_device", LineFault::wrong_device}}};
constexpr std::array<std::pair<const char*, CameraFault>, 14> kCameraFaults{
    {{"silence", CameraFault::silence},
     {"lost_answer", CameraFault::lost_answer},
     {"cut", CameraFault::cut},
     {"garbage", CameraFault::garbage},
     {"unplug", CameraFault::unplug},
     {"refused_shutter", CameraFault::refused_shutter},
     {"refused_iso", CameraFault::refused_iso},
     {"refused_f_number", CameraFault::refused_f_number},
     {"refused_quality", CameraFault::refused_quality},
     {"overstepped", CameraFault::overstepped},
     {"stale_picture", CameraFault::stale_picture},
     {"store_full", CameraFault::store_full},
     {"battery_empty", CameraFault::battery_empty},
     {"dial_turned", CameraFault::dial_turned}}};

template <typename Planned, typename Names>
std::vector<Planned> parse_plan(ObjectReader& faults, const std::string& key, const Names& names) {
  std::vector<Planned> plan;
  for (ObjectReader entry : faults.objects(key)) {
    const std::string name = entry.text("fault");
    const auto found = std::ranges::find_if(names, [&](const auto& one) { return name == one.first; });
    if (found == names.end()) {
      std::string known;
      for (const auto& one : names) known += std::string(known.empty() ? "" : ", ") + one.first;
      entry.refuse("fault", "\"" + name + "\" is none; it is one of " + known);
    }
    plan.push_back({.at_operation = entry.integer("at_operation", 1, kMostOperations), .fault = found->second});
    entry.finish();
  }
  return plan;
}

}  // namespace

Faults parse_faults(const nlohmann::json& document, const std::string& source) {
  ObjectReader reader(document, source, "faults");
  Faults faults{.turntable = parse_plan<rig::PlannedLineFault>(reader, "turntable", kLineFaults),
                .camera = parse_plan<rig::PlannedCameraFault>(reader, "camera", kCameraFaults)};
  reader.finish();
  return faults;
}

Faults read_faults(const std::filesystem::path& file) {
  return parse_faults(read_json_file(file), file.string());
}

}  // namespace station
