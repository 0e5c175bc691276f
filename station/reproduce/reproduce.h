// The figures and numbers of the paper [Xia 2025], made by the program's own commands on the simulated bench, on one
// page with what the paper has.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "station/output/progress.h"
#include "station/reproduce/figures_page.h"

namespace station {

struct ReproduceRequest {
  std::vector<std::string> figures{};  // their numbers; empty: all
  std::filesystem::path out;
  bool quick = false;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Makes the figures, and those that they need; what is there already of the same stays. Writes OUT/figure-N/ with their
// results, and index.html and figures.pdf of all that are there. Returns the page. Errors: std::runtime_error, one
// line, for a figure that there is not, a folder that cannot be made, or when a person has interrupted.
FiguresPage reproduce(const ReproduceRequest& request);

std::string describe(const FiguresPage& page);
nlohmann::json to_json(const FiguresPage& page);

}  // namespace station
