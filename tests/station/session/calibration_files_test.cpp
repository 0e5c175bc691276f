// The files of a calibration that a session keeps.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "station/documents/reader.h"
#include "station/session/capture_session.h"
#include "tests/places.h"

namespace station {
namespace {

TEST(CalibrationFiles, AreThoseOfTheDocumentThatWasGiven) {
  const std::string document = std::string(DATA_DIR) + "/calibrations/simulated.json";
  const CalibrationFiles files = calibration_files(document, read_calibration(document));
  ASSERT_EQ(files.size(), 1U);
  const auto& bytes = files.at("calibration.json");
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  EXPECT_EQ(nlohmann::json::parse(text), read_json_file(document));
}

}  // namespace
}  // namespace station
