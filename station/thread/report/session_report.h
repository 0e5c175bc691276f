// The report of a session, report.html: who, what and when, contact sheet of the developed views with their masks,
// verdicts, exposure and lamp through the session, calibration figures, checksums.
#pragma once

#include <filesystem>

namespace station {

// Writes <session>/report.html, self-contained, <session>/result/contact_sheet.png, and of a fitted session
// <session>/result/models.png (thread_report.h); returns the report's path. A
// session that has not been developed yet has no contact sheet. Errors: std::runtime_error when a file of the session
// is missing.
std::filesystem::path write_session_report(const std::filesystem::path& session);

}  // namespace station
