#include "inversion/scattering_family.h"

#include <ceres/ceres.h>

#include "inversion/thread_unknowns.h"

namespace inversion {
namespace {

using Eigen::VectorXd;
using RgbByUnknowns = Eigen::Matrix<double, 3, Eigen::Dynamic>;
using renderer::kThreadParameterCount;

constexpr double kGamma = 1e-4;          // of eq. 6's trend of lambda_0
constexpr double kTrendRounding = 1e-3;  // below this the hinge is rounded, so that it has a derivative
constexpr int kEnergyAngles = 33;        // c = 0, where no view sees how high lambda_2 rises, to c = 1
// Of the mean squared excess: 1 % of it costs as much as a tenth of the data term.
constexpr double kEnergyPenalty = 30;
constexpr double kMostFiberAbsorption = 50;  // per radius: black
constexpr double kLeastRoughness = 0.02;

// Energy beyond 1 at evenly spaced c, both ends included: it is there that fits exceed it first.
struct EnergyTerm {
  template <class S>
  bool operator()(const S* u, S* residuals) const {
    renderer::BasicThreadParameters<S> p;
    renderer::set_energies(u + kL0, p);
    p.limit_energy = false;
    const double weight = std::sqrt(2 * kEnergyPenalty / kEnergyAngles);
    for (int i = 0; i < kEnergyAngles; ++i) {
      const double c = i / (kEnergyAngles - 1.0);
      const auto lambda = renderer::thread_lobe_energies<S>(p, c);
      const S excess = lambda[0] + lambda[1] + lambda[2] - S(1.0);
      residuals[i] = excess > S(0.0) ? S(weight) * excess : S(0.0);
    }
    return true;
  }
};

// lambda_0(1) - lambda_0(0) where positive.
struct TrendTerm {
  template <class S>
  bool operator()(const S* u, S* residual) const {
    residual[0] = u[kL1] > u[kL0] ? u[kL1] - u[kL0] : S(0.0);
    return true;
  }
};

class ThreadShader : public BlockShader {
 public:
  explicit ThreadShader(const ThreadUnknowns& unknowns)
      : model_(block_model(parameters_of(unknowns))), by_unknowns_(parameters_by_unknowns(unknowns)) {}

  BlockEstimate shade(const LightPaths& paths, std::size_t block, bool with_slopes) const override {
    return shade_block(paths, block, model_, with_slopes);
  }
  RgbByUnknowns by_unknowns(const renderer::ThreadSlopes<double>& slopes) const override {
    Eigen::Matrix<double, 3, kThreadParameterCount> by_parameters;
    by_parameters.setZero();
    for (int c = 0; c < 3; ++c) {
      by_parameters(c, c) = slopes(renderer::kSlopeSigma, c);
      for (int k = 1; k < renderer::kThreadSlopeCount; ++k) by_parameters(c, k + 2) = slopes(k, c);
    }
    return by_parameters * by_unknowns_;
  }

 private:
  BlockModel model_;
  ThreadJacobian by_unknowns_;
};

// Unknowns: sigma_a of the three channels, then those of the rows after the first.
template <class Model>
class BaselineShader : public BlockShader {
 public:
  BaselineShader(Model model, double sigma_scale) : model_(std::move(model)), sigma_scale_(sigma_scale) {}

  BlockEstimate shade(const LightPaths& paths, std::size_t block, bool with_slopes) const override {
    return shade_block(paths, block, model_, with_slopes);
  }
  RgbByUnknowns by_unknowns(const renderer::ThreadSlopes<double>& slopes) const override {
    RgbByUnknowns rows = RgbByUnknowns::Zero(3, Model::kSlopeCount + 2);
    for (int c = 0; c < 3; ++c) {
      rows(c, c) = sigma_scale_ * slopes(0, c);
      for (int k = 1; k < Model::kSlopeCount; ++k) rows(c, k + 2) = slopes(k, c);
    }
    return rows;
  }

 private:
  Model model_;
  double sigma_scale_;
};

class ThreadFamily : public ScatteringFamily {
 public:
  std::string name() const override { return "thread"; }
  std::vector<std::string> unknown_names() const override {
    return {"sigma_a_r", "sigma_a_g", "sigma_a_b", "alpha_r", "alpha_tt", "alpha_trt", "beta_r",  "beta_tt",
            "beta_trt",  "l0",        "l1",        "kappa",   "r1a",      "log_r2a",   "log_r2b", "n2"};
  }
  VectorXd lower_bounds() const override { return inversion::lower_bounds(); }
  VectorXd upper_bounds() const override { return inversion::upper_bounds(); }
  std::vector<VectorXd> starts() const override {
    std::vector<VectorXd> all{unknowns_of(starting_thread())};
    for (const renderer::ThreadParameters& start : other_starting_threads()) all.emplace_back(unknowns_of(start));
    return all;
  }
  renderer::ScatteringModel model(const VectorXd& unknowns) const override { return parameters_of(unknowns); }
  std::unique_ptr<BlockShader> shader(const VectorXd& unknowns) const override {
    return std::make_unique<ThreadShader>(unknowns);
  }
  void add_penalties(ceres::Problem& problem, double* unknowns) const override {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<EnergyTerm, kEnergyAngles, kThreadParameterCount>(new EnergyTerm), nullptr,
        unknowns);
    // Huber's loss is linear beyond the rounding: half of it times the scale is gamma |x|.
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<TrendTerm, 1, kThreadParameterCount>(new TrendTerm),
        new ceres::ScaledLoss(new ceres::HuberLoss(kTrendRounding), kGamma / kTrendRounding, ceres::TAKE_OWNERSHIP),
        unknowns);
  }
};

VectorXd vector_of(std::initializer_list<double> numbers) {
  VectorXd vector(static_cast<Eigen::Index>(numbers.size()));
  std::copy(numbers.begin(), numbers.end(), vector.data());
  return vector;
}

class FiberFamily : public ScatteringFamily {
 public:
  std::string name() const override { return "fiber"; }
  std::vector<std::string> unknown_names() const override {
    return {"sigma_a_r", "sigma_a_g", "sigma_a_b", "beta_m", "beta_n"};
  }
  VectorXd lower_bounds() const override { return vector_of({0, 0, 0, kLeastRoughness, kLeastRoughness}); }
  VectorXd upper_bounds() const override {
    return vector_of({kMostFiberAbsorption, kMostFiberAbsorption, kMostFiberAbsorption, 1, 1});
  }
  std::vector<VectorXd> starts() const override {
    return {vector_of({0.3, 0.3, 0.3, 0.3, 0.3}), vector_of({0.1, 0.1, 0.1, 0.6, 0.6}),
            vector_of({1, 1, 1, 0.4, 0.9})};
  }
  renderer::ScatteringModel model(const VectorXd& u) const override { return parameters(u); }
  std::unique_ptr<BlockShader> shader(const VectorXd& u) const override {
    return std::make_unique<BaselineShader<FiberBlockModel>>(block_model(parameters(u)), 1.0);
  }

 private:
  static renderer::FiberParameters parameters(const VectorXd& u) {
    return {.sigma_a = u.head<3>(), .beta_m = u[3], .beta_n = u[4]};
  }
};

class YarnFamily : public ScatteringFamily {
 public:
  explicit YarnFamily(int fiber_count) : fiber_count_(fiber_count) {}
  std::string name() const override { return "yarn"; }
  std::vector<std::string> unknown_names() const override {
    return {"sigma_a_r", "sigma_a_g", "sigma_a_b", "beta_r", "beta_tt", "gamma_tt"};
  }
  VectorXd lower_bounds() const override {
    return vector_of({0, 0, 0, kLeastRoughness, kLeastRoughness, kLeastRoughness});
  }
  VectorXd upper_bounds() const override {
    return vector_of({kMostFiberAbsorption, kMostFiberAbsorption, kMostFiberAbsorption, 1, 1, 1});
  }
  std::vector<VectorXd> starts() const override {
    return {vector_of({0.3, 0.3, 0.3, 0.3, 0.3, 0.3}), vector_of({1, 1, 1, 0.5, 0.2, 0.6})};
  }
  renderer::ScatteringModel model(const VectorXd& u) const override { return parameters(u); }
  std::unique_ptr<BlockShader> shader(const VectorXd& u) const override {
    return std::make_unique<BaselineShader<YarnBlockModel>>(block_model(parameters(u)), 1.0);
  }

 private:
  renderer::YarnParameters parameters(const VectorXd& u) const {
    return {.fiber_count = fiber_count_,
            .radius_ratio = std::sqrt(kYarnPacking / fiber_count_),
            .sigma_a = u.head<3>(),
            .beta_r = u[3],
            .beta_tt = u[4],
            .gamma_tt = u[5]};
  }
  int fiber_count_;
};

}  // namespace

void ScatteringFamily::add_penalties(ceres::Problem&, double*) const {}

renderer::ThreadParameters starting_thread() {
  renderer::ThreadParameters p;
  p.sigma_a.setConstant(0.3);
  return p;
}

std::vector<renderer::ThreadParameters> other_starting_threads() {
  renderer::ThreadParameters clear = starting_thread(), dark = starting_thread();
  clear.sigma_a.setConstant(0.1);
  clear.alpha = {0.4, 0.3, 0.3};
  clear.beta = {0.9, 0.6, 0.6};
  dark.sigma_a.setConstant(0.6);
  dark.alpha = {0.15, 0.3, 0.8};
  dark.beta = {0.9, 0.6, 0.3};
  return {clear, dark};
}

std::unique_ptr<ScatteringFamily> thread_family() {
  return std::make_unique<ThreadFamily>();
}

std::unique_ptr<ScatteringFamily> fiber_family() {
  return std::make_unique<FiberFamily>();
}

std::unique_ptr<ScatteringFamily> yarn_family(int fiber_count) {
  return std::make_unique<YarnFamily>(fiber_count);
}

}  // namespace inversion
