// What a run leaves behind: every picture and every event on the disk before the next thing is done.
//
// Journal events, in this order for a step (picture_record.h has the picture's data):
//   start   {"plan_sha256", "files": {path: sha256}}; resume {"plan_sha256"} in later runs
//   camera  {"make", "model", "serial", "width_px", "height_px"}
//   arranged {"step", "mounting", "lamp", "room_light"}     the person has made the arrangement
//   metering {"step", "exposure_s", "test_pictures", "converged"}; warning {"step", "message"}
//   lamp_watch {"step", "test_pictures", "waited_s", "change" (absent: the lamp could not be read twice)}
//   refused  {"step", "file", "sha256", "verdict"}          a picture that does not serve, kept in refused/
//   picture  the file is on the disk under its final name; with its verdict
//   discarded {"file", "reason"}                            before the file is moved to refused/
//   stop    {"outcome": a state's name, "message" (suspended and failed only)}
//
// Errors: RecordingFailed, whatever the disk or the journal said.
#pragma once

#include <map>
#include <stdexcept>
#include <string>

#include "rig/devices/camera.h"
#include "station/bench/metering.h"
#include "station/documents/plan.h"
#include "station/session/capture/lamp_watch.h"
#include "station/session/record/picture_record.h"
#include "station/session/record/run_state.h"
#include "station/session/record/session_folder.h"

namespace station {

// The disk or the journal failed; the message is what it said.
class RecordingFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Recorder {
 public:
  explicit Recorder(SessionFolder& session) : session_(session) {}

  // Writes a start or a resume. Afterwards taken() are the pictures that the journal names and whose files have the
  // journalled hash. Every other file in raw/ is set aside. Errors: std::runtime_error for another plan than before.
  void begin(const Plan& plan);

  // Errors: std::runtime_error for another camera than the session was begun with.
  void camera(const rig::CameraIdentity& identity);
  void arranged(const PlanStep& step);
  void metered(const PlanStep& step, const Metering& metering);
  void lamp_watched(const PlanStep& step, const LampSettling& settling);
  void refused(const PlanStep& step, const Verdict& verdict, const rig::Picture& picture);

  // Stores the picture in raw/ and fills in its record's file name, size and hash.
  void keep(PictureRecord record, const rig::Picture& picture);
  // The dark of this record serves for `step` too.
  void keep_same(PictureRecord record, const std::string& step);
  // The picture of a step counts no more; its file goes to refused/.
  void withdraw(const std::string& step, const std::string& reason);
  void stop(RunState outcome, const std::string& message = {});

  const std::map<std::string, PictureRecord>& taken() const { return taken_; }  // by step

 private:
  void discard(const std::string& file, const std::string& reason);
  void keep_what_verifies();
  bool verifies(const PictureRecord& picture) const;

  SessionFolder& session_;
  std::map<std::string, PictureRecord> taken_;
};

}  // namespace station
