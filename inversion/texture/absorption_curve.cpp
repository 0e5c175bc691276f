#include "inversion/texture/absorption_curve.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace inversion {
namespace {

// The nearest falling sequence in the sense of least squares.
std::vector<double> made_to_fall(const std::vector<double>& values) {
  struct Pool {
    double sum;
    std::size_t count;
    double mean() const { return sum / static_cast<double>(count); }
  };
  std::vector<Pool> pools;
  for (const double value : values) {
    pools.push_back({value, 1});
    while (pools.size() >= 2 && pools.back().mean() > pools[pools.size() - 2].mean()) {
      const Pool last = pools.back();
      pools.pop_back();
      pools.back().sum += last.sum, pools.back().count += last.count;
    }
  }
  std::vector<double> falling;
  for (const Pool& pool : pools) falling.insert(falling.end(), pool.count, pool.mean());
  return falling;
}

// A scale for absorptions, which differ by factors but begin at 0.
double scaled(double sigma_a) {
  return std::log1p(20 * sigma_a);
}

double scaled_slope(double sigma_a) {
  return 20 / (1 + 20 * sigma_a);
}

double unscaled(double value) {
  return std::expm1(value) / 20;
}

}  // namespace

AbsorptionCurve::AbsorptionCurve(std::vector<double> sigma_a, std::vector<double> reflectance)
    : sigma_a_(std::move(sigma_a)) {
  if (sigma_a_.size() != reflectance.size() || sigma_a_.size() < 2)
    throw std::invalid_argument("AbsorptionCurve: needs two or more pairs");
  if (sigma_a_.front() != 0 || std::ranges::adjacent_find(sigma_a_, std::greater_equal<>()) != sigma_a_.end())
    throw std::invalid_argument("AbsorptionCurve: absorptions must rise from 0");
  reflectance_ = made_to_fall(reflectance);
}

std::size_t AbsorptionCurve::end_of_step(double sigma_a) const {
  const auto above = std::upper_bound(sigma_a_.begin() + 1, sigma_a_.end() - 1, sigma_a);
  return static_cast<std::size_t>(above - sigma_a_.begin());
}

double AbsorptionCurve::reflectance(double sigma_a) const {
  const double within = std::clamp(sigma_a, 0.0, sigma_a_.back());
  const std::size_t i = end_of_step(within);
  const double share = (scaled(within) - scaled(sigma_a_[i - 1])) / (scaled(sigma_a_[i]) - scaled(sigma_a_[i - 1]));
  return reflectance_[i - 1] + share * (reflectance_[i] - reflectance_[i - 1]);
}

double AbsorptionCurve::slope(double sigma_a) const {
  const double within = std::clamp(sigma_a, 0.0, sigma_a_.back());
  const std::size_t i = end_of_step(within);
  return (reflectance_[i] - reflectance_[i - 1]) / (scaled(sigma_a_[i]) - scaled(sigma_a_[i - 1])) *
         scaled_slope(within);
}

double AbsorptionCurve::sigma_a(double reflectance) const {
  if (reflectance >= reflectance_.front()) return 0;
  if (reflectance <= reflectance_.back()) return sigma_a_.back();
  const auto below = std::ranges::find_if(reflectance_, [&](double value) { return value < reflectance; });
  const auto i = static_cast<std::size_t>(below - reflectance_.begin());
  const double share = (reflectance_[i - 1] - reflectance) / (reflectance_[i - 1] - reflectance_[i]);
  return unscaled(scaled(sigma_a_[i - 1]) + share * (scaled(sigma_a_[i]) - scaled(sigma_a_[i - 1])));
}

bool AbsorptionCurve::in_gamut(double reflectance) const {
  return reflectance >= darkest() && reflectance <= brightest();
}

std::vector<double> absorption_steps(int count, double most) {
  std::vector<double> steps{0};
  for (int i = 1; i < count; ++i) steps.push_back(unscaled(scaled(most) * i / (count - 1)));
  return steps;
}

std::array<AbsorptionCurve, 3> measure_absorption_curves(const std::function<Eigen::Array3d(double)>& reflectance_of,
                                                         int count, double most) {
  const std::vector<double> sigma_a = absorption_steps(count, most);
  std::array<std::vector<double>, 3> reflectances;
  for (const double step : sigma_a) {
    const Eigen::Array3d found = reflectance_of(step);
    for (std::size_t c = 0; c < 3; ++c) reflectances[c].push_back(found[static_cast<int>(c)]);
  }
  return {AbsorptionCurve(sigma_a, reflectances[0]), AbsorptionCurve(sigma_a, reflectances[1]),
          AbsorptionCurve(sigma_a, reflectances[2])};
}

}  // namespace inversion
