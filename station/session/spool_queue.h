// Many spools are captured one after the other: a table names them, and each has a session folder.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "station/documents/sample.h"
#include "station/session/capture_request.h"
#include "station/session/capture_session.h"

namespace station {

struct QueuedSpool {
  std::size_t line = 0;  // of the table
  Sample sample;
  std::filesystem::path spool;  // spool file: its geometry
  std::string session;          // name of its folder: safe on every system
};

// The table's columns: barcode, name (one of them filled in), lot, material, colour, note, spool. An empty spool cell
// means the same settings as the row above; paths are relative to the table.
// Errors: those of text_table.h; a row without a name, without a spool file, or of a spool (barcode or name, and lot)
// that another row has already; two rows whose session names would be the same.
std::vector<QueuedSpool> read_queue(const std::filesystem::path& file);

// kept: the session was complete already. failed: the queue goes on with the next spool. bench_fault: the queue stops,
// and the spools that are not complete wait.
enum class QueueOutcome { captured, resumed, kept, failed, bench_fault, waiting };

struct QueueResult {
  QueuedSpool spool;
  QueueOutcome outcome = QueueOutcome::captured;
  std::string problem;  // why it failed
};

// Captures each spool of the table, by `capture` and a copy of `request`. That asks for a new session without spool and
// sample, and its `session` is the folder that holds all sessions. `next` asks the person for the next spool and says
// whether to go on; empty: nobody is asked. The queue ends early when a session is paused or aborted, when ctrl-C came,
// or when `next` says so; after a BenchFault nobody is asked for another spool. The same call goes on where it ended.
// Errors: those of read_queue.
std::vector<QueueResult> capture_queue(const std::filesystem::path& table, const CaptureRequest& request,
                                       const std::function<bool(const QueuedSpool&)>& next,
                                       const std::function<RunState(const CaptureRequest&)>& capture = capture_session);

// Which bench fault paused a queue, what is done, failed and waiting, and how it goes on: one line. Nothing when none
// paused it.
std::optional<std::string> pause_line(const std::vector<QueueResult>& results);

}  // namespace station
