#include "station/cloth/render/started_ranks.h"

#include <cstdlib>
#include <initializer_list>
#include <stdexcept>
#include <string>

namespace station {
namespace {

int number_in(const char* name) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : 0;
}

}  // namespace

bool started_with_others() {
  if (number_in("OMPI_COMM_WORLD_SIZE") > 1 || number_in("PMI_SIZE") > 1) return true;  // mpirun of OpenMPI, of MPICH
  const int tasks = number_in("SLURM_STEP_NUM_TASKS");
  if (tasks <= 1) return false;
  for (const char* name : {"PMIX_RANK", "PMI_RANK", "PMI_FD"})
    if (std::getenv(name)) return true;
  throw std::runtime_error("srun started " + std::to_string(tasks) +
                           " processes that cannot talk to each other; give it --mpi=pmix");
}

}  // namespace station
