// The median of a list: its middle value, or the upper one of the middle two.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace calibration {

// The median of `values`, which must not be empty.
template <typename T>
T median(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace calibration
