// The single fiber that stands for a thread in renderers of hair, and how well: what the scene fragments of other
// programs share.
//
// Colours are linear sRGB, as those programs have them: a thread in camera RGB is turned into it as light that is white
// in sRGB shows it.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "inversion/nearest_fiber.h"
#include "station/documents/thread_file.h"

namespace station {

struct FiberExport {
  std::string thread;  // name, for people
  double diameter_mm = 0;
  inversion::NearestFiber nearest;
  bool far_side = false;  // the thread sends light on from its far side, which no fiber does
};

// What a thread scatters of white light, linear sRGB from camera RGB: M diag(M^-1 (1, 1, 1)), M being the file's
// linear_srgb_from_camera. Errors: std::runtime_error, one line, for an M that has no inverse.
Eigen::Matrix3d srgb_scattering_from_camera(const ThreadFile& thread);

// Takes seconds. Errors: those of srgb_scattering_from_camera and inversion::nearest_fiber.
FiberExport fiber_export(const ThreadFile& thread);

// For headers of files and for people: whose equivalent it is, its errors in numbers, what it cannot do; a line each.
std::vector<std::string> approximation(const FiberExport& fiber);
nlohmann::json to_json(const inversion::FiberAgreement& agreement);

}  // namespace station
