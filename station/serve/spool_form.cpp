#include "station/serve/spool_form.h"

#include <filesystem>

#include "station/bench/spool_fibers.h"
#include "station/data/data_folder.h"
#include "station/documents/disk/file_name.h"
#include "station/documents/reader.h"
#include "station/documents/sample.h"
#include "station/documents/spool.h"
#include "station/serve/page_answers.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

fs::path ready_spools() {
  return data_folder() / "spools";
}

}  // namespace

Sample sample_of_form(const json& form) {
  Sample sample{.barcode = text_of(form, "barcode"),
                .name = text_of(form, "name"),
                .lot = text_of(form, "lot"),
                .material = text_of(form, "material"),
                .colour = text_of(form, "colour"),
                .note = text_of(form, "note")};
  for (const std::string* text :
       {&sample.barcode, &sample.name, &sample.lot, &sample.material, &sample.colour, &sample.note})
    if (text->size() > kLongestText) throw Refused(400, "a text of the spool is longer than 200 characters");
  if (sample.name.empty()) sample.name = sample.barcode;
  if (sample.name.empty()) throw Refused(400, "neither barcode nor name is filled in; give one of them");
  return sample;
}

namespace {

json spool_of(const json& form, const Sample& sample, const fs::path& rig) {
  const json bench = read_json_file(rig);
  if (!bench.contains("holder"))
    throw Refused(400, rig.string() +
                           " does not say which holder spools are wound on here; measure its frame and window and "
                           "write them there, as \"holder\" with the keys that spool files have");
  json spool{{"format", "threadstation/spool"},
             {"version", 1},
             {"name", sample.name},
             {"material", sample.material},
             {"holder", bench.at("holder")},
             {"turns", form.value("turns", json())},
             {"thread_diameter_mm", form.value("diameter_mm", json())},
             {"sheets", form.value("sheets", json("front"))}};
  if (const std::string simulated = text_of(form, "simulated"); !simulated.empty()) {
    const fs::path file = ready_spools() / (checked_name(simulated) + ".json");
    if (!fs::exists(file)) throw Refused(404, "there is no simulated spool " + simulated);
    spool["simulation"] = read_json_file(file).at("simulation");
  }
  return spool;
}

}  // namespace

std::string write_spool(const json& form, const Workspace& workspace, const fs::path& rig) {
  const Sample sample = sample_of_form(form);
  const json document = spool_of(form, sample, rig);
  try {
    const Spool spool = parse_spool(document, "the spool");
    if (spool.simulation) spool_fibers(spool);
  } catch (const std::runtime_error& problem) {
    throw Refused(400, problem.what());
  }
  const std::string& called = sample.barcode.empty() ? sample.name : sample.barcode;
  const std::string name = safe_name(called) + (sample.lot.empty() ? "" : "-" + safe_name(sample.lot));
  checked_name(name);
  write_json_file(workspace.spool(name), document);
  write_sample_file(workspace.sample(name), sample);
  return name;
}

std::vector<std::string> simulated_spools() {
  std::vector<std::string> names;
  for (const std::string& name : files_in(ready_spools(), ".json"))
    if (read_json_file(ready_spools() / (name + ".json")).contains("simulation")) names.push_back(name);
  return names;
}

}  // namespace station
