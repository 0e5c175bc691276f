// The single fiber that stands for a thread in renderers of hair, and how well it does; the exports to those programs
// share it.
//
// Colours are linear sRGB, as those programs have them; srgb_scattering_from_camera turns a thread's camera RGB into
// it.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "inversion/fit/nearest_fiber.h"
#include "station/documents/thread_file.h"

namespace station {

struct FiberExport {
  std::string thread;  // the thread's name, for people
  double diameter_mm = 0;
  inversion::NearestFiber nearest;
  bool wanders = false;  // light leaves the thread elsewhere than it came in, which no fiber does
};

// The matrix from a thread's camera RGB to linear sRGB of the light that it scatters when light that is white in sRGB
// falls on it: M diag(M^-1 (1, 1, 1)), M being the file's linear_srgb_from_camera. Errors: std::runtime_error, one
// line, for an M that has no inverse.
Eigen::Matrix3d srgb_scattering_from_camera(const ThreadFile& thread);

// Finds the nearest fiber, in some seconds. Errors: those of srgb_scattering_from_camera and inversion::nearest_fiber.
FiberExport fiber_export(const ThreadFile& thread);

// The lines for headers of files and for people: which thread the fiber stands for, its errors in numbers, what it
// cannot do.
std::vector<std::string> approximation(const FiberExport& fiber);
nlohmann::json to_json(const inversion::FiberAgreement& agreement);

}  // namespace station
