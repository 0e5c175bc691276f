// The capture's part of a session report: who captured what, with what and when; a verdict for each picture; exposure
// and lamp through the session; every file's checksum.
#pragma once

#include <filesystem>
#include <string>

#include "station/documents/calibration_file.h"
#include "station/documents/session_file.h"

namespace station {

// Three sections as HTML, made from session.json and the journal alone; checks that were not made are left out.
// `calibration`: of the session's rig; null where its views were measured elsewhere.
std::string capture_facts(const std::filesystem::path& session, const SessionFile& asked,
                          const RigCalibration* calibration);
std::string verdict_section(const std::filesystem::path& session, const SessionFile& asked);
std::string checksum_section(const std::filesystem::path& session);

}  // namespace station
