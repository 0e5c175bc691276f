// How often a test repeats what it does, which the environment may ask to be more.
#pragma once

#include <cstdlib>

// The number in the environment variable `name`, or `otherwise` where it is not set.
inline int asked(const char* name, int otherwise) {
  const char* value = std::getenv(name);
  return value ? std::atoi(value) : otherwise;
}
