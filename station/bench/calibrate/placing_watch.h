// What the camera sees while a person puts a target down: the outline where it is wanted, what is not yet right, and
// that it stands still, sharp and right, so that the run may go on by itself.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "calibration/geometry/tags.h"
#include "rig/devices/camera.h"
#include "rig/people/asked_person.h"
#include "station/bench/calibrate/lens_coverage.h"
#include "station/bench/rig_devices.h"
#include "station/documents/rig_file.h"

namespace station {

class PlacingWatch {
 public:
  using Clock = std::function<double()>;  // seconds that only grow
  // All must outlive it. `live`: the JPEG that is written for each frame. `covered`: what pictures have shown of the
  // board, which is told while the board is put down; null: nothing is known of it.
  PlacingWatch(const RigFile& rig, rig::Camera& camera, std::filesystem::path live, Clock now,
               const LensCoverage* covered = nullptr);

  // From now on `wanted` is looked for, with the platform at `angle_rad`. `before`: how the bench stood, if that is
  // known.
  void begin(const std::optional<rig::Arrangement>& before, const rig::Arrangement& wanted, double angle_rad);
  void end() { wanted_.reset(); }
  // Whether there is a target to be seen.
  bool watches() const { return wanted_.has_value(); }

  struct Look {
    std::string remark;      // a sentence
    bool stands = false;     // as wanted, sharp, and still for a second
    bool hands_out = false;  // and nothing in the whole picture has moved in the three seconds that hands had to leave
  };
  // Takes one frame. Errors: those of the camera and of the file.
  Look look();
  // Whether what was asked is all done when the target stands: the lights were not to be changed as well, nor is a
  // curtain to be closed, as it is whenever the room's light is off.
  bool all_is_seen() const { return only_the_target_; }

 private:
  std::string fault(const calibration::TagObservation& seen, const cv::Mat1f& grey) const;

  const RigFile& rig_;
  rig::Camera& camera_;
  std::filesystem::path live_;
  Clock now_;
  const LensCoverage* covered_;
  std::optional<rig::Arrangement> wanted_;
  bool only_the_target_ = false;
  double angle_rad_ = 0;
  // Of the frame before: its tags, and all of it in small.
  calibration::TagObservation before_;
  cv::Mat1f small_before_;
  std::optional<double> still_since_s_;
};

// Passes questions on. While a watch is set, it looks until somebody answers, and ctrl-C declines.
class WatchedPerson final : public rig::AskedPerson {
 public:
  explicit WatchedPerson(rig::AskedPerson& person) : person_(person) {}
  void set_watch(PlacingWatch* watch) { watch_ = watch; }

  std::optional<std::string> ask(const rig::Question& question) override;
  void prepare(const nlohmann::json& context, const std::string& drawing) override {
    person_.prepare(context, drawing);
  }
  void remark(const std::string& seen) override { person_.remark(seen); }

 private:
  rig::AskedPerson& person_;
  PlacingWatch* watch_ = nullptr;
};

// Has `devices.person`, who asks `asked`, watched while targets are put down. `covered` must outlive the person.
void watch_placing(const RigFile& rig, RigDevices& devices, const std::filesystem::path& live, WatchedPerson& asked,
                   const LensCoverage& covered);

}  // namespace station
