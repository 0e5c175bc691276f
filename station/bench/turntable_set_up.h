// The settings of a GRBL turntable's controller: shown beside those that the rig file needs, written, and put back.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rig/turntables/grbl_settings.h"
#include "station/documents/rig_file.h"

namespace station {

struct SetUpRequest {
  bool write = false;             // write what differs; otherwise nothing is changed
  std::filesystem::path back_up;  // a new file for the former settings; needed for `write`
  std::filesystem::path restore;  // such a file, whose settings are put back; empty: none
};

struct SetUpRow {
  int number = 0;
  std::string meaning;
  double before = 0;
  std::string expected;          // what is right, in words
  std::optional<double> needed;  // nothing: the value is right
  std::optional<double> after;   // as read back; nothing: it was not written
};

struct SetUpReport {
  std::string firmware;
  std::vector<SetUpRow> rows;
  std::string homing_problem;  // what no setting can change, and what to do; empty: nothing
};

// Connects to the controller of a rig's turntable, whatever its settings are, and does what is asked. The platform does
// not turn. Errors: std::runtime_error, one line: a turntable without such settings, a back-up file that is there
// already, a setting that the controller does not keep.
SetUpReport set_up_turntable(const RigFile& rig, const SetUpRequest& request);

// The same on an open connection.
SetUpReport set_up_turntable(rig::GrblSettingsPort& port, const rig::ControllerSetup& setup,
                             const SetUpRequest& request);

}  // namespace station
