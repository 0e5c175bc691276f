// A batch from its plan to its end, here or by Slurm: the work behind `threadstation batch`.
//
// Errors: those of batch_work.h, local_batch.h and slurm_batch.h.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "station/batch/local_batch.h"

namespace station {

struct DoBatchRequest {
  std::filesystem::path plan, folder;
  std::string on = "local";  // or slurm
  LocalRequest local;
  bool wait = false;  // for Slurm to end it; ctrl-C ends the waiting alone
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct BatchOutcome {
  nlohmann::json description;  // batch_report.h
  std::string submitted;       // what Slurm was given: a line
  std::size_t tasks = 0, bad = 0;
};

BatchOutcome do_batch(const DoBatchRequest& request);
nlohmann::json batch_status(const std::filesystem::path& folder);  // of batch_report.h
std::string cancel_batch(const std::filesystem::path& folder);     // what was done, a line

}  // namespace station
