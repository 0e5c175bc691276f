// A rig calibration for people: what was found, whether it is good enough and why, and where its errors lie.
#pragma once

#include <filesystem>
#include <string>

#include "station/documents/calibration_file.h"

namespace station {

// The report as HTML: facts, gates, error budget, and plots of corner residuals and coverage, projection uncertainty,
// angles and light.
std::string calibration_section(const RigCalibration& calibration);

// Writes the same as a page of its own, <folder>/calibration.html, and returns that file.
std::filesystem::path write_calibration_page(const std::filesystem::path& folder, const RigCalibration& calibration);

}  // namespace station
