// The export of a digitized thread to other programs: the work behind `threadstation export thread`. README.md of this
// folder tells what each file holds and how exact it is.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "station/cloth/export/cloth_brdf.h"
#include "station/cloth/export/fiber_export.h"

namespace station {

struct ExportThreadRequest {
  std::filesystem::path thread, out;
  std::set<std::string> only;             // some of kThreadExports; empty: all for which there is input
  std::optional<ClothBrdfRequest> cloth;  // needed for merl, which describes a cloth
  ProgressStyle progress_style = ProgressStyle::automatic;
};

inline constexpr std::array<const char*, 5> kThreadExports{"mitsuba", "blender", "csv", "numpy", "merl"};

struct ThreadExportReport {
  std::optional<FiberExport> fiber;  // when mitsuba or blender was written
  std::optional<ClothBrdf> cloth;    // when merl was written; without its bytes
  std::vector<std::string> files;    // names within the folder
};

// Writes a new folder: fiber.json (kind "fiber") with thread.xml and thread_material.py, scattering.csv and
// scattering_mean.csv, numpy/, cloth.binary, and export.json with the numbers of the report. Errors:
// std::runtime_error, one line: a thread or draft that cannot be read, merl asked for without a cloth, a folder that
// exists or cannot be written, those of fiber_export() and cloth_brdf(). After an error nothing is written.
ThreadExportReport export_thread(const ExportThreadRequest& request);

std::string describe(const ThreadExportReport& report);
nlohmann::json to_json(const ThreadExportReport& report);

}  // namespace station
