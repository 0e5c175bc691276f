#include "station/thread/validate/recover_thread.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <stdexcept>

#include "inversion/fit/energy_bands.h"
#include "inversion/fit/thread_unknowns.h"
#include "inversion/view/agreement.h"
#include "station/documents/number_text.h"
#include "station/documents/rig_file.h"
#include "station/documents/spool.h"
#include "station/documents/thread_file.h"
#include "station/output/interrupt.h"
#include "station/output/progress.h"
#include "station/thread/validate/seeds.h"
#include "station/thread/validate/synthetic_views.h"

namespace station {
namespace {

using inversion::View;

constexpr double kLeastCosine = 0.65;  // inclinations that the 17 views show well
constexpr double kSameEnergy = 1e-6;   // between a lobe's energies that are the same
constexpr int kLossPaths = 4096, kLossRepetitions = 4;
constexpr const char* kRecoveryStopped = "the recovery was interrupted; start it again";

// One fit's value of every quantity, with its deviation under a covariance of the unknowns.
struct Reading {
  std::vector<double> values, sigmas;
};

Reading reading_of(const inversion::ViewFit& fit, const Eigen::MatrixXd& covariance) {
  Reading reading;
  for (int k = 0; k < inversion::kL0; ++k) {
    reading.values.push_back(fit.unknowns[k]);
    reading.sigmas.push_back(std::sqrt(covariance(k, k)));
  }
  for (const inversion::EnergyBand& band : inversion::energy_bands(fit, covariance))
    if (band.cosine > kLeastCosine)
      for (std::size_t p = 0; p < 3; ++p) {
        reading.values.push_back(band.lambda[p]);
        reading.sigmas.push_back(band.sigma[p]);
      }
  for (Eigen::Index k = inversion::kTintRed; k < fit.unknowns.size(); ++k) {
    reading.values.push_back(fit.unknowns[k]);
    reading.sigmas.push_back(std::sqrt(covariance(k, k)));
  }
  return reading;
}

std::vector<std::string> quantity_names(bool tinted) {
  std::vector<std::string> names;
  for (const char* group : {"sigma_a", "alpha", "beta"})
    for (int i = 0; i < 3; ++i) names.push_back(std::string(group) + "[" + std::to_string(i) + "]");
  for (int tenth = 1; tenth <= 10; ++tenth)
    if (tenth / 10.0 > kLeastCosine)
      for (int p = 0; p < 3; ++p) {
        char name[32];
        std::snprintf(name, sizeof name, "lambda_%d(%.1f)", p, tenth / 10.0);
        names.emplace_back(name);
      }
  if (tinted) names.insert(names.end(), {"log tint r/g", "log tint b/g"});
  return names;
}

std::vector<View> with_noise(const std::vector<View>& exact, const rig::TrueSensor& sensor, std::uint64_t seed) {
  std::vector<View> views = exact;
  for (View& view : views) {
    SensedPicture sensed = with_sensor_noise(view.image, view.mask, sensor, kPhotographLevel, ++seed);
    view.image = sensed.radiance;
    view.noise = sensed.noise;
  }
  return views;
}

nlohmann::json loss_json(const inversion::IndependentLoss& loss) {
  return {{"mean", loss.mean}, {"standard_error", loss.standard_error}, {"without_noise", loss.without_noise}};
}

// Refuses a thread that no values of the unknowns give: pictures of it say nothing about how well a fit finds it.
void require_reachable(const std::filesystem::path& file, const renderer::ThreadParameters& truth) {
  const auto refused = [&](const std::string& what) {
    return std::runtime_error(file.string() + ": " + what +
                              "; give a thread that a fit can find, or change the thread's parameters");
  };
  const renderer::ThreadParameters found = inversion::tinted_parameters_of(inversion::tinted_unknowns_of(truth));
  if (const double most = found.sigma_a.maxCoeff(); most < truth.sigma_a.maxCoeff())
    throw refused("its sigma_a is " + number_text(truth.sigma_a.maxCoeff(), 4) + ", and the most of a fit is " +
                  number_text(most, 4));
  for (int tenth = 0; tenth <= 10; ++tenth) {
    const auto of_truth = renderer::thread_lobe_energies<double>(truth, tenth / 10.0),
               of_found = renderer::thread_lobe_energies<double>(found, tenth / 10.0);
    for (std::size_t p = 0; p < 3; ++p)
      if (std::abs(of_truth[p] - of_found[p]) > kSameEnergy)
        throw refused("its lambda_" + std::to_string(p) + " is " + number_text(of_truth[p], 4) + " at cos theta " +
                      number_text(tenth / 10.0, 1) + ", and the nearest that a fit can have is " +
                      number_text(of_found[p], 4));
  }
}

// The spool's views as the known thread gives them, without noise. `begun` is told the name of each.
std::vector<View> photographs(const RecoverRequest& request, const RigFile& rig, const Spool& spool,
                              const ThreadFile& thread, const std::function<void(const std::string&)>& begun) {
  std::vector<View> exact = synthetic_views(rig, spool.wrapping, kPooledWidth_px, kPooledHeight_px);
  for (View& view : exact) {
    begun(view.id);
    view.image =
        inversion::fitted_view(spool.wrapping, view, thread.parameters, request.samples_per_pixel,
                               request.fit.seed + kExactViewSeeds + static_cast<std::uint64_t>(&view - exact.data()),
                               [](double) { return !interrupted(); });
    if (interrupted()) throw std::runtime_error(kRecoveryStopped);
  }
  return exact;
}

// A fit to one draw of the noise, with the deviations that noise gives it and with its total ones.
struct Draw {
  Reading by_noise, total;
};

// The seen and the predicted deviation of each quantity over the draws of the noise, of which there are two or more.
void add_spreads(const std::vector<Draw>& draws, std::vector<RecoveredQuantity>& quantities) {
  constexpr double kHeld = 3;  // deviations
  const auto count = static_cast<double>(draws.size());
  for (std::size_t i = 0; i < quantities.size(); ++i) {
    RecoveredQuantity& of = quantities[i];
    double spread2 = 0, predicted2 = 0;
    for (const Draw& draw : draws) of.mean += draw.by_noise.values[i] / count;
    for (const auto& [by_noise, total] : draws) {
      spread2 += (by_noise.values[i] - of.mean) * (by_noise.values[i] - of.mean) / (count - 1);
      predicted2 += by_noise.sigmas[i] * by_noise.sigmas[i] / count;
      of.held += std::abs(total.values[i] - of.truth) <= kHeld * total.sigmas[i] ? 1 / count : 0;
    }
    of.spread = std::sqrt(spread2);
    of.predicted = std::sqrt(predicted2);
  }
}

// Each quantity of the fit beside the true one.
std::vector<RecoveredQuantity> recovered_quantities(const inversion::ViewFit& truth, const inversion::ViewFit& fit) {
  const std::vector<std::string> names = quantity_names(fit.unknowns.size() == inversion::kTintedCount);
  const Reading true_values = reading_of(truth, fit.certainty.covariance),
                found = reading_of(fit, fit.certainty.covariance);
  std::vector<RecoveredQuantity> quantities;
  for (std::size_t i = 0; i < names.size(); ++i)
    quantities.push_back(
        {.name = names[i], .truth = true_values.values[i], .fitted = found.values[i], .sigma = found.sigmas[i]});
  return quantities;
}

// The same fit begun at what it found, by its last two rounds.
inversion::FitOptions fit_again(const inversion::FitOptions& options, const inversion::ViewFit& found) {
  inversion::FitOptions again = options;
  again.start = found.thread();
  again.other_starts.clear();
  const std::vector<int>& paths = options.paths_per_block;
  again.paths_per_block.assign(paths.end() - static_cast<std::ptrdiff_t>(std::min<std::size_t>(2, paths.size())),
                               paths.end());
  return again;
}

}  // namespace

RecoveredThread recover_thread(const RecoverRequest& request) {
  watch_interrupts();
  const RigFile rig = read_rig(request.rig);
  const Spool spool = read_spool(request.spool);
  const ThreadFile thread = read_thread(request.thread);
  require_reachable(request.thread, thread.parameters);
  ProgressDisplay progress("recover", request.progress_style);
  const int parts = 2 + request.draws;
  const auto show = [&](int part, const std::string& what) { progress.show(part, parts, what); };
  const std::vector<View> exact =
      photographs(request, rig, spool, thread, [&](const std::string& view) { show(0, "photograph " + view); });
  const rig::TrueSensor& sensor = rig.simulation->truth.sensor;
  const auto draw_of = [&](std::uint64_t seed) { return with_noise(exact, sensor, kPictureSeeds * seed); };
  const auto fit_draw = [&](int draw, inversion::FitOptions options, const std::vector<View>& views) {
    options.progress = [&, draw](const std::string& what, double) {
      show(1 + draw, (draw ? "draw " + std::to_string(draw) + ", " : "cold fit, ") + what);
      return !interrupted();
    };
    return inversion::fit_views(spool.wrapping, views, options);
  };

  const auto started = std::chrono::steady_clock::now();
  const std::vector<View> first_views = draw_of(request.fit.seed);
  inversion::FitOptions cold = request.fit;
  cold.start.exit = thread.parameters.exit;
  cold.start.transmittance_powers = thread.parameters.transmittance_powers;
  cold.tinted = thread.parameters.lambda0_rgb != Eigen::Vector3d::Ones();
  const inversion::ViewFit first = fit_draw(0, cold, first_views);
  RecoveredThread result{.thread = thread.name,
                         .seconds = seconds_since(started),
                         .loss_of_truth = {},
                         .loss_of_fit = {},
                         .draws = request.draws,
                         .quantities = {}};
  inversion::ViewFit truth = first;
  truth.unknowns = cold.tinted ? inversion::tinted_unknowns_of(thread.parameters)
                               : Eigen::VectorXd(inversion::unknowns_of(thread.parameters));
  const auto loss_of = [&](const inversion::ViewFit& fit) {
    return inversion::independent_loss(spool.wrapping, first_views, fit, kLossPaths, kLossRepetitions,
                                       request.fit.seed + kIndependentLossSeeds);
  };
  result.loss_of_truth = loss_of(truth);
  result.loss_of_fit = loss_of(first);
  result.quantities = recovered_quantities(truth, first);

  inversion::FitOptions again = fit_again(cold, first);
  std::vector<Draw> draws;
  for (int draw = 1; draw <= request.draws; ++draw) {
    again.seed = request.fit.seed + kDrawSeedStep * static_cast<std::uint64_t>(draw);
    const inversion::ViewFit fit = fit_draw(draw, again, draw_of(again.seed));
    draws.push_back({reading_of(fit, fit.certainty.noise_covariance), reading_of(fit, fit.certainty.covariance)});
  }
  if (draws.size() > 1) add_spreads(draws, result.quantities);
  progress.finish(std::to_string(1 + request.draws) + " fits");
  return result;
}

std::vector<RecoveredThread> recover_threads(RecoverRequest request, const std::vector<std::filesystem::path>& threads,
                                             const std::function<void(const RecoveredThread&)>& found) {
  std::vector<RecoveredThread> recovered;
  for (const std::filesystem::path& thread : threads) {
    request.thread = thread;
    recovered.push_back(recover_thread(request));
    found(recovered.back());
  }
  return recovered;
}

std::string describe(const RecoveredThread& recovered) {
  char line[160];
  std::snprintf(line, sizeof line, "%s, 17 views, fitted from cold in %.1f s; then %d draws of the noise\n",
                recovered.thread.c_str(), recovered.seconds, recovered.draws);
  std::string text = line;
  std::snprintf(
      line, sizeof line, "loss on other paths: truth %.4g +- %.1g, fit %.4g +- %.1g; without their noise %.3g, %.3g\n",
      recovered.loss_of_truth.mean, recovered.loss_of_truth.standard_error, recovered.loss_of_fit.mean,
      recovered.loss_of_fit.standard_error, recovered.loss_of_truth.without_noise, recovered.loss_of_fit.without_noise);
  text += line;
  text += "quantity           truth   fitted     +-   error, %  in +-     mean   spread  predicted  predicted/spread";
  text += recovered.draws > 1 ? "  held, %\n" : "\n";
  for (const RecoveredQuantity& of : recovered.quantities) {
    const double error = of.fitted - of.truth;
    std::snprintf(line, sizeof line, "%-14s  %8.4f %8.4f %6.4f  %9.1f  %5.1f", of.name.c_str(), of.truth, of.fitted,
                  of.sigma, 100 * error / of.truth, of.sigma > 0 ? error / of.sigma : 0.0);
    text += line;
    if (recovered.draws > 1) {
      std::snprintf(line, sizeof line, " %8.4f  %7.5f    %7.5f  %16.2f %8.0f", of.mean, of.spread, of.predicted,
                    of.spread > 0 ? of.predicted / of.spread : 0.0, 100 * of.held);
      text += line;
    }
    text += "\n";
  }
  return text;
}

std::string table_of(const std::vector<RecoveredThread>& recovered) {
  if (recovered.size() < 2 || recovered.front().draws < 2) return {};
  std::string text = "thread                    held, % (mean, least)   beta_TT: mean error, %   predicted/spread\n";
  for (const RecoveredThread& one : recovered) {
    double mean = 0, least = 1, low = std::numeric_limits<double>::infinity(), high = 0, beta = 0;
    for (const RecoveredQuantity& of : one.quantities) {
      mean += of.held / static_cast<double>(one.quantities.size());
      least = std::min(least, of.held);
      if (of.name == "beta[1]") beta = 100 * (of.mean / of.truth - 1);
      if (of.spread > 0) low = std::min(low, of.predicted / of.spread), high = std::max(high, of.predicted / of.spread);
    }
    text += formatted("%-24s  %13.1f %9.0f  %22.1f  %9.2f ... %.2f\n", one.thread.c_str(), 100 * mean, 100 * least,
                      beta, low, high);
  }
  return text;
}

nlohmann::json to_json(const std::vector<RecoveredThread>& recovered) {
  if (recovered.size() == 1) return to_json(recovered.front());
  nlohmann::json all = nlohmann::json::array();
  for (const RecoveredThread& one : recovered) all.push_back(to_json(one));
  return all;
}

nlohmann::json to_json(const RecoveredThread& recovered) {
  nlohmann::json quantities = nlohmann::json::array();
  for (const RecoveredQuantity& of : recovered.quantities)
    quantities.push_back({{"name", of.name},
                          {"truth", of.truth},
                          {"fitted", of.fitted},
                          {"sigma", of.sigma},
                          {"mean", of.mean},
                          {"spread", of.spread},
                          {"predicted", of.predicted},
                          {"held", of.held}});
  return {{"thread", recovered.thread},
          {"seconds", recovered.seconds},
          {"loss_of_truth", loss_json(recovered.loss_of_truth)},
          {"loss_of_fit", loss_json(recovered.loss_of_fit)},
          {"draws", recovered.draws},
          {"quantities", quantities}};
}

}  // namespace station
