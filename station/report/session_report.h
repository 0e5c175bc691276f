// report.html of a session: contact sheet of the developed views with their masks, exposures, calibration figures.
#pragma once

#include <filesystem>

namespace station {

// Writes <session>/report.html, self-contained, and <session>/result/contact_sheet.png. Returns the report's path.
// Errors: std::runtime_error when the session has not been developed yet, or a file of it is missing.
std::filesystem::path write_session_report(const std::filesystem::path& session);

}  // namespace station
