// The calibrations of a workspace as the page shows them: a line each, and one in full.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

namespace station {

// {"name", "utc", "rig", "camera", "gates" [{"name", "value" (null where it is no number), "limit", "at_least",
// "passed", "reason"}], "budget" [{"source", "front", "behind": one standard deviation, a part of the radiance}; the
// whole last], "report": whether calibration.html is there}. One that is not solved yet has "name" alone; one that
// cannot be read has "name" and "problem".
nlohmann::json calibration_in_full(const std::filesystem::path& folder);

// Files are read again only when they have changed: the page asks after every change.
class CalibrationLines {
 public:
  // calibration_in_full() without the budget's sources: "error_front" and "error_behind", the whole.
  nlohmann::json line(const std::filesystem::path& folder);

 private:
  struct Known {
    std::filesystem::file_time_type time{};
    nlohmann::json line;
  };
  std::mutex mutex_;
  std::map<std::string, Known> known_;
};

}  // namespace station
