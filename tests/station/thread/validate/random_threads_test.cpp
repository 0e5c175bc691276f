// Threads drawn at random, photographed in the 17 views and fitted as if nothing were known of them.
// THREADSTATION_THREADS in the environment says how many there are, THREADSTATION_SEED from which seed they are drawn.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <random>

#include "inversion/fit/thread_unknowns.h"
#include "station/documents/reader.h"
#include "station/thread/validate/recover_thread.h"
#include "tests/places.h"
#include "tests/support/asked.h"
#include "tests/support/temporary_folder.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using namespace inversion;  // the unknowns
using nlohmann::json;

constexpr int kSeed = 20261126, kThreads = 1;
constexpr double kMostEnergy = 0.97;  // of all lobes together, at any angle

double most_energy(const renderer::ThreadParameters& thread) {
  double most = 0;
  for (int k = 0; k <= 100; ++k) {
    const auto lambda = renderer::thread_lobe_energies<double>(thread, k / 100.0);
    most = std::max(most, lambda[0] + lambda[1] + lambda[2]);
  }
  return most;
}

renderer::ThreadParameters random_thread(std::mt19937& random) {
  const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  ThreadUnknowns u;
  for (int c = 0; c < 3; ++c) u[kSigma + c] = std::exp(between(std::log(0.03), std::log(2)));
  for (int p = 0; p < 3; ++p) u[kAlpha + p] = between(0.12, 0.5);
  u[kBeta] = between(0.35, 0.8), u[kBeta + 1] = between(0.35, 0.8), u[kBeta + 2] = between(0.12, 0.5);
  u[kL0] = between(0.3, 0.7), u[kL1] = between(0.1, 0.3), u[kConcavity] = between(0, 0.4);
  u[kR1a] = between(0.35, 0.65);
  const double r2a = between(3, 15), r2b = between(2, 6);
  u[kD2] = r2a / ((r2a + r2b) * (r2a + r2b)), u[kW2] = r2a / (r2a + r2b), u[kN2] = between(0.05, 0.2);
  if (const double share = kMostEnergy / most_energy(parameters_of(u)); share < 1)
    for (const int k : std::initializer_list<int>{kL0, kL1, kConcavity, kR1a, kD2, kN2}) u[k] *= share;
  return parameters_of(u);
}

json parameters_json(const renderer::ThreadParameters& p) {
  return {{"sigma_a", {p.sigma_a[0], p.sigma_a[1], p.sigma_a[2]}},
          {"alpha", p.alpha},
          {"beta", p.beta},
          {"r0", {p.r0a, p.r0b, p.r0c}},
          {"r1", {p.r1a}},
          {"r2", {p.r2a, p.r2b, p.r2c}}};
}

RecoverRequest request_of(const fs::path& thread) {
  return {.rig = fs::path(DATA_DIR) / "rigs/simulated.json",
          .spool = fs::path(DATA_DIR) / "spools/silk_red.json",
          .thread = thread,
          .draws = 0,
          .progress_style = ProgressStyle::quiet};
}

void expect_all_within(const RecoveredThread& found, double deviations) {
  std::printf("%s", describe(found).c_str());
  std::fflush(stdout);
  for (const RecoveredQuantity& of : found.quantities)
    EXPECT_LE(std::abs(of.fitted - of.truth), deviations * of.sigma) << of.name << " of " << found.thread;
}

TEST(RandomThreads, AreFoundWithinFourOfTheirDeviations) {
  const int threads = asked("THREADSTATION_THREADS", kThreads), seed = asked("THREADSTATION_SEED", kSeed);
  ASSERT_GT(threads, 0);
  std::printf("seed %d\n", seed);
  std::mt19937 random(static_cast<std::uint32_t>(seed));
  const TemporaryFolder folder;
  json file = read_json_file(fs::path(DATA_DIR) / "threads/silk_blue.json");
  for (int i = 1; i <= threads; ++i) {
    file["name"] = "random thread " + std::to_string(i);
    file["parameters"] = parameters_json(random_thread(random));
    write_json_file(folder / "thread.json", file);
    RecoverRequest request = request_of(folder / "thread.json");
    request.samples_per_pixel = 256;
    request.fit.seed = static_cast<std::uint64_t>(i);
    expect_all_within(recover_thread(request), 4);
  }
}

// R and TRT of white cotton look nearly alike from everywhere, and a fit may take each for the other.
TEST(WhiteCotton, KeepsItsHighlightsApart) {
  RecoverRequest request = request_of(fs::path(DATA_DIR) / "threads/cotton_white.json");
  request.samples_per_pixel = 64;
  expect_all_within(recover_thread(request), 4);
}

}  // namespace
}  // namespace station
