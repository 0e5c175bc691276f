// The capture's part of a session report: who, with what, when; a verdict for each picture; exposure and lamp through the
// session; every file's checksum.
#pragma once

#include <filesystem>
#include <string>

#include "station/documents/calibration_file.h"
#include "station/documents/session_file.h"

namespace station {

// HTML. From session.json and the journal alone; what was not looked at is not shown.
std::string capture_facts(const std::filesystem::path& session, const SessionFile& asked,
                          const RigCalibration& calibration);
std::string verdict_section(const std::filesystem::path& session, const SessionFile& asked);
std::string checksum_section(const std::filesystem::path& session);

}  // namespace station
