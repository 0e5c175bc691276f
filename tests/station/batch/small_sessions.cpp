#include "tests/station/batch/small_sessions.h"

#include "station/documents/disk/sha256.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace fs = std::filesystem;
using nlohmann::json;

void make_sessions(const fs::path& folder, int count, bool developed) {
  const fs::path first = folder / "first";
  fs::copy(fs::path(FIXTURES_DIR) / "formats" / "2026-11" / "session", first, fs::copy_options::recursive);
  if (developed) {
    const ProgramResult said = run_threadstation({"develop", first, "--quiet"});
    if (said.status != 0) throw std::runtime_error(said.error);
    fs::remove_all(first / "raw");
  }
  fs::create_directory(folder / "sessions");
  for (int i = 0; i < count; ++i)
    fs::copy(first, folder / "sessions" / station::formatted("s%02d", i), fs::copy_options::recursive);
  fs::remove_all(first);
}

std::string written_plan(const fs::path& folder, const json& steps, const json& more) {
  json plan{
      {"format", "threadstation/batch"}, {"version", 1}, {"sessions", json::array({"sessions/*"})}, {"steps", steps}};
  plan.update(more);
  station::write_json_file(folder / "plan.json", plan);
  return folder / "plan.json";
}

std::map<std::string, std::string> made_in(const fs::path& folder) {
  std::map<std::string, std::string> hashes;
  const auto add = [&](const fs::path& below) {
    if (!fs::exists(below)) return;
    for (const auto& entry : fs::recursive_directory_iterator(below))
      if (entry.is_regular_file()) hashes[fs::relative(entry.path(), folder)] = station::sha256_of_file(entry.path());
  };
  add(folder / "batch" / "results");
  for (const auto& session : fs::directory_iterator(folder / "sessions"))
    for (const char* part : {"linear", "masks", "result"}) add(session.path() / part);
  return hashes;
}

json record_in(const fs::path& folder, const std::string& step, const std::string& item) {
  const fs::path file = folder / "batch" / "tasks" / step / item / "record.json";
  return fs::exists(file) ? station::read_json_file(file) : json();
}

}  // namespace station_test
