#include "tests/station/session/recorded_bench.h"

#include "station/bench/bench_picture.h"
#include "station/documents/plan_file.h"
#include "station/documents/reader.h"
#include "station/session/capture_session.h"
#include "tests/places.h"

namespace station {
namespace {

class Camera final : public rig::Camera {
 public:
  explicit Camera(RecordedBench& bench) : bench_(bench) {}
  rig::CameraIdentity identity() override { return bench_.camera->identity(); }
  std::vector<double> shutter_times_s() override { return bench_.camera->shutter_times_s(); }
  rig::CameraSettings configure(const rig::CameraSettings& wanted) override { return bench_.camera->configure(wanted); }
  rig::Picture capture() override { return bench_.on_capture(*bench_.camera); }
  std::vector<std::byte> preview() override { return bench_.camera->preview(); }

 private:
  RecordedBench& bench_;
};

class Turntable final : public rig::Turntable {
 public:
  explicit Turntable(RecordedBench& bench) : bench_(bench) {}
  void home() override { bench_.turntable->home(); }
  void move_to(double angle_rad) override { bench_.on_move(*bench_.turntable, angle_rad); }
  void stop() override { bench_.turntable->stop(); }
  double angle_rad() override { return bench_.on_read(*bench_.turntable); }
  rig::TurntableState state() override { return bench_.turntable->state(); }

 private:
  RecordedBench& bench_;
};

class Person final : public rig::Operator {
 public:
  explicit Person(RecordedBench& bench) : bench_(bench) {}
  void arrange(const rig::Arrangement& wanted) override { bench_.on_arrange(*bench_.person, wanted); }

 private:
  RecordedBench& bench_;
};

}  // namespace

std::filesystem::path recorded_session() {
  return std::filesystem::path(FIXTURES_DIR) / "sessions" / "silk_red";
}

RecordedBench::RecordedBench()
    : asked(read_session_file(recorded_session())), calibration(read_calibration(recorded_session() / "calibration")) {
  Plan plan;
  for (const char* id : {"pose-horizontal-1", "pose-horizontal-2", "reflection-horizontal-1", "reflection-horizontal-2",
                         "reflection-horizontal-3", "transmission-1"})
    plan.steps.push_back(*find_step(asked.plan, id));
  asked.plan = plan;
  bench =
      std::make_unique<rig::SimulatedBench>(asked.rig.simulation->truth, make_bench_picture(asked.rig, asked.spool));
  camera = rig::make_simulated_camera(*bench, *clock);
  turntable = rig::make_simulated_turntable(*bench, *clock);
  person = rig::make_simulated_operator(*bench);
}

std::string RecordedBench::run(const RunOptions& options, const CaptureRequest& request) {
  Camera watched_camera(*this);
  Turntable watched_turntable(*this);
  Person watched_person(*this);
  return message_of([&] {
    nlohmann::json document = read_json_file(recorded_session() / "session.json");
    document["plan"] = plan_to_json(asked.plan);
    SessionFolder session =
        is_session(path)
            ? SessionFolder::open(path, *clock, disk)
            : SessionFolder::create(path, document, calibration_files(recorded_session() / "calibration", calibration),
                                    *clock, disk);
    run_session(session, {watched_camera, watched_turntable, watched_person, *clock}, asked, calibration, request,
                options);
  });
}

std::string RecordedBench::outcome() const {
  return state_name(state_of(records(), false));
}

std::vector<std::string> RecordedBench::refused() const {
  std::vector<std::string> reasons;
  for (const JournalRecord& record : records())
    if (record.event == "refused") reasons.push_back(verdict_from_json(record.data.at("verdict")).reason());
  return reasons;
}

}  // namespace station
