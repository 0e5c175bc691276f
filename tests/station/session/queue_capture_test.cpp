// capture --queue as a technician runs it, on the simulated bench with a sensor so coarse that drawing hardly counts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

#include "rig/devices/clock.h"
#include "station/documents/reader.h"
#include "station/output/interrupt.h"
#include "station/session/capture_session.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"
#include "tests/station/commands/simulated_hardware.h"
#include "tests/station/session/hasty_bench.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using station_test::ProgramResult;
using station_test::run_threadstation;
using testing::HasSubstr;

std::string ready(const std::string& name) {
  return std::string(DATA_DIR) + "/" + name + ".json";
}

struct QueueCapture : testing::Test {
  QueueCapture() {
    json calibration = station_test::hasty_calibration(station::read_json_file(ready("calibrations/simulated")));
    calibration["utc"] = rig::SystemClock().utc();  // it must not be too old
    fs::create_directory(folder / "calibration");
    station::write_json_file(folder / "calibration/calibration.json", calibration);
    station::write_json_file(folder / "rig.json",
                             station_test::hasty_rig(station::read_json_file(ready("rigs/simulated"))));
  }
  void write_queue(const std::string& second_spool) const {
    std::ofstream(folder / "spools.csv") << "barcode,lot,material,note,spool\n"
                                         << "4711,A 1,silk,\"left shelf, top\"," << ready("spools/silk_red") << "\n"
                                         << "4712,,,," << second_spool << "\n"
                                         << "4713,,,," << ready("spools/silk_blue") << "\n";
  }
  std::vector<std::string> arguments() const {
    return {"capture",
            "--rig",
            folder / "rig.json",
            "--calibration",
            folder / "calibration",
            "--queue",
            folder / "spools.csv",
            "--out",
            folder / "lab",
            "--unattended",
            "--quiet",
            "--operator",
            "Ada"};
  }
  bool verifies(const char* session) const {
    return run_threadstation({"verify", folder / "lab" / session}).status == 0;
  }

  struct Lab : station_test::TemporaryFolder {
    fs::path operator/(const fs::path& name) const { return path() / name; }
  } folder;
};

TEST_F(QueueCapture, TakesEverySpoolSaysWhichFailedAndGoesOnFromThere) {
  write_queue(folder / "nowhere.json");
  const ProgramResult first = run_threadstation(arguments());
  EXPECT_EQ(first.status, 1);
  EXPECT_EQ(first.error_lines(), 1) << first.error;
  EXPECT_THAT(first.error, HasSubstr("nowhere.json"));
  EXPECT_THAT(first.error, HasSubstr("4712"));
  EXPECT_THAT(first.out, HasSubstr("4711-A-1: captured\n"));
  EXPECT_THAT(first.out, HasSubstr("4713: captured\n")) << "one bad row does not hold up the others";
  EXPECT_TRUE(verifies("4711-A-1"));
  const json session = station::read_json_file(folder / "lab/4711-A-1/session.json");
  EXPECT_EQ(session.at("sample").at("note"), "left shelf, top");
  EXPECT_EQ(session.at("spool").at("material"), "silk");
  EXPECT_EQ(session.at("operator"), "Ada");

  write_queue(ready("spools/silk_gold"));
  const ProgramResult second = run_threadstation(arguments());
  EXPECT_EQ(second.status, 0) << second.error;
  EXPECT_THAT(second.out, HasSubstr("4711-A-1: was complete already\n4712: captured\n4713: was complete already\n"));
  EXPECT_TRUE(verifies("4712"));
}

TEST_F(QueueCapture, KilledInASpoolItCapturesThatOneToItsEndAndTheRest) {
  write_queue(ready("spools/silk_gold"));
  const pid_t process = station_test::start_threadstation(arguments());
  const auto pictures = [&] {
    std::error_code none;
    return std::distance(fs::directory_iterator(folder / "lab/4711-A-1/raw", none), fs::directory_iterator());
  };
  while (pictures() < 3) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(process, SIGKILL);
  EXPECT_EQ(station_test::wait_for(process), 128 + SIGKILL);
  EXPECT_FALSE(verifies("4711-A-1"));
  const ProgramResult rest = run_threadstation(arguments());
  EXPECT_EQ(rest.status, 0) << rest.error;
  EXPECT_THAT(rest.out, HasSubstr("4711-A-1: captured to its end\n4712: captured\n4713: captured\n"));
  for (const char* session : {"4711-A-1", "4712", "4713"}) EXPECT_TRUE(verifies(session)) << session;
}

TEST_F(QueueCapture, CtrlCWhileTheDevicesAreConnectedPausesTheSession) {
  station::watch_interrupts(2);
  ::raise(SIGINT);
  station::CaptureRequest request{
      .session = folder / "one",
      .new_session = station::NewSession{
          .rig = folder / "rig.json", .calibration = folder / "calibration", .spool = ready("spools/silk_red")}};
  request.progress_style = station::ProgressStyle::quiet;
  EXPECT_EQ(station::capture_session(request), station::RunState::paused);
  station::watch_interrupts();
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; ++at) ++found;
  return found;
}

// A technician at a rig whose turntable and camera are other programs, with a table of three spools: the second one has
// no spool file. Short exposures, because all this is in real time.
struct QueueOnAWire : QueueCapture {
  QueueOnAWire() {
    write_queue(folder / "nowhere.json");
    json calibration = station::read_json_file(ready("calibrations/simulated"));
    calibration["utc"] = rig::SystemClock().utc();
    calibration.erase("sensor");
    station::write_json_file(folder / "calibration/calibration.json", calibration);
    json rig = station::read_json_file(ready("rigs/simulated"));
    const json wire = station::read_json_file(ready("rigs/simulated_wire_grbl"));
    for (const char* key : {"camera", "camera_connection", "turntable", "turntable_setup"}) rig[key] = wire[key];
    rig["camera_connection"].update({{"port", camera.camera_port()}, {"width_px", 600}, {"height_px", 400}});
    rig["turntable_setup"].update({{"line", "pty"}, {"port", port.string()}});
    rig["operator"] = "console";
    rig["capture"].update({{"target_level", 0.05}, {"bracket_stops", json::array()}});
    station::write_json_file(folder / "rig.json", rig);
  }
  ~QueueOnAWire() override { fs::remove(port); }
  // One of the wire's two devices; the other one is in process, where nobody asks it.
  static json with_one_device(const char* device, const char* setup) {
    json rig = station::read_json_file(ready("rigs/simulated_wire_grbl"));
    rig[device] = "simulated";
    rig.erase(setup);
    rig["simulation"]["turntable"]["speed_deg_s"] = 300;  // in real time
    return rig;
  }
  void plug_in_turntable(const std::string& faults = {}) {
    turntable.emplace(with_one_device("camera", "camera_connection"), faults);
    fs::remove(port);
    fs::create_symlink(turntable->turntable_port(), port);
  }
  // Every question is answered with `answer` on a line of its own, often enough.
  ProgramResult capture(const std::string& options, const std::string& answer) const {
    std::string command = "yes '" + answer + "' | head -n 40 | " + THREADSTATION_PROGRAM;
    for (const std::string& word : arguments())
      if (word != "--unattended" && word != "--quiet") command += " '" + word + "'";
    return station_test::run_shell(command + " " + options);
  }
  station_test::SimulatedHardware camera{with_one_device("turntable", "turntable_setup")};
  std::optional<station_test::SimulatedHardware> turntable;
  // It stays the turntable's when that one comes back at another port; rig files name ports below /dev.
  const fs::path port = fs::path("/dev/shm") / folder.path().filename();
};

TEST_F(QueueOnAWire, ATurntableThatIsUnpluggedPausesTheQueueAndTheSameCommandGoesOn) {
  const json unplugged{{"at_operation", 12}, {"fault", "unplug"}};
  json faults = station::read_json_file(ready("faults/example"));
  faults.update({{"turntable", json::array({unplugged})}, {"camera", json::array()}});
  station::write_json_file(folder / "faults.json", faults);
  plug_in_turntable(folder / "faults.json");
  const char* pause = "the queue is paused by a fault of the bench: ";
  const char* waiting = "done: none; waiting: 4711-A-1, 4712, 4713; when the bench is put right, the same command";
  const ProgramResult lost = capture("--quiet", "");
  EXPECT_EQ(lost.status, 1);
  EXPECT_EQ(lost.error_lines(), 1) << lost.error;
  for (const char* words : {pause, "unplugged", waiting}) EXPECT_THAT(lost.error, HasSubstr(words));
  EXPECT_EQ(count(lost.out, "Put it on the holder."), 1U) << lost.out;
  EXPECT_THAT(lost.out, HasSubstr("4712: waits\n4713: waits\n"));

  turntable.reset();  // and as the technician's page runs it
  const ProgramResult gone = capture("--json", R"({"id": 1, "answer": "done"})");
  EXPECT_EQ(gone.status, 1);
  for (const char* words : {pause, "could not be opened", waiting}) EXPECT_THAT(gone.error, HasSubstr(words));
  EXPECT_EQ(count(gone.out, "Put it on the holder."), 1U) << gone.out;

  plug_in_turntable();
  const ProgramResult rest = capture("--quiet", "");
  EXPECT_EQ(rest.status, 1);
  EXPECT_THAT(rest.error, HasSubstr("nowhere.json"));
  EXPECT_THAT(rest.error, testing::Not(HasSubstr("paused"))) << "a fault of one spool";
  EXPECT_THAT(rest.out, HasSubstr("4711-A-1: captured to its end\n4712: failed: "));
  EXPECT_THAT(rest.out, HasSubstr("4713: captured\n"));
  EXPECT_EQ(count(rest.out, "Put it on the holder."), 3U) << rest.out;
}

}  // namespace
