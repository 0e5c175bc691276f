#include "inversion/fit/fit_doubts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace inversion {
namespace {

// Noise and highlights alone bring far fewer pixels than this share together at the top.
constexpr double kSaturated = 0.02, kTop = 0.995;
constexpr double kNearBlack = 5e-3;  // of a white diffuser
constexpr double kBadView = 0.25;    // weight
// The thread model itself is off by up to about 10 % from view to view on simulated bundles of fibers.
constexpr double kBrightness = 0.15, kColour = 0.1, kMisfit = 0.2;
constexpr double kBeyondNone = 3;      // standard deviations of an absorption below 0
constexpr double kUndetermined = 0.5;  // standard deviation along a direction; 1 is a change by the factor e

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, share < 0.0995 ? "%.1f %%" : "%.0f %%", 100 * share);
  return text;
}

void saturation(const std::vector<View>& views, std::vector<std::string>& doubts) {
  for (const View& view : views)
    if (const double share = saturated_share(view); share > kSaturated)
      doubts.push_back("view " + view.id + ": " + percent(share) +
                       " of the threads' pixels are as bright as the brightest, so they are saturated; "
                       "photograph it again with a shorter exposure or a bracket");
}

void darkness(const std::vector<ViewAgreement>& agreements, std::vector<std::string>& doubts) {
  double brightest = 0;
  for (const ViewAgreement& view : agreements) brightest = std::max(brightest, view.mean_reference);
  if (brightest < kNearBlack)
    doubts.push_back(
        "the threads return at most " + percent(brightest) +
        " of what a white diffuser would: they are nearly black, and their colour and inner scattering are "
        "hardly known; look at the bands of the energies");
}

void bad_views(const std::vector<View>& views, const ViewFit& fit, const std::vector<ViewAgreement>& agreements,
               std::vector<std::string>& doubts) {
  for (std::size_t i = 0; i < views.size(); ++i)
    if (fit.view_weights[i] < kBadView)
      doubts.push_back("view " + views[i].id + ": disagrees with the others (relative RMSE " +
                       percent(std::abs(agreements[i].relative_rmse())) +
                       ") and hardly counted; look at its picture and mask, and photograph it again");
}

void brightness(const std::vector<View>& views, const ViewFit& fit, const std::vector<ViewAgreement>& agreements,
                std::vector<std::string>& doubts) {
  double squares = 0, mean = 0, weights = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double off = agreements[i].relative_bias * agreements[i].mean_reference;
    squares += fit.view_weights[i] * off * off;
    mean += fit.view_weights[i] * agreements[i].mean_reference;
    weights += fit.view_weights[i];
  }
  const double spread = std::sqrt(squares / weights) / (mean / weights);
  if (spread > kBrightness)
    doubts.push_back("whole views are too bright or too dark by " + percent(spread) +
                     " (root mean square): the lamp, the views' angles or the masks may be off; check the calibration");
}

// Colours that only reflections have: absorption and energies can meet the colour of reflections or of transmissions,
// not both.
void highlights(const std::vector<View>& views, const std::vector<ViewAgreement>& agreements,
                std::vector<std::string>& doubts) {
  std::array<Eigen::Array3d, 2> sums{Eigen::Array3d::Zero(), Eigen::Array3d::Zero()};
  std::array<double, 2> counts{};
  for (std::size_t i = 0; i < views.size(); ++i) {
    sums[views[i].transmission] += agreements[i].colour_bias;
    ++counts[views[i].transmission];
  }
  if (counts[0] == 0) return;
  const Eigen::Array3d reflected = sums[0] / counts[0];
  const double range = reflected.maxCoeff() - reflected.minCoeff();
  if (range < 2 * kColour || reflected.minCoeff() > -kColour || reflected.maxCoeff() < kColour) return;
  doubts.push_back("reflections have another colour than the model can give them (red " + percent(reflected[0]) +
                   ", green " + percent(reflected[1]) + ", blue " + percent(reflected[2]) +
                   " too bright): highlights of their own colour, as of metallic threads; fit them with --tint");
}

void misfit(const std::vector<ViewAgreement>& agreements, std::vector<std::string>& doubts) {
  const double rmse = overall_relative_rmse(agreements);
  if (rmse > kMisfit)
    doubts.push_back("the model explains the pictures badly (relative RMSE " + percent(rmse) +
                     "); look at the residual pictures, view by view");
}

// A thread that does not absorb returns all light. Views that are brighter than that need another lamp or diffuser.
void too_bright(const ViewFit& fit, std::vector<std::string>& doubts) {
  constexpr std::array kColours{"red", "green", "blue"};
  std::string colours;
  double most = 0;
  for (std::size_t c = 0; c < kColours.size(); ++c) {
    const auto found = std::ranges::find(fit.unknown_names, std::string("sigma_a_") + kColours.at(c)[0]);
    if (found == fit.unknown_names.end() || fit.certainty.beyond_bound.size() == 0) continue;
    const double beyond = fit.certainty.beyond_bound[found - fit.unknown_names.begin()];
    if (beyond <= kBeyondNone) continue;
    colours += (colours.empty() ? "" : ", ") + std::string(kColours.at(c));
    most = std::max(most, beyond);
  }
  if (colours.empty()) return;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.0f", most);
  doubts.push_back(
      "the views are brighter in " + colours + " than a thread without any absorption would be, by " + text.data() +
      " standard deviations: the lamp's place or brightness or the diffuser's reflectance may be off, or the "
      "thread scatters otherwise than the model can; check the calibration, and where it is good fit with "
      "--model bundle");
}

void undetermined(const ViewFit& fit, std::vector<std::string>& doubts) {
  std::string names;
  int directions = 0;
  for (const Certainty::Direction& axis : fit.certainty.weakest) {
    if (axis.sigma < kUndetermined) break;
    ++directions;
    Eigen::Index most = 0;
    axis.direction.cwiseAbs().maxCoeff(&most);
    const std::string& name = fit.unknown_names[static_cast<std::size_t>(most)];
    if (names.find(name) == std::string::npos) names += (names.empty() ? "" : ", ") + name;
  }
  if (directions > 0)
    doubts.push_back("the views leave " + std::to_string(directions) +
                     (directions == 1 ? " direction" : " directions") + " of the unknowns open (mostly " + names +
                     "); values along them come from the prior");
}

}  // namespace

double saturated_share(const View& view) {
  cv::Vec3f brightest(0, 0, 0);
  for (int row = 0; row < view.mask.rows; ++row)
    for (int column = 0; column < view.mask.cols; ++column)
      if (view.mask(row, column))
        for (int c = 0; c < 3; ++c) brightest[c] = std::max(brightest[c], view.image(row, column)[c]);
  std::array<int, 3> top{};
  for (int row = 0; row < view.mask.rows; ++row)
    for (int column = 0; column < view.mask.cols; ++column)
      if (view.mask(row, column))
        for (int c = 0; c < 3; ++c)
          if (brightest[c] > 0 &&
              static_cast<double>(view.image(row, column)[c]) >= kTop * static_cast<double>(brightest[c]))
            ++top[static_cast<std::size_t>(c)];
  const int most = *std::max_element(top.begin(), top.end());
  return static_cast<double>(most) / std::max(1, cv::countNonZero(view.mask));
}

std::vector<std::string> fit_doubts(const std::vector<View>& views, const ViewFit& fit,
                                    const std::vector<ViewAgreement>& agreements) {
  std::vector<std::string> doubts;
  saturation(views, doubts);
  darkness(agreements, doubts);
  bad_views(views, fit, agreements, doubts);
  brightness(views, fit, agreements, doubts);
  highlights(views, agreements, doubts);
  misfit(agreements, doubts);
  too_bright(fit, doubts);
  undetermined(fit, doubts);
  return doubts;
}

}  // namespace inversion
