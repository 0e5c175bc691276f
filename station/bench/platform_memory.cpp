#include "station/bench/platform_memory.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "station/documents/degree.h"
#include "station/documents/migrations.h"
#include "station/documents/reader.h"

namespace station {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKind = "platform-place";

fs::path state_folder() {
  const char* state = std::getenv("XDG_STATE_HOME");
  const char* home = std::getenv("HOME");
  if (state != nullptr && *state != '\0') return fs::path(state) / "threadstation";
  if (home != nullptr && *home != '\0') return fs::path(home) / ".local" / "state" / "threadstation";
  throw std::runtime_error(
      "the place of the platform is to be remembered and there is no home folder; set HOME or XDG_STATE_HOME");
}

class FileMemory final : public rig::PlatformMemory {
 public:
  FileMemory(fs::path file, rig::AskedPerson* asked) : file_(std::move(file)), asked_(asked) {}

  std::optional<rig::PlatformPlace> recall() override {
    if (!fs::exists(file_)) return std::nullopt;
    const nlohmann::json document = read_json_file(file_);
    ObjectReader reader(document, file_.string(), kKind);
    rig::PlatformPlace place;
    place.steps = static_cast<std::int64_t>(reader.number("steps", -1e9, 1e9));
    place.angle_rad = reader.number("angle_deg", -720, 720) * kDegree;
    place.turning = reader.flag("turning");
    place.lost = document.contains("lost") && reader.flag("lost");
    reader.finish();
    return place;
  }

  void keep(const rig::PlatformPlace& place) override {
    fs::create_directories(file_.parent_path());
    write_json_file(file_, {{"format", std::string("threadstation/") + kKind},
                            {"version", current_version(kKind)},
                            {"steps", place.steps},
                            {"angle_deg", place.angle_rad / kDegree},
                            {"turning", place.turning},
                            {"lost", place.lost}});
  }

  bool ask_for_mark(const std::string& why) override {
    if (asked_ == nullptr) return false;
    rig::ask_or_end(*asked_, {.text = "Nobody knows where the platform stands (" + why +
                                      "). Turn it by hand until its mark is in front."});
    return true;
  }

 private:
  fs::path file_;
  rig::AskedPerson* asked_;
};

}  // namespace

bool remembers_its_place(const RigFile& rig) {
  return rig.turntable_wire && rig.turntable_wire->line != TurntableWire::Line::simulated &&
         rig.turntable_wire->stepper.home_by == rig::HomeBy::here;
}

fs::path platform_memory_file(const RigFile& rig) {
  if (!remembers_its_place(rig))
    throw std::runtime_error(
        "rig \"" + rig.name +
        "\" has no turntable whose place is remembered: it finds its home by itself or is turned by hand");
  const bool serial = rig.turntable_wire->line == TurntableWire::Line::serial;
  std::string name =
      lasting_name(rig.turntable_wire->port, serial ? rig::find_serial_ports() : std::vector<rig::FoundDevice>());
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.' && c != '-') c = '_';
  return state_folder() / ("platform" + (name.starts_with('_') ? name : "_" + name) + ".json");
}

std::string lasting_name(const rig::SerialPortChoice& port, const std::vector<rig::FoundDevice>& found) {
  std::error_code nowhere;
  const std::string device = fs::canonical(port.port, nowhere).string();
  const auto same = std::ranges::find_if(found, [&](const rig::FoundDevice& one) {
    return port.usb_serial.empty() ? one.port == device : one.serial == port.usb_serial;
  });
  if (same != found.end()) return same->recommended;
  return port.usb_serial.empty() ? port.port : port.usb_serial;
}

std::shared_ptr<rig::PlatformMemory> remember_platform(const fs::path& file, rig::AskedPerson* asked) {
  return std::make_shared<FileMemory>(file, asked);
}

void leave_at_zero(const RigFile& rig, rig::Turntable& turntable) {
  if (remembers_its_place(rig)) turntable.move_to(0);
}

void forget_platform(const fs::path& file) {
  fs::remove(file);
}

}  // namespace station
