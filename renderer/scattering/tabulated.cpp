#include "renderer/scattering/tabulated.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "renderer/scattering/degree.h"

namespace renderer {
namespace {

using Eigen::ArrayXd;

constexpr int kInclinations = 16, kAbsorptions = 16;
constexpr double kSteepest = 85 * kDegree, kLeastAbsorption = 0.003, kMostAbsorption = 3;

// The node below `x` and how far x is on the way to the next one; beyond the ends it is the end node.
struct Between {
  std::size_t below;
  double share;
};
Between between(const std::vector<double>& nodes, double x) {
  const auto above = std::upper_bound(nodes.begin(), nodes.end(), x);
  if (above == nodes.begin()) return {0, 0};
  if (above == nodes.end()) return {nodes.size() - 1, 0};
  const auto i = static_cast<std::size_t>(above - nodes.begin()) - 1;
  return {i, (x - nodes[i]) / (nodes[i + 1] - nodes[i])};
}

void check(const AzimuthalTable& table) {
  const auto rising_from_0 = [](const std::vector<double>& nodes) {
    return !nodes.empty() && nodes.front() == 0 &&
           std::adjacent_find(nodes.begin(), nodes.end(), std::greater_equal<>()) == nodes.end();
  };
  bool fine = rising_from_0(table.thetas_rad) && rising_from_0(table.absorptions) &&
              table.densities.size() == table.thetas_rad.size();
  for (const auto& row : table.densities) {
    fine = fine && row.size() == table.absorptions.size();
    for (const ArrayXd& density : row)
      fine = fine && density.size() == table.densities.front().front().size() && density.size() > 0 &&
             density.minCoeff() >= 0;
  }
  if (!fine) throw std::invalid_argument("a table of distributions has nodes or sizes that do not fit together");
}

}  // namespace

AzimuthalTable simulate_table(MultiFiberOptions options, const std::function<bool(double)>& progress) {
  AzimuthalTable table;
  for (int i = 0; i < kInclinations; ++i) table.thetas_rad.push_back(kSteepest * i / (kInclinations - 1));
  table.absorptions.push_back(0);
  for (int i = 0; i < kAbsorptions - 1; ++i)
    table.absorptions.push_back(kLeastAbsorption *
                                std::pow(kMostAbsorption / kLeastAbsorption, i / (kAbsorptions - 2.0)));
  double done = 0;
  for (double theta : table.thetas_rad) {
    std::vector<ArrayXd>& row = table.densities.emplace_back();
    for (double absorption : table.absorptions) {
      options.theta_rad = theta;
      options.sigma_a = absorption;
      options.progress = [&](double fraction) {
        return !progress || progress((done + fraction) / (kInclinations * kAbsorptions));
      };
      const std::vector<double> density = simulate_multi_fiber(options).density;
      row.emplace_back(Eigen::Map<const ArrayXd>(density.data(), std::ssize(density)));
      ++done;
    }
  }
  return table;
}

TabulatedModel::TabulatedModel(const AzimuthalTable& table, const TabulatedParameters& parameters)
    : thetas_(table.thetas_rad) {
  check(table);
  bins_ = static_cast<int>(table.densities.front().front().size());
  for (const auto& by_absorption : table.densities) {
    Row& row = rows_.emplace_back();
    row.density.resize(bins_, 3);
    for (int c = 0; c < 3; ++c) {
      const Between at = between(table.absorptions, parameters.sigma_a[c]);
      const ArrayXd& next = by_absorption[std::min(at.below + 1, by_absorption.size() - 1)];
      row.density.col(c) = (1 - at.share) * by_absorption[at.below] + at.share * next;
    }
    // Every bin gets a small chance, so that no bin that has light is never sampled.
    ArrayXd chance = row.density.rowwise().mean();
    chance += 1e-3 * chance.mean() + 1e-12;
    row.cumulative = chance / chance.sum();
    for (int i = 1; i < bins_; ++i) row.cumulative[i] += row.cumulative[i - 1];
  }
  widths_.set(0, longitudinal_variance(parameters.alpha), 1);
  for (int p = 1; p < 4; ++p) widths_.set(p, 1, 1);
}

TabulatedLobes TabulatedModel::lobes_at(double /*h*/, const Vec3<double>& wo) const {
  TabulatedLobes lobes;
  lobes.model_ = this;
  lobes.sin_theta_o_ = wo.x();
  lobes.cos_theta_o_ = std::hypot(wo.y(), wo.z());
  lobes.azimuth_o_ =
      lobes.cos_theta_o_ > 0 ? Eigen::Vector2d(wo.y(), wo.z()) / lobes.cos_theta_o_ : Eigen::Vector2d(1, 0);
  const Between at = between(thetas_, std::abs(std::atan2(lobes.sin_theta_o_, lobes.cos_theta_o_)));
  lobes.below_ = at.below;
  lobes.share_ = at.share;
  return lobes;
}

ScatteringValue<double> TabulatedLobes::evaluate(const Vec3<double>& wi) const {
  const double cos_i = std::hypot(wi.y(), wi.z());
  const double along = azimuth_o_.x() * wi.y() + azimuth_o_.y() * wi.z();
  const double across = azimuth_o_.x() * wi.z() - azimuth_o_.y() * wi.y();
  const double phi = std::atan2(across, along);
  const int bin =
      std::min(static_cast<int>((phi + std::numbers::pi) / (2 * std::numbers::pi) * model_->bins_), model_->bins_ - 1);
  LobeAngles<double> at;
  at.distance2.setConstant((cos_theta_o_ - cos_i) * (cos_theta_o_ - cos_i) +
                           (sin_theta_o_ + wi.x()) * (sin_theta_o_ + wi.x()));
  at.cos_cos.setConstant(cos_theta_o_ * cos_i);
  const double m = longitudinal_density(model_->widths_, at)[0];
  const auto& low = model_->rows_[below_];
  const auto& high = model_->rows_[std::min(below_ + 1, model_->rows_.size() - 1)];
  const auto chance = [&](const TabulatedModel::Row& row) {
    return (row.cumulative[bin] - (bin > 0 ? row.cumulative[bin - 1] : 0)) * model_->bins_ / (2 * std::numbers::pi);
  };
  ScatteringValue<double> value;
  value.f_cos = m * ((1 - share_) * low.density.row(bin) + share_ * high.density.row(bin)).transpose();
  value.pdf = m * ((1 - share_) * chance(low) + share_ * chance(high));
  return value;
}

Vec3<double> TabulatedLobes::sample(double u_lobe, double u_theta, double u_ring, double u_phi) const {
  const auto& row = model_->rows_[std::min(below_ + (u_lobe < share_ ? 1 : 0), model_->rows_.size() - 1)];
  const double* first = row.cumulative.data();
  const auto bin =
      std::min<std::ptrdiff_t>(std::upper_bound(first, first + model_->bins_, u_phi) - first, model_->bins_ - 1);
  const double start = bin > 0 ? first[bin - 1] : 0;
  const double within = std::clamp((u_phi - start) / (first[bin] - start), 0.0, 1.0);
  const double phi = -std::numbers::pi + (static_cast<double>(bin) + within) * 2 * std::numbers::pi / model_->bins_;
  CurveLobes<double> cone;  // the longitudinal part is sampled as all lobes' is
  cone.widths = &model_->widths_;
  cone.sin_theta_o.setConstant(sin_theta_o_);
  cone.cos_theta_o.setConstant(cos_theta_o_);
  const double sin_i = cone.sample_longitudinal(0, u_theta, u_ring), cos_i = std::sqrt(1 - sin_i * sin_i);
  const double c = std::cos(phi) * cos_i, s = std::sin(phi) * cos_i;
  return {sin_i, azimuth_o_.x() * c - azimuth_o_.y() * s, azimuth_o_.x() * s + azimuth_o_.y() * c};
}

Rgb<double> TabulatedLobes::albedo() const {
  const auto& low = model_->rows_[below_];
  const auto& high = model_->rows_[std::min(below_ + 1, model_->rows_.size() - 1)];
  return (((1 - share_) * low.density + share_ * high.density).colwise().sum() * (2 * std::numbers::pi / model_->bins_))
      .transpose();
}

}  // namespace renderer
