#include "inversion/solve/robust_weights.h"

#include <algorithm>
#include <cmath>

namespace inversion {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The weight of a misfit: 1 up to kTolerated times the usual one. Where all others fit perfectly, the usual one is 0.
double weight_of(double misfit, double usual) {
  if (!(misfit > kTolerated * usual)) return 1;
  const double ratio = kTolerated * usual / misfit;
  return ratio * ratio;
}

double root_mean_square(const std::vector<double>& misfits) {
  double squares = 0;
  for (double misfit : misfits) squares += misfit * misfit;
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, misfits.size())));
}

// The relative misfit of each view; that of dim views is relative to the usual brightness, because eq. 6 leaves them
// their absolute error.
std::vector<double> relative_misfits(const std::vector<WeighedView>& views) {
  std::vector<double> means, misfits;
  for (const WeighedView& view : views) means.push_back(view.mean_reference);
  const double usual = median(means);
  for (const WeighedView& view : views)
    misfits.push_back(root_mean_square(view.misfits) / std::max({view.mean_reference, usual, 1e-300}));
  return misfits;
}

}  // namespace

RobustWeights robust_weights(const std::vector<WeighedView>& views) {
  RobustWeights weights;
  const std::vector<double> misfits = relative_misfits(views);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const WeighedView& view = views[i];
    std::vector<double> alike;
    for (std::size_t j = 0; j < views.size(); ++j)
      if (views[j].transmission == view.transmission) alike.push_back(misfits[j]);
    const double of_view = weight_of(misfits[i], median(alike));
    weights.views.push_back(of_view * of_view);
    const double usual = median(view.misfits);
    std::vector<double>& blocks = weights.blocks.emplace_back();
    for (std::size_t b = 0; b < view.misfits.size(); ++b) {
      const double noise = view.noise_variances.empty() ? 0 : view.noise_variances[b];
      const double left = usual * usual;
      blocks.push_back(weights.views.back() * weight_of(view.misfits[b], usual) *
                       (noise > 0 ? left / (left + noise) : 1));
    }
  }
  return weights;
}

}  // namespace inversion
