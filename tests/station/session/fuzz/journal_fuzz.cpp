// Any bytes as a journal: its records are read up to a torn tail, or it is refused with a message.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "station/session/record/picture_record.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                            ("journal-fuzz-" + std::to_string(reinterpret_cast<std::uintptr_t>(&file)));
  std::ofstream(file, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    station::taken_pictures(station::read_journal(file).records);
  } catch (const std::runtime_error&) {
  }
  return 0;
}
