// How long a library of 10,000 threads takes to find some of them: by words, by colour, by number, and all.
//
// The library is made once, in a temporary folder, of threads whose colours, sizes and names are drawn at random; each
// is added as a file of its own, which takes minutes.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <memory>
#include <random>

#include "station/documents/reader.h"
#include "station/documents/thread_file.h"
#include "station/thread/library.h"

namespace {

namespace fs = std::filesystem;

struct LargeLibrary {
  static constexpr int kThreads = 10000;

  LargeLibrary() {
    std::mt19937 random(1);
    std::uniform_real_distribution<> any(0, 1);
    station::Library library(folder / "library", true);
    station::ThreadFile thread = station::read_thread(fs::path(DATA_DIR) / "threads" / "silk_red.json");
    for (int i = 0; i < kThreads; ++i) {
      thread.name = (i % 7 == 0 ? "linen " : "cotton ") + std::to_string(i);
      for (double& sigma : thread.parameters.sigma_a) sigma = 3 * any(random) * any(random);
      thread.parameters.alpha[0] = 0.1 + 0.3 * any(random);
      thread.diameter_mm = 0.1 + any(random);
      station::write_json_file(folder / "thread.json", to_json(thread));
      library.add(folder / "thread.json", "2026-11-30T00:00:00.000Z");
    }
  }
  ~LargeLibrary() { fs::remove_all(folder); }

  fs::path folder = fs::temp_directory_path() / "threadstation-bench-library";
};

const fs::path& large_library() {
  static const LargeLibrary library;
  static const fs::path place = library.folder / "library";
  return place;
}

void search(benchmark::State& state, const station::LibraryQuery& query) {
  const station::Library library(large_library(), false);
  std::size_t found = 0;
  for (auto _ : state) found = library.find(query).size();
  state.counters["found"] = static_cast<double>(found);
}

void by_words(benchmark::State& state) {
  search(state, {.words = "linen 77"});
}
void by_colour(benchmark::State& state) {
  search(state, {.near_lab = Eigen::Vector3d(75, 10, 10), .within = 10, .most = 50});
}
void by_numbers(benchmark::State& state) {
  search(state, {.diameter_mm = std::array{0.30, 0.32}, .highlight_rad = std::array{0.1, 0.2}});
}
void by_all_of_them(benchmark::State& state) {
  search(state, {.words = "linen",
                 .near_lab = Eigen::Vector3d(75, 10, 10),
                 .within = 20,
                 .diameter_mm = std::array{0.2, 0.8},
                 .most = 50});
}
void everything(benchmark::State& state) {
  search(state, {});
}
void opened_and_by_words(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(station::Library(large_library(), false).find({.words = "linen 77"}));
}

BENCHMARK(by_words)->Unit(benchmark::kMillisecond);
BENCHMARK(by_colour)->Unit(benchmark::kMillisecond);
BENCHMARK(by_numbers)->Unit(benchmark::kMillisecond);
BENCHMARK(by_all_of_them)->Unit(benchmark::kMillisecond);
BENCHMARK(everything)->Unit(benchmark::kMillisecond);
BENCHMARK(opened_and_by_words)->Unit(benchmark::kMillisecond);

}  // namespace
