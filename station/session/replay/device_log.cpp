#include "station/session/replay/device_log.h"

#include <fcntl.h>

#include <fstream>
#include <stdexcept>

#include "rig/cameras/camera_frames.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/plan_file.h"

namespace station {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

fs::path log_file(const fs::path& session) {
  return session / kReplayFolder / "devices.jsonl";
}

// Calls `ask`, writes down what came back, and passes it on.
template <typename Ask, typename ToJson>
auto recorded(DeviceLog& log, json line, const Ask& ask, const ToJson& to_json) {
  try {
    auto answer = ask();
    line["answer"] = to_json(answer);
    log.add(line);
    return answer;
  } catch (const std::exception& error) {
    if (line.contains("answer")) throw;  // the log itself
    line["error"] = error.what();
    log.add(line);
    throw;
  }
}

class RecordedCamera final : public rig::Camera {
 public:
  RecordedCamera(rig::Camera& camera, DeviceLog& log) : camera_(camera), log_(log) {}

  rig::CameraIdentity identity() override {
    return recorded(
        log_, {{"call", "identity"}}, [&] { return camera_.identity(); },
        [](const rig::CameraIdentity& camera) {
          return json{{"make", camera.make},
                      {"model", camera.model},
                      {"serial", camera.serial},
                      {"width_px", camera.width_px},
                      {"height_px", camera.height_px}};
        });
  }
  std::vector<double> shutter_times_s() override {
    if (times_s_.empty())
      times_s_ = recorded(
          log_, {{"call", "shutter_times_s"}}, [&] { return camera_.shutter_times_s(); },
          [](const std::vector<double>& times_s) { return json(times_s); });
    return times_s_;
  }
  rig::CameraSettings configure(const rig::CameraSettings& wanted) override {
    return recorded(
        log_, {{"call", "configure"}, {"asked", rig::settings_to_json(wanted)}},
        [&] { return camera_.configure(wanted); }, rig::settings_to_json);
  }
  rig::Picture capture() override {
    return recorded(
        log_, {{"call", "capture"}}, [&] { return camera_.capture(); },
        [](const rig::Picture& picture) {
          return json{{"sha256", sha256_hex(picture.bytes)},
                      {"extension", picture.extension},
                      {"settings", rig::settings_to_json(picture.settings)},
                      {"utc", picture.utc}};
        });
  }
  std::vector<std::byte> preview() override { return camera_.preview(); }  // looked at, never kept

 private:
  rig::Camera& camera_;
  DeviceLog& log_;
  std::vector<double> times_s_;
};

class RecordedTurntable final : public rig::Turntable {
 public:
  RecordedTurntable(rig::Turntable& turntable, DeviceLog& log) : turntable_(turntable), log_(log) {}

  void home() override {
    recorded(
        log_, {{"call", "home"}}, [&] { return turntable_.home(), true; }, [](bool done) { return json(done); });
  }
  void move_to(double angle_rad) override {
    recorded(
        log_, {{"call", "move_to"}, {"asked", angle_rad}}, [&] { return turntable_.move_to(angle_rad), true; },
        [](bool done) { return json(done); });
  }
  void stop() override { turntable_.stop(); }  // from any thread, and nothing hangs on its answer
  double angle_rad() override {
    return recorded(
        log_, {{"call", "angle_rad"}}, [&] { return turntable_.angle_rad(); },
        [](double angle_rad) { return json(angle_rad); });
  }
  rig::TurntableState state() override { return turntable_.state(); }
  void stands_at(double angle_rad) override {
    recorded(
        log_, {{"call", "stands_at"}, {"asked", angle_rad}}, [&] { return turntable_.stands_at(angle_rad), true; },
        [](bool done) { return json(done); });
  }

 private:
  rig::Turntable& turntable_;
  DeviceLog& log_;
};

class RecordedOperator final : public rig::Operator {
 public:
  RecordedOperator(rig::Operator& person, DeviceLog& log) : person_(person), log_(log) {}

  void arrange(const rig::Arrangement& wanted) override {
    recorded(
        log_,
        {{"call", "arrange"},
         {"mounting", mounting_name(wanted.mounting)},
         {"lamp", lamp_name(wanted.lamp)},
         {"room_light", wanted.room_light}},
        [&] { return person_.arrange(wanted), true; }, [](bool done) { return json(done); });
  }

 private:
  rig::Operator& person_;
  DeviceLog& log_;
};

}  // namespace

DeviceLog::DeviceLog(const fs::path& session, const std::vector<std::string>& reshoot, FileSystem& file_system)
    : folder_(session / kReplayFolder), file_system_(&file_system) {
  std::error_code code;
  fs::create_directories(folder_, code);
  if (code) throw std::runtime_error(write_problem(folder_, code));
  try {
    file_ = file_system.open(log_file(session), O_WRONLY | O_CREAT | O_APPEND);
  } catch (const std::system_error& error) {
    throw std::runtime_error(write_problem(log_file(session), error.code()));
  }
  add({{"run", {{"reshoot", reshoot}}}});
}

void DeviceLog::add(const json& line) {
  const std::string text = line.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
  try {
    file_system_->write(file_, std::as_bytes(std::span(text)));
  } catch (const std::system_error& error) {
    throw std::runtime_error(write_problem(folder_ / "devices.jsonl", error.code()));
  }
}

void DeviceLog::keep_test(const rig::Picture& test) {
  const fs::path file = folder_ / (sha256_hex(test.bytes).substr(0, 16) + "." + test.extension);
  if (!fs::exists(file)) store_file(*file_system_, file, test.bytes);
}

bool is_recorded(const fs::path& session) {
  return fs::is_regular_file(log_file(session));
}

std::vector<RecordedRun> read_device_log(const fs::path& session) {
  if (!is_recorded(session))
    throw std::runtime_error("'" + session.string() +
                             "' holds no recording of its devices; capture it with --record to be able to replay it");
  std::ifstream in(log_file(session), std::ios::binary);
  std::vector<RecordedRun> runs;
  int number = 0;
  for (std::string line; std::getline(in, line) && !in.eof();) {  // eof: no newline, torn
    ++number;
    const json call = json::parse(line, nullptr, false);
    const bool begins = call.is_object() && call.contains("run");
    if (!call.is_object() || (!begins && (runs.empty() || !call.contains("call"))))
      throw std::runtime_error("'" + log_file(session).string() + "' line " + std::to_string(number) +
                               " is no record of a device; restore it from a copy");
    if (begins)
      runs.push_back({.reshoot = call.at("run").value("reshoot", std::vector<std::string>()), .calls = {}});
    else
      runs.back().calls.push_back(call);
  }
  if (runs.empty()) throw std::runtime_error("'" + log_file(session).string() + "' is empty; restore it from a copy");
  return runs;
}

StandIns record_devices(const RunDevices& devices, const std::function<StopWish()>& wish, DeviceLog& log) {
  StandIns result;
  result.camera = std::make_unique<RecordedCamera>(devices.camera, log);
  result.turntable = std::make_unique<RecordedTurntable>(devices.turntable, log);
  result.person = std::make_unique<RecordedOperator>(devices.person, log);
  result.wish = [wish, &log, told = false]() mutable {
    const StopWish now = wish();
    if (now != StopWish::none && !told) {
      log.add({{"call", "stop_wish"}, {"wish", now == StopWish::pause ? "pause" : "now"}});
      told = true;
    }
    return now;
  };
  return result;
}

}  // namespace station
