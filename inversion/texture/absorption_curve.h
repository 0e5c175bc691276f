// The curve from which follows what absorption gives a cloth or an embroidery a wanted colour, when all else of its
// threads is kept [Xia 2025, section 6].
//
// Under light that is the same from all sides, a cloth's reflectance in a channel depends on that channel's absorption
// alone. It is measured once, at a few absorptions, and inverted.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

namespace inversion {

class AbsorptionCurve {
 public:
  // The curve through reflectances (0 ... 1) at rising absorptions sigma_a, two or more, the first 0. Where noise makes
  // reflectances rise, they are made to fall first (pool adjacent violators). Errors: std::invalid_argument when the
  // sizes differ or absorptions do not rise.
  AbsorptionCurve(std::vector<double> sigma_a, std::vector<double> reflectance);

  double reflectance(double sigma_a) const;
  double slope(double sigma_a) const;  // of the reflectance; at 0 and at the end that of the side within
  // The absorption that has this reflectance; for a reflectance outside of the gamut, the absorption at the nearest
  // end.
  double sigma_a(double reflectance) const;
  bool in_gamut(double reflectance) const;
  double darkest() const { return reflectance_.back(); }
  double brightest() const { return reflectance_.front(); }

 private:
  std::size_t end_of_step(double sigma_a) const;

  std::vector<double> sigma_a_, reflectance_;
};

// `count` absorptions from 0 to `most`, evenly in log(1 + 20 sigma_a).
std::vector<double> absorption_steps(int count, double most);

// The curves of the three channels, measured at absorption_steps(). `reflectance_of` returns the channels' reflectances
// when all three have one absorption; the channels differ, because what lies below may be coloured.
std::array<AbsorptionCurve, 3> measure_absorption_curves(const std::function<Eigen::Array3d(double)>& reflectance_of,
                                                         int count = 14, double most = 12);

}  // namespace inversion
