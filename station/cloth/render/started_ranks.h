// Whether mpirun or srun started this process together with others, as their environment variables tell.
#pragma once

namespace station {

// Errors: std::runtime_error, one line, where srun started several without a way to talk to each other.
bool started_with_others();

}  // namespace station
