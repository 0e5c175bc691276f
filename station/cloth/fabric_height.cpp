#include "station/cloth/fabric_height.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

#include "renderer/weave/patch_measures.h"
#include "station/bench/cloth_on_cylinder.h"
#include "station/documents/number_text.h"
#include "station/output/interrupt.h"
#include "station/output/watched_work.h"

namespace station {
namespace {

constexpr std::array<double, 6> kTimesSaid{0.5, 0.7, 0.9, 1.1, 1.3, 1.5};

PhotographedCloth of(const inversion::View& view, const cv::Mat3f& image) {
  return {.image = image, .mask = view.mask, .camera = view.camera};
}

// The lowest place with each band left out in turn, and from how they differ the error of the one with all (jackknife).
std::optional<MeasuredValue> lowest_of(const HighlightProfiles& photographs,
                                       const std::vector<std::pair<double, HighlightProfiles>>& predictions) {
  const auto lowest = [&](int left_out) {
    std::vector<std::pair<double, double>> misfits;
    for (const auto& [scale, prediction] : predictions)
      misfits.emplace_back(scale, photographs.misfit(prediction, left_out));
    return lowest_place(misfits);
  };
  const auto all = lowest(-1);
  if (!all) return std::nullopt;
  double squares = 0;
  int bands = 0;
  for (int band = 0; band < HighlightProfiles::kBands; ++band)
    if (const auto without = lowest(band)) squares += (*without - *all) * (*without - *all), ++bands;
  if (bands < HighlightProfiles::kBands) return std::nullopt;
  return MeasuredValue{.value = *all, .sigma = std::sqrt(squares * (bands - 1) / bands)};
}

}  // namespace

HighlightProfiles::HighlightProfiles(const std::vector<PhotographedCloth>& pictures, double crown_radius_mm,
                                     double step_mm) {
  for (const PhotographedCloth& picture : pictures) {
    struct Lit {
      double around_mm, along_mm;
      cv::Vec3f light;
    };
    std::vector<Lit> lit;
    const Eigen::Vector3d eye = picture.camera.world_from_camera.translation();
    const double towards_camera = std::atan2(eye.y(), eye.x());  // from there, so that no step of the angle is seen
    double low = std::numeric_limits<double>::max(), high = -low;
    for (int row = 0; row < picture.image.rows; ++row)
      for (int column = 0; column < picture.image.cols; ++column) {
        if (picture.mask(row, column) == 0) continue;
        const auto point = side_point(renderer::ray_through(picture.camera, column, row), crown_radius_mm);
        if (!point) continue;
        const double angle = std::remainder(std::atan2(point->y(), point->x()) - towards_camera, 2 * std::numbers::pi);
        lit.push_back({crown_radius_mm * angle, point->z(), picture.image(row, column)});
        low = std::min(low, point->z()), high = std::max(high, point->z());
      }
    std::array<std::vector<cv::Vec3d>, kBands> profiles;
    const int bins = 2 * static_cast<int>(std::ceil(std::numbers::pi * crown_radius_mm / step_mm)) + 1;
    for (std::vector<cv::Vec3d>& profile : profiles) profile.assign(static_cast<std::size_t>(bins), {0, 0, 0});
    for (const Lit& one : lit) {
      const int band = std::min(kBands - 1, static_cast<int>(kBands * (one.along_mm - low) / (high - low + 1e-9)));
      const auto bin = static_cast<std::size_t>(std::lround(one.around_mm / step_mm) + bins / 2);
      profiles[static_cast<std::size_t>(band)][bin] += cv::Vec3d(one.light);
    }
    profiles_.push_back(std::move(profiles));
  }
}

double HighlightProfiles::misfit(const HighlightProfiles& other, int left_out) const {
  double sum = 0;
  for (std::size_t picture = 0; picture < profiles_.size(); ++picture)
    for (int colour = 0; colour < 3; ++colour) {
      double own2 = 0, both = 0, others2 = 0;
      for (std::size_t bin = 0; bin < profiles_[picture][0].size(); ++bin) {
        double own = 0, others = 0;
        for (int band = 0; band < kBands; ++band) {
          if (band == left_out) continue;
          own += profiles_[picture][static_cast<std::size_t>(band)][bin][colour];
          others += other.profiles_.at(picture)[static_cast<std::size_t>(band)].at(bin)[colour];
        }
        own2 += own * own, both += own * others, others2 += others * others;
      }
      if (own2 > 0 && others2 > 0) sum += 1 - both * both / (own2 * others2);
    }
  return sum / (3 * static_cast<double>(profiles_.size()));
}

std::optional<double> lowest_place(const std::vector<std::pair<double, double>>& misfits) {
  const auto least = std::ranges::min_element(misfits, {}, &std::pair<double, double>::second);
  if (least == misfits.begin() || least + 1 >= misfits.end()) return std::nullopt;
  const auto [x0, y0] = *(least - 1);
  const auto [x1, y1] = *least;
  const auto [x2, y2] = *(least + 1);
  const double before = (y1 - y0) / (x1 - x0), after = (y2 - y1) / (x2 - x1), bend = (after - before) / (x2 - x0);
  if (!(bend > 0)) return x1;
  return (x0 + x1) / 2 - before / (2 * bend);
}

MeasuredHeight measure_height(const HeightRequest& request) {
  watch_interrupts();
  const SessionFile asked = read_session_file(request.cloth.session);
  const WovenModels weave = woven_models(request.cloth, asked.spool);
  const DevelopedViews developed = pictures_of_fabric(request.cloth.session);
  ProgressDisplay progress("predict", request.progress_style);
  MeasuredHeight measured{.said = weave.draft.height_scale, .draft = weave.draft};
  std::optional<HighlightProfiles> photographs;
  std::vector<std::pair<double, HighlightProfiles>> predictions;
  const int renderings = static_cast<int>(kTimesSaid.size() * developed.views.size());
  int done = 0;
  double crown_mm = 0, step_mm = 0;
  for (const double times : kTimesSaid) {
    renderer::Draft draft = weave.draft;
    draft.height_scale = times * measured.said;
    const renderer::YarnPatch patch = weave_watched(draft, progress).patch;
    if (predictions.empty()) {
      // All pictures are taken apart alike.
      const renderer::SurfaceRange range = renderer::surface_range(patch);
      crown_mm = asked.spool.fabric->cylinder.radius_mm - range.low_mm + range.high_mm;
      step_mm = patch.period_x_mm;
      std::vector<PhotographedCloth> pictures;
      for (const DevelopedView& one : developed.views) pictures.push_back(of(one.view, one.view.image));
      photographs.emplace(pictures, crown_mm, step_mm);
    }
    std::vector<PhotographedCloth> pictures;
    for (const DevelopedView& one : developed.views) {
      progress.show(done, renderings, one.view.id + " with heights times " + number_text(draft.height_scale, 2));
      pictures.push_back(
          of(one.view, predicted_picture(*asked.spool.fabric, patch, weave.threads, one.view, request.samples_per_pixel,
                                         request.seed + static_cast<std::uint64_t>(done++))));
      if (interrupted()) throw std::runtime_error("stopped on request; start it again");
    }
    predictions.emplace_back(draft.height_scale, HighlightProfiles(pictures, crown_mm, step_mm));
    measured.misfits.emplace_back(draft.height_scale, photographs->misfit(predictions.back().second, -1));
  }
  measured.height_scale = lowest_of(*photographs, predictions);
  if (measured.height_scale) measured.draft.height_scale = measured.height_scale->value;
  progress.finish(std::to_string(renderings) + " renderings");
  return measured;
}

std::string describe(const MeasuredHeight& height) {
  std::string text = "height scale: ";
  if (height.height_scale)
    text += number_text(height.height_scale->value, 2) + " +- " + number_text(height.height_scale->sigma, 2);
  else
    text += "cannot be told between " + number_text(height.misfits.front().first, 2) + " and " +
            number_text(height.misfits.back().first, 2);
  return text + " (the fabric says " + number_text(height.said, 2) + ")\n";
}

nlohmann::json to_json(const MeasuredHeight& height) {
  nlohmann::json document{{"said_height_scale", height.said}, {"height_scale", nullptr}};
  if (height.height_scale) {
    document["height_scale"] = height.height_scale->value;
    document["height_scale_sigma"] = height.height_scale->sigma;
  }
  for (const auto& [scale, misfit] : height.misfits)
    document["misfits"].push_back({{"height_scale", scale}, {"misfit", misfit}});
  return document;
}

}  // namespace station
