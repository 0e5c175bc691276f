// Figures of a test's own in place of the program's: a folder of data that is the program's for everything else.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {

class OwnFigures {
 public:
  OwnFigures() {
    std::filesystem::create_directories(folder());
    for (const auto& entry : std::filesystem::directory_iterator(DATA_DIR))
      if (entry.path().filename() != "figures")
        std::filesystem::create_symlink(entry.path(), data_ / entry.path().filename().string());
    setenv("THREADSTATION_DATA", data_.path().c_str(), 1);
  }
  ~OwnFigures() { unsetenv("THREADSTATION_DATA"); }
  OwnFigures(const OwnFigures&) = delete;
  OwnFigures& operator=(const OwnFigures&) = delete;

  std::filesystem::path folder() const { return data_ / "figures"; }
  void write(const std::string& name, const nlohmann::json& figure) const {
    station::write_json_file(folder() / name, figure);
  }

 private:
  TemporaryFolder data_;
};

}  // namespace station_test
