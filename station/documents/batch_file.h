// The plan of a batch (kind "batch"): which steps are to be done with which sessions, threads, scenes, spools and
// figures. Its keys are documented in station/data/batches/README.md.
#pragma once

#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace station {

// What a step is done with. Steps of a session come before those that need its thread.
enum class BatchItemKind { session, thread, scene, spool, figure };
inline constexpr BatchItemKind kBatchItemKinds[] = {BatchItemKind::session, BatchItemKind::thread, BatchItemKind::scene,
                                                    BatchItemKind::spool, BatchItemKind::figure};
const char* name_of(BatchItemKind kind);  // "session"
inline constexpr const char* kKindsOfItems = "sessions, threads, scenes, spools or figures";

struct BatchStep {
  std::string name;     // safe as the name of a folder
  std::string command;  // develop, invert, report, cloth, export, render, validate or reproduce
  std::string model = "thread";
  std::vector<std::string> options;  // of the command, as on its command line
  std::vector<std::string> needs;    // names of earlier steps, of the same item
  // What one item takes, as long as nothing has been measured.
  int cores = 1;
  double memory_gib = 2, minutes = 60;
};

bool is_for(const BatchStep& step, BatchItemKind kind);

struct BatchFile {
  std::string source;                                          // the file
  std::filesystem::path folder;                                // absolute: relative names in it are of here
  std::vector<std::string> names[std::size(kBatchItemKinds)];  // by BatchItemKind; with wildcards
  std::vector<BatchStep> steps;                                // at least one
  int at_once = 0;                                             // most tasks of a step at a time; 0: no limit
  std::vector<std::string> slurm_options;                      // of sbatch, such as --partition=long
  nlohmann::json document;                                     // all of it, with `folder`

  const std::vector<std::string>& names_of(BatchItemKind kind) const { return names[static_cast<std::size_t>(kind)]; }
  const BatchStep* step(const std::string& name) const;  // null when there is none
};

// `folder` stands for the file's own; a document that names a folder has that.
BatchFile parse_batch(const nlohmann::json& document, const std::string& source, const std::filesystem::path& folder);
BatchFile read_batch(const std::filesystem::path& file);

}  // namespace station
