#include "station/thread/invert/fit_document.h"

#include <cmath>

#include "inversion/fit/energy_bands.h"
#include "station/documents/reader.h"

namespace station {
namespace {

using nlohmann::json;

constexpr double kUndetermined = 0.2;  // standard deviation along a direction that is worth naming

json rows_of(const Eigen::MatrixXd& matrix) {
  json rows = json::array();
  for (const auto& row : matrix.rowwise()) rows.push_back(std::vector<double>(row.begin(), row.end()));
  return rows;
}

json certainty_json(const inversion::ViewFit& fit) {
  const inversion::Certainty& certainty = fit.certainty;
  json unknowns = json::array(), weakest = json::array();
  for (std::size_t k = 0; k < fit.unknown_names.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    unknowns.push_back({{"name", fit.unknown_names[k]},
                        {"value", fit.unknowns[i]},
                        {"sigma", std::sqrt(certainty.covariance(i, i))},
                        {"noise_sigma", std::sqrt(certainty.noise_covariance(i, i))},
                        {"at_bound", static_cast<bool>(certainty.at_bound[k])}});
  }
  for (const auto& axis : certainty.weakest) {
    if (axis.sigma < kUndetermined) break;
    weakest.push_back(
        {{"sigma", axis.sigma},
         {"direction", std::vector<double>(axis.direction.data(), axis.direction.data() + axis.direction.size())}});
  }
  return {{"unknowns", unknowns},
          {"covariance", rows_of(certainty.covariance)},
          {"misfit_over_noise", certainty.misfit},
          {"undetermined", weakest}};
}

json bands_json(const inversion::ViewFit& fit) {
  json bands = json::array();
  for (const inversion::EnergyBand& band : inversion::energy_bands(fit))
    bands.push_back({{"cosine", band.cosine},
                     {"lambda", band.lambda},
                     {"sigma", band.sigma},
                     {"sum", band.sum},
                     {"sum_sigma", band.sum_sigma},
                     {"albedo", band.albedo},
                     {"albedo_sigma", band.albedo_sigma}});
  return bands;
}

json rounds_json(const inversion::ViewFit& fit) {
  json rounds = json::array();
  for (const inversion::FitRound& round : fit.rounds)
    rounds.push_back({{"paths_per_block", round.paths_per_block},
                      {"steps", round.steps},
                      {"loss_before", round.loss_before},
                      {"loss_after", round.loss_after},
                      {"losses", round.losses},
                      {"prior_share", round.prior_share},
                      {"bias_free", round.bias_free},
                      {"converged", round.converged}});
  return rounds;
}

}  // namespace

std::map<std::string, inversion::ModelKind> names_of_models() {
  return {{"thread", inversion::ModelKind::thread},
          {"fiber", inversion::ModelKind::fiber},
          {"yarn", inversion::ModelKind::yarn},
          {"bundle", inversion::ModelKind::bundle},
          {"paper", inversion::ModelKind::paper}};
}

std::string name_of(inversion::ModelKind model) {
  for (const auto& [name, kind] : names_of_models())
    if (kind == model) return name;
  throw std::logic_error("a kind of model without a name");
}

std::string name_of(inversion::Solver solver) {
  return solver == inversion::Solver::adam ? "adam" : "lm";
}

std::vector<inversion::ViewAgreement> agreements_of(const std::vector<FittedView>& views, bool held_out) {
  std::vector<inversion::ViewAgreement> agreements;
  for (const FittedView& view : views)
    if (view.held_out == held_out) agreements.push_back(view.agreement);
  return agreements;
}

json fit_document(const inversion::ViewFit& fit, const inversion::FitOptions& options,
                  const std::vector<FittedView>& compared, int samples_per_pixel) {
  json views = json::array(), held = json::array();
  std::size_t fitted = 0;
  std::vector<inversion::ViewAgreement> reflection, transmission;
  for (const FittedView& view : compared) {
    views.push_back({{"id", view.id},
                     {"relative_rmse", view.agreement.relative_rmse()},
                     {"relative_bias", view.agreement.relative_bias},
                     {"mean_over_diffuser", view.agreement.mean_reference},
                     {"colour_over_diffuser",
                      std::vector<double>(view.agreement.mean_colour.begin(), view.agreement.mean_colour.end())}});
    if (view.transmission) views.back()["transmission"] = true;
    if (view.held_out) {
      views.back()["held_out"] = true;
      continue;
    }
    views.back()["weight"] = fit.view_weights[fitted++];
    (view.transmission ? transmission : reflection).push_back(view.agreement);
  }
  for (inversion::ParameterGroup group : options.held) held.push_back(name_of(group));
  const bool paper = options.model == inversion::ModelKind::paper;
  json document{{"model", name_of(options.model)},
                {"solver", name_of(paper ? inversion::Solver::adam : options.solver)},
                {"seed", options.seed},
                {"prior_weight", options.model == inversion::ModelKind::thread ? options.prior_weight : 0.0},
                {"held", held},
                {"robust", options.robust && !paper},
                {"block_px", fit.block_px},
                {"blocks", fit.blocks},
                {"start", fit.start},
                {"rounds", rounds_json(fit)},
                {"samples_per_pixel", samples_per_pixel},
                {"views", views},
                {"relative_rmse", inversion::overall_relative_rmse(agreements_of(compared, false))},
                {"certainty", certainty_json(fit)}};
  if (!reflection.empty()) document["relative_rmse_reflection"] = inversion::overall_relative_rmse(reflection);
  if (!transmission.empty()) document["relative_rmse_transmission"] = inversion::overall_relative_rmse(transmission);
  if (const auto held_out = agreements_of(compared, true); !held_out.empty())
    document["relative_rmse_held_out"] = inversion::overall_relative_rmse(held_out);
  if (options.model == inversion::ModelKind::thread) document["bands"] = bands_json(fit);
  if (const auto* yarn = std::get_if<renderer::YarnParameters>(&fit.model)) document["fiber_count"] = yarn->fiber_count;
  if (const auto* bundle = std::get_if<renderer::BundleParameters>(&fit.model)) {
    document["fiber_count"] = bundle->fiber_count;
    document["radius_ratio"] = bundle->radius_ratio;
  }
  return document;
}

}  // namespace station
