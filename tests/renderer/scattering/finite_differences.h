// Derivatives by finite differences, to judge those of dual numbers and closed forms.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace renderer {

// The derivative d f / d values[k] of any function f that returns an Eigen array. It is of fourth order in a step of
// 1e-4 of the value: the error is below 1e-8 for functions whose logarithm changes by less than 100 when a value
// doubles.
template <class Function, std::size_t count>
auto finite_difference(const Function& f, std::array<double, count> values, std::size_t k) {
  const double at = values[k], step = 1e-4 * std::max(std::abs(at), 0.02);
  const auto moved = [&](double steps) {
    values[k] = at + steps * step;
    return f(values).eval();
  };
  return ((8.0 * (moved(1) - moved(-1)) - (moved(2) - moved(-2))) / (12 * step)).eval();
}

}  // namespace renderer
