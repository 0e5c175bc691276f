// Drawings of the simulated bench, of which calibrations and captures on it consist: camera rays per second of
// processor time. `mean` and `noise` (root mean square of the difference between two drawings, over the mean and
// sqrt 2) are of red, green and blue together.
#include <benchmark/benchmark.h>

#include <cmath>

#include "station/bench/bench_picture.h"
#include "station/bench/calibrate/calibration_plan.h"
#include "station/bench/mounted_holder.h"
#include "station/documents/spool.h"

namespace station {
namespace {

constexpr int kSamples = 4;

RigFile rig_to_draw() {
  RigFile rig = read_rig(std::string(DATA_DIR) + "/rigs/simulated.json");
  rig.simulation->samples_per_pixel = rig.simulation->target_samples_per_pixel = kSamples;
  return rig;
}

// The first step of a calibration with this object.
rig::Arrangement arrangement_of(const RigFile& rig, rig::BenchObject object) {
  for (const CalibrationStep& step : make_calibration_plan(rig))
    if (step.arrangement.object == object) return step.arrangement;
  throw std::logic_error("no step of the calibration has such an object");
}

void drawing(benchmark::State& state, const rig::Arrangement& arrangement) {
  const RigFile rig = rig_to_draw();
  rig::SimulatedBench bench(rig.simulation->truth,
                            make_bench_picture(rig, read_spool(std::string(DATA_DIR) + "/spools/silk_red.json")));
  bench.place(arrangement);
  const cv::Mat3f one = bench.draw(), other = bench.draw();
  for (auto _ : state) benchmark::DoNotOptimize(bench.draw());
  state.SetItemsProcessed(state.iterations() * kSamples * static_cast<std::int64_t>(one.total()));
  const cv::Scalar sum = cv::sum(one);
  const double values = 3 * static_cast<double>(one.total()), mean = (sum[0] + sum[1] + sum[2]) / values;
  state.counters["mean"] = mean;
  state.counters["noise"] = cv::norm(one, other) / std::sqrt(2 * values) / mean;
}

rig::Arrangement holder(rig::Lamp lamp) {
  const RigFile rig = rig_to_draw();
  const Spool spool = read_spool(std::string(DATA_DIR) + "/spools/silk_red.json");
  return {.object = rig::BenchObject::holder,
          .on_platform = true,
          .pose = nominal_holder_pose(rig, spool.wrapping, rig::Mounting::horizontal),
          .lamp = lamp};
}

#define DRAWING(name, arrangement) \
  BENCHMARK_CAPTURE(drawing, name, arrangement)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()
DRAWING(board, arrangement_of(rig_to_draw(), rig::BenchObject::board));
DRAWING(spectralon, arrangement_of(rig_to_draw(), rig::BenchObject::spectralon));
DRAWING(spool_in_front, holder(rig::Lamp::front));
DRAWING(spool_from_behind, holder(rig::Lamp::back));

}  // namespace
}  // namespace station
