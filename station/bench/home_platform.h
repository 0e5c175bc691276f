// Turns the platform to its angle 0.
#pragma once

#include <filesystem>

#include "rig/people/asked_person.h"

namespace station {

struct HomeRequest {
  std::filesystem::path rig;
  bool stands_at_mark = false;  // somebody has turned the platform to its mark: what was remembered of it is forgotten
  rig::AskedPerson* asked = nullptr;
};

// Homes the turntable and returns the angle that it reads then, in radians. Errors: those of the rig file and of the
// turntable; std::runtime_error for `stands_at_mark` of a turntable that finds its home by itself.
double home_platform(const HomeRequest& request);

}  // namespace station
