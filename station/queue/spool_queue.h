// Many spools one after the other: a table of what is to be captured, a session folder for each.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "station/capture_session.h"

namespace station {

struct QueuedSpool {
  std::size_t line = 0;  // of the table
  Sample sample;
  std::filesystem::path spool;  // spool file: its geometry
  std::string session;          // name of its folder: safe on every system
};

// Columns: barcode, name (one of them filled in), lot, material, colour, note, spool. An empty spool cell means the same
// settings as the row above; paths are relative to the table.
// Errors: those of text_table.h; a row without a name, without a spool file, or of a spool (barcode or name, and lot) that
// another row has already; two rows whose session names would be the same.
std::vector<QueuedSpool> read_queue(const std::filesystem::path& file);

// Letters, digits, - and _ of a text; others become one -, accents and other scripts are written as their code ("u00e9").
std::string safe_name(const std::string& text);

struct QueueRequest {
  std::filesystem::path queue;  // the table
  CaptureRequest capture;       // without spool; out: the folder that holds the sessions
  // Asks for the next spool; false: end here. Empty: nobody is asked.
  std::function<bool(const QueuedSpool&)> next;
};

enum class QueueOutcome { captured, resumed, kept, failed };  // kept: it was complete already

struct QueueResult {
  QueuedSpool spool;
  QueueOutcome outcome = QueueOutcome::captured;
  std::string problem;  // of a failed one; the next spool is taken all the same
};

// Ends early when a session is paused or aborted, or `next` says so. Errors: those of read_queue.
std::vector<QueueResult> capture_queue(const QueueRequest& request);

}  // namespace station
