// The options --quiet and --json, which every command with long work has, and the person who answers its questions.
#pragma once

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "rig/people/asked_person.h"
#include "station/output/progress.h"

namespace station {

// The person who is asked on standard output and answers on standard input. A command makes one for all of its
// questions, so that their ids differ.
inline std::unique_ptr<rig::AskedPerson> asked_person(bool json) {
  return (json ? rig::make_person_behind_program : rig::make_person_at_terminal)(std::cin, std::cout);
}

struct OutputOptions {
  bool quiet = false, json = false;

  void add_to(CLI::App& command) {
    CLI::Option* quiet_option = command.add_flag("--quiet", quiet, "no progress, only errors");
    command
        .add_flag("--json", json,
                  "results and questions on standard output, progress on standard error, as JSON for machines")
        ->excludes(quiet_option);
  }
  ProgressStyle progress_style() const {
    return quiet ? ProgressStyle::quiet : json ? ProgressStyle::json_lines : ProgressStyle::automatic;
  }
};

}  // namespace station
