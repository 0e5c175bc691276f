#include "station/session/replay/played_devices.h"

#include <stdexcept>

#include "rig/cameras/camera_frames.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/plan_file.h"

namespace station {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;
using PictureFiles = std::map<std::string, fs::path>;

rig::Picture picture_of(const json& answer, const PictureFiles& files) {
  const auto sha256 = answer.at("sha256").get<std::string>();
  rig::Picture picture{.bytes = {},
                       .extension = answer.at("extension").get<std::string>(),
                       .settings = rig::settings_from_json(answer.at("settings")),
                       .utc = answer.at("utc").get<std::string>()};
  const auto found = files.find(sha256);
  if (found == files.end() && sha256 != sha256_hex(std::string_view()))
    throw std::runtime_error("the recording lacks the picture with the SHA-256 " + sha256 +
                             "; restore the session from a copy");
  if (found != files.end()) picture.bytes = bytes_of_file(found->second);
  return picture;
}

rig::CameraIdentity identity_of(const json& answer) {
  return {.make = answer.at("make"),
          .model = answer.at("model"),
          .serial = answer.at("serial"),
          .width_px = answer.at("width_px"),
          .height_px = answer.at("height_px")};
}

// The calls of one run, one after the other.
class Script {
 public:
  Script(RecordedRun run, PictureFiles pictures) : run_(std::move(run)), pictures_(std::move(pictures)) {}

  const PictureFiles& pictures() const { return pictures_; }

  json answer(const json& asked) {
    if (next_ >= run_.calls.size()) throw RecordingEnds{};
    json recorded = run_.calls[next_];
    const json answer = recorded.value("answer", json());
    const bool failed = recorded.contains("error");
    const std::string error = recorded.value("error", std::string());
    recorded.erase("answer");
    recorded.erase("error");
    if (recorded != asked)
      throw std::runtime_error("the replay asked for " + asked.dump() + " where the recording has " + recorded.dump() +
                               "; it was made with another version of the program, or with another rig");
    ++next_;
    if (failed) throw std::runtime_error(error);
    return answer;
  }

  StopWish wish() {
    if (wish_ == StopWish::none && next_ < run_.calls.size() && run_.calls[next_].at("call") == "stop_wish")
      wish_ = run_.calls[next_++].at("wish") == "pause" ? StopWish::pause : StopWish::now;
    return wish_;
  }

 private:
  RecordedRun run_;
  PictureFiles pictures_;
  std::size_t next_ = 0;
  StopWish wish_ = StopWish::none;
};

[[noreturn]] void refuse_preview() {
  throw std::runtime_error("a recorded session has no live picture; run a capture to see one");
}

class ScriptedCamera final : public rig::Camera {
 public:
  explicit ScriptedCamera(std::shared_ptr<Script> script) : script_(std::move(script)) {}
  rig::CameraIdentity identity() override { return identity_of(script_->answer({{"call", "identity"}})); }
  std::vector<double> shutter_times_s() override {
    if (times_s_.empty()) times_s_ = script_->answer({{"call", "shutter_times_s"}}).get<std::vector<double>>();
    return times_s_;
  }
  rig::CameraSettings configure(const rig::CameraSettings& wanted) override {
    return rig::settings_from_json(script_->answer({{"call", "configure"}, {"asked", rig::settings_to_json(wanted)}}));
  }
  rig::Picture capture() override { return picture_of(script_->answer({{"call", "capture"}}), script_->pictures()); }
  std::vector<std::byte> preview() override { refuse_preview(); }

 private:
  std::shared_ptr<Script> script_;
  std::vector<double> times_s_;
};

class ScriptedTurntable final : public rig::Turntable {
 public:
  explicit ScriptedTurntable(std::shared_ptr<Script> script) : script_(std::move(script)) {}
  void home() override { script_->answer({{"call", "home"}}); }
  void move_to(double angle_rad) override { script_->answer({{"call", "move_to"}, {"asked", angle_rad}}); }
  void stop() override {}
  double angle_rad() override { return script_->answer({{"call", "angle_rad"}}).get<double>(); }
  rig::TurntableState state() override { return rig::TurntableState::idle; }
  void stands_at(double angle_rad) override { script_->answer({{"call", "stands_at"}, {"asked", angle_rad}}); }

 private:
  std::shared_ptr<Script> script_;
};

class ScriptedOperator final : public rig::Operator {
 public:
  explicit ScriptedOperator(std::shared_ptr<Script> script) : script_(std::move(script)) {}
  void arrange(const rig::Arrangement& wanted) override {
    script_->answer({{"call", "arrange"},
                     {"mounting", mounting_name(wanted.mounting)},
                     {"lamp", lamp_name(wanted.lamp)},
                     {"room_light", wanted.room_light}});
  }

 private:
  std::shared_ptr<Script> script_;
};

// What the bench looked like: everything that a picture depends on, as text.
struct Scenery {
  json arrangement = json::object();
  double angle_rad = 0;
  json settings = json::object();

  std::string text() const { return json{arrangement, angle_rad, settings}.dump(); }
};

struct Memory {
  std::map<std::string, std::vector<json>> pictures;  // by scenery
  std::map<std::string, std::size_t> given;           // of each
  std::map<std::string, json> settings;               // asked -> read back
  std::map<double, double> angles;                    // asked -> read
  rig::CameraIdentity identity;
  std::vector<double> times_s;
  PictureFiles files;
  Scenery now;
};

void remember(Memory& memory, const json& call) {
  if (call.contains("error")) return;
  const std::string what = call.at("call");
  const json answer = call.value("answer", json());
  if (what == "identity") memory.identity = identity_of(answer);
  if (what == "shutter_times_s") memory.times_s = answer.get<std::vector<double>>();
  if (what == "configure") memory.settings[call.at("asked").dump()] = answer, memory.now.settings = answer;
  if (what == "move_to") memory.now.angle_rad = call.at("asked").get<double>();
  if (what == "angle_rad") memory.angles[memory.now.angle_rad] = answer.get<double>();
  if (what == "arrange") {
    memory.now.arrangement = call;
    memory.now.arrangement.erase("answer");
  }
  if (what == "capture") memory.pictures[memory.now.text()].push_back(answer);
}

class FreeCamera final : public rig::Camera {
 public:
  explicit FreeCamera(std::shared_ptr<Memory> memory) : memory_(std::move(memory)) {}
  rig::CameraIdentity identity() override { return memory_->identity; }
  std::vector<double> shutter_times_s() override { return memory_->times_s; }
  rig::CameraSettings configure(const rig::CameraSettings& wanted) override {
    const json asked = rig::settings_to_json(wanted);
    const auto found = memory_->settings.find(asked.dump());
    memory_->now.settings = found == memory_->settings.end() ? asked : found->second;
    return rig::settings_from_json(memory_->now.settings);
  }
  std::vector<std::byte> preview() override { refuse_preview(); }
  // Hands out the pictures of one scenery in their order; the last of them is the one that was kept.
  rig::Picture capture() override {
    const auto found = memory_->pictures.find(memory_->now.text());
    if (found == memory_->pictures.end())
      throw std::runtime_error("the recording has no picture of " + memory_->now.text() +
                               "; replay it from its beginning");
    std::size_t& given = memory_->given[found->first];
    const json& answer = found->second.at(given % found->second.size());
    ++given;
    return picture_of(answer, memory_->files);
  }

 private:
  std::shared_ptr<Memory> memory_;
};

class FreeTurntable final : public rig::Turntable {
 public:
  explicit FreeTurntable(std::shared_ptr<Memory> memory) : memory_(std::move(memory)) {}
  void home() override { memory_->now.angle_rad = 0; }
  void move_to(double angle_rad) override { memory_->now.angle_rad = angle_rad; }
  void stop() override {}
  double angle_rad() override {
    const auto found = memory_->angles.find(memory_->now.angle_rad);
    return found == memory_->angles.end() ? memory_->now.angle_rad : found->second;
  }
  rig::TurntableState state() override { return rig::TurntableState::idle; }

 private:
  std::shared_ptr<Memory> memory_;
};

class FreeOperator final : public rig::Operator {
 public:
  explicit FreeOperator(std::shared_ptr<Memory> memory) : memory_(std::move(memory)) {}
  void arrange(const rig::Arrangement& wanted) override {
    memory_->now.arrangement = {{"call", "arrange"},
                                {"mounting", mounting_name(wanted.mounting)},
                                {"lamp", lamp_name(wanted.lamp)},
                                {"room_light", wanted.room_light}};
  }

 private:
  std::shared_ptr<Memory> memory_;
};

}  // namespace

PictureFiles recorded_pictures(const fs::path& session) {
  PictureFiles files;
  for (const char* folder : {"raw", "refused", kReplayFolder}) {
    if (!fs::is_directory(session / folder)) continue;
    for (const fs::directory_entry& entry : fs::directory_iterator(session / folder))
      if (entry.is_regular_file() && entry.path().filename() != "devices.jsonl")
        files[sha256_of_file(entry.path())] = entry.path();
  }
  return files;
}

StandIns play_strictly(const RecordedRun& run, const PictureFiles& pictures) {
  const auto script = std::make_shared<Script>(run, pictures);
  StandIns devices;
  devices.camera = std::make_unique<ScriptedCamera>(script);
  devices.turntable = std::make_unique<ScriptedTurntable>(script);
  devices.person = std::make_unique<ScriptedOperator>(script);
  devices.wish = [script] { return script->wish(); };
  return devices;
}

StandIns play_freely(const std::vector<RecordedRun>& runs, const PictureFiles& pictures) {
  const auto memory = std::make_shared<Memory>();
  memory->files = pictures;
  for (const RecordedRun& run : runs)
    for (const json& call : run.calls) remember(*memory, call);
  memory->now = {};
  StandIns devices;
  devices.camera = std::make_unique<FreeCamera>(memory);
  devices.turntable = std::make_unique<FreeTurntable>(memory);
  devices.person = std::make_unique<FreeOperator>(memory);
  devices.wish = [] { return StopWish::none; };
  return devices;
}

}  // namespace station
