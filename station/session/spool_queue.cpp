#include "station/session/spool_queue.h"

#include <algorithm>
#include <initializer_list>
#include <map>
#include <stdexcept>

#include "station/bench/bench_fault.h"
#include "station/documents/disk/file_name.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/text_table.h"
#include "station/output/interrupt.h"
#include "station/session/record/session_folder.h"
#include "station/session/record/verify.h"

namespace station {
namespace {

constexpr const char* kNone = "none";

// A new session, or the one that is in its folder goes on.
CaptureRequest request_for(const CaptureRequest& queue, const QueuedSpool& spool) {
  CaptureRequest request = queue;
  request.session /= spool.session;
  if (is_session(request.session)) {
    request.new_session.reset();
  } else {
    request.new_session->spool = spool.spool;
    request.new_session->sample = spool.sample;
  }
  return request;
}

// The sessions with one of these outcomes.
std::string names_of(const std::vector<QueueResult>& results, std::initializer_list<QueueOutcome> outcomes) {
  std::string names;
  for (const QueueResult& result : results)
    if (std::ranges::find(outcomes, result.outcome) != outcomes.end())
      names += (names.empty() ? "" : ", ") + result.spool.session;
  return names.empty() ? kNone : names;
}

std::runtime_error bad_row(const std::filesystem::path& file, std::size_t line, const std::string& problem) {
  return std::runtime_error(file.string() + " line " + std::to_string(line) + ": " + problem);
}

QueuedSpool queued(const std::filesystem::path& file, const TextTable& table, const TextTable::Row& row,
                   const std::filesystem::path& spool_above) {
  const auto cell = [&](const char* column) { return table.cell(row, column); };
  QueuedSpool spool{.line = row.line,
                    .sample = {.barcode = cell("barcode"),
                               .name = cell("name"),
                               .lot = cell("lot"),
                               .material = cell("material"),
                               .colour = cell("colour"),
                               .note = cell("note")},
                    .spool = spool_above,
                    .session = {}};
  const std::string& called = spool.sample.barcode.empty() ? spool.sample.name : spool.sample.barcode;
  if (called.empty()) throw bad_row(file, row.line, "neither barcode nor name is filled in; give one of them");
  if (const std::string named = cell("spool"); !named.empty()) spool.spool = file.parent_path() / named;
  if (spool.spool.empty())
    throw bad_row(file, row.line, "no spool file is named, and there is no row above to take it from; fill in spool");
  spool.session = safe_name(called) + (spool.sample.lot.empty() ? "" : "-" + safe_name(spool.sample.lot));
  if (const auto problem = problem_with_name(spool.session)) throw bad_row(file, row.line, *problem);
  return spool;
}

}  // namespace

std::vector<QueuedSpool> read_queue(const std::filesystem::path& file) {
  std::vector<QueuedSpool> queue;
  std::map<std::string, std::size_t> lines;  // by session name
  const TextTable table = read_text_table(file, {}, {"barcode", "name", "lot", "material", "colour", "note", "spool"});
  for (const TextTable::Row& row : table.rows) {
    queue.push_back(queued(file, table, row, queue.empty() ? std::filesystem::path() : queue.back().spool));
    const auto [same, fresh] = lines.emplace(queue.back().session, row.line);
    if (!fresh)
      throw bad_row(file, row.line,
                    "the spool \"" + queue.back().session + "\" stands in line " + std::to_string(same->second) +
                        " already; remove one, or give them lots");
  }
  return queue;
}

std::vector<QueueResult> capture_queue(const std::filesystem::path& table, const CaptureRequest& request,
                                       const std::function<bool(const QueuedSpool&)>& next,
                                       const std::function<RunState(const CaptureRequest&)>& capture) {
  std::vector<QueueResult> results;
  bool sound = true, stopped = false;  // the bench; the queue, by somebody
  for (const QueuedSpool& spool : read_queue(table)) {
    if (stopped || interrupted()) break;
    QueueResult result{.spool = spool, .outcome = QueueOutcome::waiting, .problem = {}};
    const CaptureRequest one = request_for(request, spool);
    try {
      if (is_session(one.session) && verify_session(one.session).complete) {
        result.outcome = QueueOutcome::kept;
      } else if (sound) {
        if (next && !next(spool)) break;
        result.outcome = one.new_session ? QueueOutcome::captured : QueueOutcome::resumed;
        if (const RunState state = capture(one); state != RunState::complete) {
          result.outcome = QueueOutcome::failed;
          result.problem = "was " + state_name(state);
          stopped = true;
        }
      }
    } catch (const BenchFault& fault) {
      result.outcome = QueueOutcome::bench_fault;
      result.problem = fault.what();
      sound = false;
    } catch (const std::exception& error) {
      result.outcome = QueueOutcome::failed;
      result.problem = problem_line(error);
    }
    results.push_back(result);
  }
  return results;
}

std::optional<std::string> pause_line(const std::vector<QueueResult>& results) {
  const auto paused = std::ranges::find(results, QueueOutcome::bench_fault, &QueueResult::outcome);
  if (paused == results.end()) return std::nullopt;
  using enum QueueOutcome;
  std::string line = "the queue is paused by a fault of the bench: " + paused->problem;
  line += "; done: " + names_of(results, {captured, resumed, kept});
  if (const std::string lost = names_of(results, {failed}); lost != kNone) line += "; failed: " + lost;
  return line + "; waiting: " + names_of(results, {bench_fault, waiting}) +
         "; when the bench is put right, the same command goes on from here";
}

}  // namespace station
