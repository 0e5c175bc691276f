// What a lab knows of a spool beside its geometry, as people wrote it; any of the texts may be empty.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "station/documents/reader.h"

namespace station {

struct Sample {
  std::string barcode, name, lot, material, colour, note;

  bool operator==(const Sample&) const = default;
};

nlohmann::json to_json(const Sample& sample);
Sample read_sample(ObjectReader& reader);  // also calls reader.finish()

// Read and write a sample as a document of its own (kind "sample", version 1). Errors: those of reader.h.
Sample read_sample_file(const std::filesystem::path& file);
void write_sample_file(const std::filesystem::path& file, const Sample& sample);

}  // namespace station
