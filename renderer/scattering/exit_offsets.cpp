#include "renderer/scattering/exit_offsets.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "renderer/scattering/degree.h"
#include "renderer/scattering/exit_offsets_json.h"  // the document as text, from exit_offsets.json
#include "renderer/scattering/multi_fiber.h"

namespace renderer {
namespace {

constexpr double kThetasDeg[] = {0, 30, 60};
constexpr float kPi = std::numbers::pi_v<float>;

}  // namespace

ExitOffsets::ExitOffsets(int offset_bins, int azimuth_bins, const std::vector<double>& share)
    : offset_bins_(offset_bins), azimuth_bins_(azimuth_bins) {
  const auto row_size = static_cast<std::size_t>(offset_bins);
  if (offset_bins < 1 || azimuth_bins < 1 ||
      share.size() != row_size * row_size * static_cast<std::size_t>(azimuth_bins))
    throw std::invalid_argument("a table of offsets has offset bins x azimuth bins x offset bins entries");
  for (std::size_t start = 0; start < share.size(); start += row_size) {
    double sum = 0, up_to = 0;
    for (std::size_t i = 0; i < row_size; ++i) sum += share[start + i];
    for (std::size_t i = 0; i < row_size; ++i) {
      up_to += sum > 0 ? share[start + i] / sum : 1.0 / offset_bins;  // nothing seen: anywhere
      up_to_.push_back(static_cast<float>(up_to));
    }
    up_to_.back() = 1;
  }
}

ExitOffsets::Row ExitOffsets::row(float offset_in, float azimuth) const {
  const bool mirrored = offset_in < 0;
  if (mirrored) offset_in = -offset_in, azimuth = -azimuth;
  float turns = azimuth / (2 * kPi) + 0.5f;
  turns -= std::floor(turns);
  const int in = std::min(static_cast<int>(offset_in * static_cast<float>(offset_bins_)), offset_bins_ - 1);
  const int bin = std::min(static_cast<int>(turns * static_cast<float>(azimuth_bins_)), azimuth_bins_ - 1);
  return {up_to_.data() + static_cast<std::ptrdiff_t>((in * azimuth_bins_ + bin) * offset_bins_), mirrored};
}

float ExitOffsets::sample(float offset_in, float azimuth, float u) const {
  const auto [up_to, mirrored] = row(offset_in, azimuth);
  const auto bin = std::min<std::ptrdiff_t>(std::upper_bound(up_to, up_to + offset_bins_, u) - up_to, offset_bins_ - 1);
  const float before = bin > 0 ? up_to[bin - 1] : 0.0f, inside = (u - before) / (up_to[bin] - before);
  const float offset = 2 * (static_cast<float>(bin) + inside) / static_cast<float>(offset_bins_) - 1;
  return mirrored ? -offset : offset;
}

float ExitOffsets::density(float offset_in, float azimuth, float offset_out) const {
  const auto [up_to, mirrored] = row(offset_in, azimuth);
  if (mirrored) offset_out = -offset_out;
  if (!(std::abs(offset_out) <= 1)) return 0;
  const int bin = std::min(static_cast<int>((offset_out + 1) / 2 * static_cast<float>(offset_bins_)), offset_bins_ - 1);
  return (up_to[bin] - (bin > 0 ? up_to[bin - 1] : 0.0f)) * static_cast<float>(offset_bins_) / 2;
}

const ExitOffsets& simulated_exit_offsets() {
  static const ExitOffsets table = [] {
    const nlohmann::json document = nlohmann::json::parse(kExitOffsetsJson);
    std::vector<double> share;
    for (const nlohmann::json& row : document.at("rows")) {
      std::istringstream text(row.get<std::string>());
      for (double parts = 0; text >> parts;) share.push_back(parts);
    }
    return ExitOffsets(document.at("offset_bins").get<int>(), document.at("azimuth_bins").get<int>(), share);
  }();
  return table;
}

std::vector<LibraryThread> clear_threads(const std::vector<LibraryThread>& library) {
  std::vector<LibraryThread> clear;
  std::ranges::copy_if(library, std::back_inserter(clear), [](const LibraryThread& thread) {
    return std::ranges::all_of(thread.absorptions, [](double sigma_a) { return sigma_a == 0; });
  });
  return clear;
}

std::vector<double> mean_exits(const std::vector<LibraryThread>& threads, const ExitOptions& options) {
  std::vector<double> mean;
  int done = 0;
  const int total = static_cast<int>(threads.size() * std::size(kThetasDeg));
  for (const LibraryThread& thread : threads)
    for (const double theta_deg : kThetasDeg) {
      if (options.progress && !options.progress(done++, total))
        throw std::runtime_error("the simulations were stopped on request; start them again");
      MultiFiberOptions simulated = simulation_of(thread, 0, theta_deg * kDegree);
      simulated.rays = options.rays, simulated.configurations = options.configurations, simulated.seed = options.seed;
      simulated.bins = options.azimuth_bins, simulated.offset_bins = options.offset_bins;
      const std::vector<double> exits = simulate_multi_fiber(simulated).exits;
      mean.resize(exits.size());
      for (std::size_t i = 0; i < exits.size(); ++i) mean[i] += exits[i] / total;
    }
  return mean;
}

}  // namespace renderer
