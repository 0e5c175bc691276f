#include "inversion/texture/texture_fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "inversion/texture/texture_shading.h"
#include "renderer/scattering/random_stream.h"

namespace inversion {
namespace {

constexpr double kMostAbsorption = 12;  // per thread radius
constexpr int kCurveSteps = 40;
constexpr double kLeastShare = 1e-3;  // of a curve's mean slope: flatter places of it are not used as a scale
constexpr double kShownPaths = 6e7;   // for what a texture shows: of all texels together, within the two below
constexpr int kLeastShown = 64, kMostShown = 1024;
constexpr int kLeastPaths = 2048;  // of a crossing

// The unknowns of a fit and what they are to show.
class Fit {
 public:
  Fit(const TexturedCloth& cloth, const std::vector<CrossingPaths>& paths, const cv::Mat3f& reflectance,
      bool within_gamut)
      : crossing_mm_(cloth.crossing_mm()),
        curves_(crossing_curves(paths)),
        shading_(mixing(paths), cloth.crossings, reflectance.size()),
        asked_(reflectance.size()),
        target_(reflectance.size()),
        in_gamut_(reflectance.size(), uchar{255}),
        states_(reflectance.total()),
        weights_(reflectance.total(), Channels::Zero()) {
    for_channels([&](int row, int column, int c) {
      const AbsorptionCurve& curve = curve_at(row, column, c);
      const float as_it_is = reflectance(row, column)[c];
      if (!curve.in_gamut(static_cast<double>(as_it_is))) in_gamut_(row, column) = 0;
      const float asked = within_gamut ? brought_within(as_it_is, c) : as_it_is;
      asked_(row, column)[c] = asked;
      // A reflectance out of reach is not aimed at, because neighbours would have to make up for it.
      const auto aim = static_cast<float>(std::clamp(static_cast<double>(asked), curve.darkest(), curve.brightest()));
      target_(row, column)[c] = aim;
      weights_[number(row, column)][c] = std::pow(aim + 0.02F, -4.0F / 3);  // lightness: its cube root
      set(row, column, c, aim);
    });
  }

  const cv::Mat3f& asked() const { return asked_; }
  const cv::Mat1b& in_gamut() const { return in_gamut_; }
  const std::vector<TexelState>& states() const { return states_; }
  cv::Mat3f shown(std::uint64_t draw) const {
    const double affordable = kShownPaths / static_cast<double>(states_.size());
    return shading_.reflectance(states_, static_cast<int>(std::clamp(affordable, 1.0 * kLeastShown, 1.0 * kMostShown)),
                                draw);
  }

  renderer::AbsorptionTexture texture() const {
    renderer::AbsorptionTexture texture{.sigma_a = cv::Mat3f(target_.size()), .texel_mm = crossing_mm_};
    for_channels(
        [&](int row, int column, int c) { texture.sigma_a(row, column)[c] = states_[number(row, column)].sigma_a[c]; });
    return texture;
  }

  void step(int paths, std::uint64_t draw) {
    const TextureShading::Descent found = shading_.descent(states_, target_, weights_, paths, draw);
    for_channels([&](int row, int column, int c) {
      const std::size_t i = number(row, column);
      set(row, column, c, states_[i].curve_reflectance[c] - found.gradient[i][c] / found.steepness[i][c]);
    });
  }

  void set_all(const std::vector<Channels>& curve_reflectance) {
    for_channels([&](int row, int column, int c) { set(row, column, c, curve_reflectance[number(row, column)][c]); });
  }

 private:
  static std::vector<CrossingPaths> mixing(const std::vector<CrossingPaths>& paths) {
    std::vector<CrossingPaths> mixing;
    for (const CrossingPaths& of : paths) mixing.push_back(those_that_mix(of));
    return mixing;
  }

  float brought_within(float reflectance, int c) const {
    double darkest = 0, brightest = 1;
    for (const std::array<AbsorptionCurve, 3>& of : curves_) {
      darkest = std::max(darkest, of[static_cast<std::size_t>(c)].darkest());
      brightest = std::min(brightest, of[static_cast<std::size_t>(c)].brightest());
    }
    const double share = std::clamp(static_cast<double>(reflectance), 0.0, 1.0);
    return static_cast<float>(darkest + share * (brightest - darkest));
  }

  template <class Work>
  void for_channels(const Work& work) const {
    tbb::parallel_for(0, target_.rows, [&](int row) {
      for (int column = 0; column < target_.cols; ++column)
        for (int c = 0; c < 3; ++c) work(row, column, c);
    });
  }
  std::size_t number(int row, int column) const { return static_cast<std::size_t>(row * target_.cols + column); }
  const AbsorptionCurve& curve_at(int row, int column, int c) const {
    return curves_[shading_.crossing(row, column)][static_cast<std::size_t>(c)];
  }

  void set(int row, int column, int c, float reflectance) {
    const AbsorptionCurve& curve = curve_at(row, column, c);
    TexelState& state = states_[number(row, column)];
    const double sigma_a = curve.sigma_a(static_cast<double>(reflectance));
    const double flattest = kLeastShare * (curve.brightest() - curve.darkest()) / kMostAbsorption;
    state.sigma_a[c] = static_cast<float>(sigma_a);
    state.curve_reflectance[c] = static_cast<float>(curve.reflectance(sigma_a));
    state.curve_slope[c] = static_cast<float>(std::min(curve.slope(sigma_a), -flattest));
  }

  Eigen::Vector2d crossing_mm_;
  std::vector<std::array<AbsorptionCurve, 3>> curves_;
  TextureShading shading_;
  cv::Mat3f asked_, target_;
  cv::Mat1b in_gamut_;
  std::vector<TexelState> states_;
  std::vector<Channels> weights_;
};

}  // namespace

std::vector<std::array<AbsorptionCurve, 3>> crossing_curves(const std::vector<CrossingPaths>& paths) {
  const std::vector<double> steps = absorption_steps(kCurveSteps, kMostAbsorption);
  std::vector<std::vector<Channels>> values(paths.size());
  tbb::parallel_for(std::size_t{0}, paths.size(), [&](std::size_t i) {
    for (const double sigma_a : steps) values[i].push_back(uniform_value(paths[i], static_cast<float>(sigma_a)));
  });
  std::vector<std::array<AbsorptionCurve, 3>> curves;
  for (const std::vector<Channels>& of : values) {
    const auto curve = [&](int c) {
      std::vector<double> reflectance;
      for (const Channels& value : of) reflectance.push_back(static_cast<double>(value[c]));
      return AbsorptionCurve(steps, reflectance);
    };
    curves.push_back({curve(0), curve(1), curve(2)});
  }
  return curves;
}

TextureFit fit_texture(const TexturedCloth& cloth, const cv::Mat3f& reflectance, const TextureFitOptions& options) {
  constexpr double kPathsDone = 0.05, kStepsDone = 0.8;  // of the work
  const auto show = [&](double share) {
    if (options.progress && !options.progress(share))
      throw std::runtime_error("the inversion was stopped on request; start it again");
  };
  const int per_crossing = std::max(kLeastPaths, options.curve_paths / cloth.crossings.prod());
  Fit fit(cloth, trace_crossing_paths(cloth, per_crossing, options.seed), reflectance, options.within_gamut);
  show(kPathsDone);
  const auto draw = [&](int step) { return renderer::mixed_bits(options.seed) + static_cast<std::uint64_t>(step); };
  TextureFit result{.curve = fit.texture(),
                    .curve_reflectance = fit.shown(draw(-1)),
                    .asked = fit.asked(),
                    .in_gamut = fit.in_gamut()};
  std::vector<Channels> mean(reflectance.total(), Channels::Zero());
  const int averaged = (options.steps + 1) / 2;
  for (int i = 0; i < options.steps; ++i) {
    fit.step(options.paths_per_texel, draw(i));
    if (i >= options.steps - averaged)
      for (std::size_t t = 0; t < mean.size(); ++t)
        mean[t] += fit.states()[t].curve_reflectance / static_cast<float>(averaged);
    show(kPathsDone + (kStepsDone - kPathsDone) * (i + 1) / options.steps);
  }
  if (averaged > 0) fit.set_all(mean);
  result.refined = fit.texture();
  result.refined_reflectance = fit.shown(draw(-1));
  show(1);
  return result;
}

}  // namespace inversion
