// How far the yarns of a photographed cloth stand out, by the width of its highlight round the black cylinder: flatter
// yarns have a narrower one.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "renderer/weave/draft.h"
#include "station/cloth/fabric_measures.h"
#include "station/cloth/photographed_fabric.h"
#include "station/output/progress.h"

namespace station {

// Sums of light by azimuth round the cylinder in each of several bands along it, each band by R, G and B.
class HighlightProfiles {
 public:
  static constexpr int kBands = 8;

  // `pictures` are alike in masks and cameras to all that they are compared with. `step_mm`: of the azimuth, round the
  // crowns.
  HighlightProfiles(const std::vector<PhotographedCloth>& pictures, double crown_radius_mm, double step_mm);

  // How far `other` is from this in shape, each colour of each picture scaled for itself: the mean over pictures and
  // colours of the squared distance over the squared light, without the band `left_out` (-1: with all).
  double misfit(const HighlightProfiles& other, int left_out) const;

 private:
  std::vector<std::array<std::vector<cv::Vec3d>, kBands>> profiles_;  // of each picture
};

// The lowest place of a line through (x, misfit), by the parabola through the least of them and its neighbours;
// nothing where the least is the first or the last. x rises.
std::optional<double> lowest_place(const std::vector<std::pair<double, double>>& misfits);

struct MeasuredHeight {
  // Nothing where no height scale that was tried has less misfit than its neighbours. The error is that of the noise of
  // photographs and predictions (a band at a time left out), not of wrong threads or a lamp elsewhere.
  std::optional<MeasuredValue> height_scale;
  double said = 1;
  std::vector<std::pair<double, double>> misfits;  // by height scale
  renderer::Draft draft;                           // of the weave, with the measured scale where there is one
};

struct HeightRequest {
  SaidFabric cloth;
  int samples_per_pixel = 16;
  std::uint64_t seed = 1;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Predicts the cloth with heights from a half to one and a half times those of the weave. Errors: those of
// woven_models; std::runtime_error when stopped by an interrupt.
MeasuredHeight measure_height(const HeightRequest& request);
std::string describe(const MeasuredHeight& height);
nlohmann::json to_json(const MeasuredHeight& height);

}  // namespace station
