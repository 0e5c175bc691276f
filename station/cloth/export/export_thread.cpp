#include "station/cloth/export/export_thread.h"

#include <cstdio>
#include <stdexcept>

#include "station/cloth/export/blender_material.h"
#include "station/cloth/export/mitsuba_scene.h"
#include "station/cloth/export/scattering_tables.h"
#include "station/documents/disk/new_folder.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/fiber_file.h"
#include "station/documents/reader.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

namespace fs = std::filesystem;

bool wanted(const ExportThreadRequest& request, const char* kind) {
  return request.only.empty() || request.only.contains(kind);
}

bool merl_wanted(const ExportThreadRequest& request) {
  if (request.only.contains("merl") && !request.cloth)
    throw std::runtime_error(
        "merl is the BRDF of a cloth and no --draft was given; give the draft that it is woven by");
  return request.cloth && wanted(request, "merl");
}

void add_fiber(const ExportThreadRequest& request, const ThreadFile& thread, ThreadExportReport& report,
               std::vector<NamedBytes>& files) {
  const bool mitsuba = wanted(request, "mitsuba"), blender = wanted(request, "blender");
  if (!mitsuba && !blender) return;
  report.fiber = fiber_export(thread);
  files.push_back({"fiber.json", to_json(report.fiber->nearest.fiber).dump(2) + "\n"});
  if (mitsuba) files.push_back({"thread.xml", mitsuba_scene(*report.fiber)});
  if (blender) files.push_back({"thread_material.py", blender_material(*report.fiber)});
}

void add_tables(const ExportThreadRequest& request, const ThreadFile& thread, std::vector<NamedBytes>& files) {
  const bool csv = wanted(request, "csv"), numpy = wanted(request, "numpy");
  if (!csv && !numpy) return;
  const ScatteringTables tables = scattering_tables(thread.parameters);
  if (csv) {
    files.push_back({"scattering.csv", scattering_csv(tables)});
    files.push_back({"scattering_mean.csv", mean_scattering_csv(tables)});
  }
  if (numpy)
    for (NamedBytes& array : scattering_arrays(tables))
      files.push_back({"numpy/" + array.name, std::move(array.bytes)});
}

std::vector<NamedBytes> all_files(const ExportThreadRequest& request, const ThreadFile& thread,
                                  ThreadExportReport& report) {
  ProgressDisplay progress("export", request.progress_style);
  std::vector<NamedBytes> files;
  add_fiber(request, thread, report, files);
  add_tables(request, thread, files);
  if (merl_wanted(request)) {
    report.cloth = cloth_brdf(thread, *request.cloth, progress);
    files.push_back({"cloth.binary", std::move(report.cloth->merl)});
  }
  return files;
}

void write(const fs::path& folder, const std::vector<NamedBytes>& files) {
  for (const NamedBytes& file : files) {
    const fs::path path = folder / file.name;
    make_folder(path.parent_path());
    write_text_file(path, file.bytes);
  }
}

}  // namespace

ThreadExportReport export_thread(const ExportThreadRequest& request) {
  const ThreadFile thread = read_thread(request.thread);
  merl_wanted(request);
  make_new_folder(request.out);
  watch_interrupts();
  ThreadExportReport report;
  try {
    FileSystem disk;
    check_can_store(disk, request.out / "export.json");
    std::vector<NamedBytes> files = all_files(request, thread, report);
    for (const NamedBytes& file : files) report.files.push_back(file.name);
    nlohmann::json document = to_json(report);
    document["thread"] = thread.name;
    files.push_back({"export.json", document.dump(2) + "\n"});
    write(request.out, files);
  } catch (...) {
    std::error_code ignored;
    fs::remove(request.out, ignored);  // when it is empty still
    throw;
  }
  return report;
}

std::string describe(const ThreadExportReport& report) {
  std::string text;
  if (report.fiber)
    for (const std::string& line : approximation(*report.fiber)) text += line + "\n";
  if (report.cloth) {
    char line[256];
    std::snprintf(
        line, sizeof line,
        "%s: its BRDF changes by %.1f %% when the cloth is turned, which the table has the mean of; noise of a cell "
        "%.1f %%\n",
        report.cloth->draft.c_str(), 100 * report.cloth->anisotropy, 100 * report.cloth->noise);
    text += line;
  }
  for (const std::string& file : report.files) text += "wrote " + file + "\n";
  return text;
}

nlohmann::json to_json(const ThreadExportReport& report) {
  nlohmann::json document{{"files", report.files}};
  if (report.fiber) document["fiber"] = to_json(report.fiber->nearest.agreement);
  if (report.cloth)
    document["cloth"] = {{"draft", report.cloth->draft},
                         {"anisotropy", report.cloth->anisotropy},
                         {"noise", report.cloth->noise},
                         {"cover", report.cloth->cover}};
  return document;
}

}  // namespace station
