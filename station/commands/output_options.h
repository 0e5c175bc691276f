// --quiet and --json, which every command with long work has.
#pragma once

#include <CLI/CLI.hpp>

#include "station/progress.h"

namespace station {

struct OutputOptions {
  bool quiet = false, json = false;

  void add_to(CLI::App& command) {
    CLI::Option* quiet_option = command.add_flag("--quiet", quiet, "no progress, only errors");
    command
        .add_flag("--json", json, "results on standard output and progress on standard error as JSON, for machines")
        ->excludes(quiet_option);
  }
  ProgressStyle progress_style() const {
    return quiet ? ProgressStyle::quiet : json ? ProgressStyle::json : ProgressStyle::automatic;
  }
};

}  // namespace station
