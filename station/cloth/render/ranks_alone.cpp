// Of a build without MPI.
#include <stdexcept>

#include "station/cloth/render/ranks.h"
#include "station/cloth/render/started_ranks.h"

namespace station {

struct RenderRanks::Others {};

RenderRanks::RenderRanks() = default;
RenderRanks::RenderRanks(std::unique_ptr<Others> others) : others_(std::move(others)) {}

RenderRanks RenderRanks::started() {
  if (!started_with_others()) return RenderRanks();
  throw std::runtime_error(
      "mpirun or srun started several processes, and this threadstation was built without MPI; install libopenmpi-dev "
      "and build again, or start one process alone");
}

RenderRanks::~RenderRanks() = default;

int RenderRanks::threads(int asked) const {
  return asked;
}

bool RenderRanks::of_first(bool said) {
  return said;
}

void RenderRanks::of_first(renderer::Film&) {}
void RenderRanks::must_agree(const std::string&, const std::string&) {}

renderer::PassEnd RenderRanks::end_pass(renderer::Film& film, int most_samples, double noise,
                                        const std::function<bool()>&) {
  using enum renderer::PassEnd;
  return renderer::raise_goals(film, most_samples, noise) ? next : finished;
}

double RenderRanks::tell(double finished) {
  return finished;
}

void RenderRanks::wait_for_parts() {}

renderer::RenderStatistics RenderRanks::sum_of(const renderer::RenderStatistics& mine) {
  return mine;
}

}  // namespace station
