#include "station/commands/demo.h"

#include <stdexcept>

#include "station/bench/calibrate/calibrate_rig.h"
#include "station/cloth/preview/cloth_preview.h"
#include "station/data/data_folder.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/documents/thread_file.h"
#include "station/session/capture_session.h"
#include "station/session/develop/develop_session.h"
#include "station/session/results.h"
#include "station/thread/invert/invert_session.h"
#include "station/thread/report/session_report.h"

namespace station {
namespace {

const std::vector<int> kQuickPaths{128, 256, 512};
constexpr int kQuickSamples = 8;

nlohmann::json demo_rig(bool quick) {
  nlohmann::json rig = read_json_file(data_folder() / "rigs" / "simulated.json");
  if (quick) {
    rig["simulation"]["samples_per_pixel"] = 10;
    rig["simulation"]["target_samples_per_pixel"] = 3;
  }
  return rig;
}

// Prepares the folder, which must be new or made by an earlier demo, never somebody's other files. Returns whether
// pictures were kept.
bool prepare_folder(const std::filesystem::path& out, const nlohmann::json& rig, bool fresh) {
  const std::filesystem::path mark = out / "rig.json";
  std::error_code code;
  const bool earlier = std::filesystem::exists(mark);
  if (!earlier && std::filesystem::exists(out) && !std::filesystem::is_empty(out, code))
    throw std::runtime_error(out.string() + " is not an earlier demo's folder and not empty; choose another --out");
  const bool keep = earlier && !fresh && read_json_file(mark) == rig;
  if (!keep) {
    std::filesystem::remove_all(out / "calibration", code);
    std::filesystem::remove_all(out / "session", code);
  }
  std::filesystem::create_directories(out, code);
  if (code)
    throw std::runtime_error("cannot make " + out.string() + ": " + code.message() +
                             "; choose a writable folder with --out");
  write_json_file(mark, rig);
  return keep && std::filesystem::exists(out / "calibration");
}

// Whether this threadstation has developed and fitted the session as it is.
bool is_fitted(const std::filesystem::path& session) {
  const std::filesystem::path views = session / "linear" / "views.json", thread = thread_file_of(session);
  return is_made(views, {session / "journal.jsonl"}) && is_made(thread, {views}) &&
         read_thread(thread).provenance.value("fitted_by", "") == software_version();
}

// Captures, develops and fits.
void digitize(const std::filesystem::path& session, const DemoRequest& request) {
  CaptureRequest capture{.session = session, .progress_style = request.progress_style};
  if (!is_session(session))
    capture.new_session = NewSession{.rig = request.out / "rig.json",
                                     .calibration = request.out / "calibration",
                                     .spool = data_folder() / "spools" / "silk_blue.json"};
  if (capture_session(capture) != RunState::complete)
    throw std::runtime_error("the demo was interrupted; the same command goes on from here");
  develop_session(session, request.progress_style);
  InvertRequest inversion{.session = session, .progress_style = request.progress_style};
  if (request.quick) {
    inversion.fit.paths_per_block = kQuickPaths;
    inversion.fit.other_starts.clear();
    inversion.samples_per_pixel = kQuickSamples;
  }
  invert_session(inversion);
}

}  // namespace

DemoResult run_demo(const DemoRequest& request) {
  const bool kept = prepare_folder(request.out, demo_rig(request.quick), request.fresh);
  const std::filesystem::path session = request.out / "session", thread = thread_file_of(session);
  if (!is_fitted(session)) {
    calibrate_rig({.rig = request.out / "rig.json",
                   .out = request.out / "calibration",
                   .progress_style = request.progress_style});
    digitize(session, request);
  }
  preview_cloth(
      {.cloth = {.thread = thread, .out = cloth_folder(session), .draft = data_folder() / "drafts" / "twill_2_2.json"},
       .quick = request.quick,
       .progress_style = request.progress_style});
  return {.session = session,
          .thread = thread,
          .relative_rmse = read_thread(thread).fit.at("relative_rmse").get<double>(),
          .cloth = cloth_pictures(session),
          .report = write_session_report(session),
          .kept = kept};
}

}  // namespace station
