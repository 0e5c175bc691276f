#include "station/cloth/export/pbr_fit.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "calibration/light/colour_chart.h"

namespace station {
namespace {

using Eigen::Array3d;
using nlohmann::json;

// The parameters: roughness, specular, its level and tint, sheen, its tint and roughness, normal scale.
constexpr int kParameters = 8;
using Parameters = std::array<double, kParameters>;
constexpr double kMostLevel = 2;  // 8 % at normal incidence, more than any fiber has; more brings cloths no nearer
constexpr Parameters kLow{0.2, 0, 0, 0, 0, 0, kLeastSheenRoughness, 0}, kHigh{1, 1, kMostLevel, 1, 1, 1, 1, 1},
    kStart{0.6, 0.5, 1, 0.5, 0.1, 0.5, 0.5, 0.5};
constexpr int kTexelsAcross = 12;

GltfMaterial material_of(const double* p) {
  return {.roughness = p[0],
          .specular = p[1],
          .specular_level = p[2],
          .specular_tint = p[3],
          .sheen = p[4],
          .sheen_tint = p[5],
          .sheen_roughness = p[6],
          .normal_scale = p[7]};
}

Array3d lightness(const Array3d& radiance) {
  constexpr double kDark = 0.01;  // differences below it do not count much
  return (radiance.max(0) + kDark).pow(1.0 / 3);
}

struct Residuals {
  const BakedSide& side;
  const std::vector<DirectionPair>& pairs;
  const std::vector<Array3d>& far_field;

  bool operator()(double const* const* parameters, double* residuals) const {
    const GltfShader shader(material_of(parameters[0]));
    const std::vector<PbrTexel> texels = texels_of(side, shader, kTexelsAcross);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Array3d modelled = mean_radiance(texels, shader, pairs[i].to_view, pairs[i].to_light);
      Eigen::Map<Array3d>(residuals + 3 * i) = lightness(modelled) - lightness(far_field[i]);
    }
    return true;
  }
};

json list(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

PbrFit fit_material(const BakedSide& side, const std::vector<DirectionPair>& pairs,
                    const std::vector<Array3d>& far_field) {
  std::vector<DirectionPair> front;
  std::vector<Array3d> wanted;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (pairs[i].to_light.z() > 0) front.push_back(pairs[i]), wanted.push_back(far_field[i]);
  ceres::NumericDiffOptions steps;
  steps.relative_step_size = 1e-4;
  auto* cost = new ceres::DynamicNumericDiffCostFunction<Residuals>(new Residuals{side, front, wanted},
                                                                    ceres::TAKE_OWNERSHIP, steps);
  cost->AddParameterBlock(kParameters);
  cost->SetNumResiduals(static_cast<int>(3 * front.size()));
  Parameters parameters = kStart;
  ceres::Problem problem;  // owns the cost
  problem.AddResidualBlock(cost, nullptr, parameters.data());
  for (int k = 0; k < kParameters; ++k) {
    problem.SetParameterLowerBound(parameters.data(), k, kLow[static_cast<std::size_t>(k)]);
    problem.SetParameterUpperBound(parameters.data(), k, kHigh[static_cast<std::size_t>(k)]);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 60;
  options.function_tolerance = 1e-5;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return {.material = material_of(parameters.data()),
          .converged = summary.termination_type == ceres::CONVERGENCE,
          .rounds = static_cast<int>(summary.iterations.size())};
}

std::vector<FarFieldError> far_field_errors(const std::vector<PbrTexel>& texels, const GltfShader& shader,
                                            const std::vector<DirectionPair>& pairs,
                                            const std::vector<Array3d>& far_field) {
  const auto lab = [](const Array3d& linear) { return calibration::lab_of_linear_srgb(linear.max(0).matrix()); };
  std::vector<FarFieldError> errors;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Array3d material = mean_radiance(texels, shader, pairs[i].to_view, pairs[i].to_light);
    errors.push_back({.pair = pairs[i],
                      .cloth = far_field[i],
                      .material = material,
                      .delta_e = calibration::delta_e_2000(lab(far_field[i]), lab(material))});
  }
  return errors;
}

FarFieldAgreement agreement(const std::vector<FarFieldError>& errors, bool front) {
  FarFieldAgreement found;
  std::vector<double> delta_e;
  double difference = 0, all = 0;
  for (const FarFieldError& error : errors) {
    if ((error.pair.to_light.z() > 0) != front) continue;
    delta_e.push_back(error.delta_e);
    found.mean_delta_e += error.delta_e;
    difference += (error.material - error.cloth).square().sum();
    all += error.cloth.square().sum();
  }
  if (delta_e.empty()) return found;
  std::ranges::sort(delta_e);
  found.pairs = static_cast<int>(delta_e.size());
  found.relative_rms = std::sqrt(difference / all);
  found.mean_delta_e /= found.pairs;
  found.delta_e_95 = delta_e[delta_e.size() * 95 / 100];
  return found;
}

json to_json(const GltfMaterial& material) {
  return {{"roughness", material.roughness},
          {"specular", material.specular},
          {"specular_level", material.specular_level},
          {"specular_tint", material.specular_tint},
          {"sheen", material.sheen},
          {"sheen_tint", material.sheen_tint},
          {"sheen_roughness", material.sheen_roughness},
          {"normal_scale", material.normal_scale}};
}

json to_json(const FarFieldAgreement& agreement) {
  return {{"pairs", agreement.pairs},
          {"relative_rms", agreement.relative_rms},
          {"mean_delta_e_2000", agreement.mean_delta_e},
          {"delta_e_2000_95", agreement.delta_e_95}};
}

json to_json(const FarFieldError& error) {
  return {{"to_view", list(error.pair.to_view)},
          {"to_light", list(error.pair.to_light)},
          {"cloth", list(error.cloth)},
          {"material", list(error.material)},
          {"delta_e_2000", error.delta_e}};
}

}  // namespace station
