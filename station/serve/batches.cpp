#include "station/serve/batches.h"

#include <exception>
#include <stdexcept>

#include "station/batch/batch_report.h"
#include "station/batch/do_batch.h"
#include "station/serve/page_answers.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

fs::path existing_batch(const Workspace& workspace, const std::string& name) {
  const fs::path folder = workspace.batch(checked_name(name));
  if (!fs::exists(folder / "items.json")) throw Refused(404, "there is no batch " + name);
  return folder;
}

}  // namespace

json batches_document(const Workspace& workspace) {
  json batches = json::array();
  for (const std::string& name : folders_in(workspace.folder() / "batches")) {
    if (!fs::exists(workspace.batch(name) / "items.json")) continue;
    json batch;
    try {
      batch = batch_status(workspace.batch(name));
    } catch (const std::exception& problem) {
      batch["problem"] = problem.what();
    }
    batch["name"] = name;
    batches.push_back(batch);
  }
  return batches;
}

std::string batch_report_page(const Workspace& workspace, const std::string& name) {
  return batch_page(batch_status(existing_batch(workspace, name)));
}

std::string stop_batch(const Workspace& workspace, const std::string& name) {
  const fs::path folder = existing_batch(workspace, name);
  try {
    return cancel_batch(folder);
  } catch (const std::runtime_error& problem) {
    throw Refused(409, problem.what());
  }
}

}  // namespace station
