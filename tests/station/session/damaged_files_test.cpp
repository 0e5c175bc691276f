// Fuzzing without a fuzzer: thousands of damaged files, seeds printed; each is read or refused, and nothing else
// happens. The fuzz targets of these rooms (their folders fuzz/) go further.
#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "calibration/sensor/sensor_file.h"
#include "station/documents/reader.h"
#include "tests/station/session/recorded_bench.h"

namespace station {
namespace {

namespace fs = std::filesystem;

// A few bytes changed, a piece cut out, or the end cut off.
std::string damaged(std::string text, std::mt19937& random) {
  const auto somewhere = [&] { return std::uniform_int_distribution<std::size_t>(0, text.size() - 1)(random); };
  switch (std::uniform_int_distribution<int>(0, 2)(random)) {
    case 0:
      for (int i = 0; i < 4; ++i) text[somewhere()] = static_cast<char>(random());
      break;
    case 1:
      text.erase(somewhere(), 20);
      break;
    default:
      text.resize(somewhere());
  }
  return text;
}

TEST(DamagedFiles, JournalSessionAndCalibrationAreReadOrRefused) {
  const TemporaryFolder folder;
  const fs::path session = folder / "session";
  fs::copy(recorded_session(), session, fs::copy_options::recursive);
  for (const char* name : {"journal.jsonl", "session.json", "calibration/calibration.json"}) {
    const std::string whole = text_of(session / name);
    constexpr unsigned kSeed = 20261121;
    std::mt19937 random(kSeed);
    int refused = 0, found = 0;
    constexpr int kTimes = 300;
    for (int time = 0; time < kTimes; ++time) {
      write_text(session / name, damaged(whole, random));
      found += message_of([&] { read_journal(session / "journal.jsonl"); }).empty() ? 0 : 1;
      const std::string message = message_of([&] {
        read_session_file(session);
        read_calibration(session / "calibration");
      });
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      refused += message.empty() ? 0 : 1;
    }
    std::cout << name << ": " << kTimes << " damaged (seed " << kSeed << "), " << refused << " refused, " << found
              << " found by the journal's checksums\n";
    write_text(session / name, whole);
  }
  EXPECT_TRUE(verify_session(session).sound());
}

TEST(DamagedFiles, RawHeadersAreReadOrRefused) {
  const std::string whole = text_of(recorded_session() / "raw/reflection-horizontal-1.arw");
  std::mt19937 random(7);
  int refused = 0;
  constexpr int kTimes = 500;
  for (int time = 0; time < kTimes; ++time) {
    // The header is the first of it; the rest is the mosaic.
    const std::string bytes = damaged(whole.substr(0, 2000), random) + whole.substr(2000);
    const std::string message =
        message_of([&] { calibration::read_sensor_bytes(std::as_bytes(std::span(bytes)), "damaged"); });
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    refused += message.empty() ? 0 : 1;
  }
  std::cout << kTimes << " damaged headers (seed 7), " << refused << " refused\n";
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace station
