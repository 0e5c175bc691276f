// The last picture that the rig's camera made, by whichever job, and what it shows of the bench: histogram, exposure,
// focus, tags, and the lamp through the session.
#pragma once

#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "station/documents/rig_file.h"
#include "station/serve/workspace.h"

namespace station {

// The file that a session's journal has of a step; none without a picture, or when the journal names a file that is not
// one of raw/.
std::optional<std::filesystem::path> picture_of_step(const std::filesystem::path& session, const std::string& step);

// A raw file for people: half as wide as the sensor, brightness of its own. The last ones are remembered. Errors: those
// of read_sensor_file.
cv::Mat3b shown_sensor_file(const std::filesystem::path& file);

class LastFrame {
 public:
  // Both must outlive it.
  LastFrame(const Workspace& workspace, const RigFile& rig) : workspace_(workspace), rig_(rig) {}

  // {"source": of whom, "kind": "raw" or "preview", "id": another one for another picture, "width_px", "height_px",
  //  "histogram": {"r", "g", "b": 64 parts of the pixels from black to white},
  //  "exposure": {"exposure_s", "level": 0 to 1 that the brightest reach, "aim", "saturated": part} (raw only),
  //  "focus": {"blur_px", "doubtful_px", "bad_px"} (absent: no tag's edge to read it by),
  //  "tags": [{"where", "seen", "printed"}], "lamp": [{"step", "percent" of the calibrated lamp}]}; null without any
  //  picture.
  nlohmann::json document();
  // The picture itself, for people. Throws Refused (404) when there is none.
  cv::Mat3b picture() const;

 private:
  struct Found {
    std::filesystem::path file, session;  // session: empty for a picture of none
    std::string source;
    bool raw = true;
    std::string id() const;
  };
  std::optional<Found> newest() const;
  nlohmann::json measured(const Found& frame) const;

  const Workspace& workspace_;
  const RigFile& rig_;
  std::mutex mutex_;
  std::string known_id_;
  nlohmann::json known_;
};

}  // namespace station
