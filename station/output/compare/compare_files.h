// The compare command: a photograph in a file against a rendering in another.
#pragma once

#include <filesystem>

#include "station/output/compare/compare_pictures.h"

namespace station {

struct CompareRequest {
  std::filesystem::path photograph, rendering;  // linear EXR of one size
  std::filesystem::path mask{};                 // PNG, white where they are compared; empty: everywhere
  std::filesystem::path calibration{};          // whose colours the pictures are in; empty: linear sRGB
  std::filesystem::path picture{};              // written: both beside their difference (PNG); empty: none
  CompareOptions options;
};

// Errors: std::runtime_error of a file that cannot be read, and those of compare_pictures.
Comparison compare_files(const CompareRequest& request);

}  // namespace station
