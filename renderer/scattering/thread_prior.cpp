#include "renderer/scattering/thread_prior.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "renderer/scattering/azimuthal_fit.h"
#include "renderer/scattering/degree.h"
#include "renderer/scattering/multi_fiber.h"
#include "renderer/scattering/thread_prior_json.h"  // the document as text, from thread_prior.json

namespace renderer {
namespace {

constexpr double kThetasDeg[] = {0, 15, 30, 45, 60, 70, 75, 80};

LibraryFit fit_thread(const LibraryThread& thread, const PriorOptions& options) {
  std::vector<AzimuthalData> data;
  for (std::size_t c = 0; c < thread.absorptions.size(); ++c) {
    if (c > 0 && thread.absorptions[c] == thread.absorptions[c - 1]) continue;  // grey: one colour says it all
    for (double theta_deg : kThetasDeg) {
      MultiFiberOptions simulated = simulation_of(thread, thread.absorptions[c], theta_deg * kDegree);
      simulated.rays = options.rays, simulated.configurations = options.configurations;
      simulated.bins = options.bins, simulated.seed = options.seed;
      const std::vector<double> density = simulate_multi_fiber(simulated).density;
      data.push_back({.theta_rad = simulated.theta_rad,
                      .eta = kThreadEta,
                      .absorption = thread.absorptions[c],
                      .density = Eigen::Map<const Eigen::ArrayXd>(density.data(), std::ssize(density))});
    }
  }
  const JointThreadFit fit = fit_thread_jointly(data);
  LibraryFit result{.thread = thread,
                    .unknowns = {},
                    .covariance = fit.covariance.topLeftCorner<kPriorUnknownCount, kPriorUnknownCount>(),
                    .error = fit.error};
  for (int i = 0; i < kPriorUnknownCount; ++i) result.unknowns[i] = fit.values[static_cast<std::size_t>(i)].value;
  return result;
}

}  // namespace

const ThreadPrior& simulated_thread_prior() {
  static const ThreadPrior prior = [] {
    const nlohmann::json document = nlohmann::json::parse(kThreadPriorJson);
    ThreadPrior read;
    read.threads = document.at("threads").get<int>();
    for (int i = 0; i < kPriorUnknownCount; ++i) {
      read.mean[i] = document.at("mean").at(static_cast<std::size_t>(i)).get<double>();
      for (int k = 0; k < kPriorUnknownCount; ++k)
        read.covariance(i, k) =
            document.at("covariance").at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(k)).get<double>();
    }
    return read;
  }();
  return prior;
}

std::vector<LibraryThread> thread_library() {
  std::vector<LibraryThread> library;
  for (double ratio : {0.05, 0.1, 0.2})
    for (double eta : {1.46, 1.6})
      for (double gap : {0.05, 0.3})
        for (const auto& absorptions :
             {std::array{0.0, 0.0, 0.0}, std::array{0.01, 0.03, 0.1}, std::array{0.05, 0.2, 0.4}})
          library.push_back({ratio, eta, gap, absorptions});
  return library;
}

MultiFiberOptions simulation_of(const LibraryThread& thread, double sigma_a, double theta_rad) {
  return {.thread_radius = 1 / thread.radius_ratio,
          .fiber_radius = 1,
          .min_gap = thread.gap,
          .max_attempts = static_cast<int>(10 / (thread.radius_ratio * thread.radius_ratio)),
          .eta = thread.eta,
          .sigma_a = sigma_a,
          .theta_rad = theta_rad};
}

std::vector<LibraryFit> fit_library(const std::vector<LibraryThread>& library, const PriorOptions& options) {
  std::vector<LibraryFit> fits;
  for (const LibraryThread& thread : library) {
    if (options.progress && !options.progress(static_cast<int>(fits.size()), static_cast<int>(library.size())))
      throw std::runtime_error("the library of threads was stopped on request; start it again");
    fits.push_back(fit_thread(thread, options));
  }
  return fits;
}

ThreadPrior prior_of(const std::vector<LibraryFit>& fits) {
  if (fits.size() < 2) throw std::invalid_argument("a prior needs two threads at least");
  ThreadPrior prior;
  prior.threads = static_cast<int>(fits.size());
  const double count = static_cast<double>(fits.size());
  prior.mean.setZero();
  for (const LibraryFit& fit : fits) prior.mean += fit.unknowns / count;
  prior.covariance.setZero();
  for (const LibraryFit& fit : fits) {
    const PriorVector from_mean = fit.unknowns - prior.mean;
    prior.covariance += from_mean * from_mean.transpose() / (count - 1) + fit.covariance / count;
  }
  return prior;
}

}  // namespace renderer
