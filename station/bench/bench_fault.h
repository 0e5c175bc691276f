// Faults of the bench: what its turntable and its camera refuse, or no longer answer. They concern every spool, where a
// picture that does not serve, a wrong spool file or a person who declines concern one.
#pragma once

#include <memory>
#include <stdexcept>

#include "rig/devices/camera.h"
#include "rig/devices/turntable.h"
#include "rig/people/asked_person.h"

namespace station {

class BenchFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Calls `work` and throws what it throws as a BenchFault with the same message. Only rig::Declined, a person who
// declines, is passed on unchanged.
template <typename Work>
auto on_bench(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const BenchFault&) {
    throw;
  } catch (const rig::Declined&) {
    throw;
  } catch (const std::exception& error) {
    throw BenchFault(error.what());
  }
}

// A device that passes every call on and throws BenchFault where this one throws.
std::unique_ptr<rig::Camera> throwing_bench_faults(std::unique_ptr<rig::Camera> camera);
std::unique_ptr<rig::Turntable> throwing_bench_faults(std::unique_ptr<rig::Turntable> turntable);

}  // namespace station
