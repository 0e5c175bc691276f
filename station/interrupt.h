// Ctrl-C and SIGTERM as a question that long work asks between steps.
#pragma once

#include <functional>
#include <memory>

namespace station {

void watch_interrupts();  // from now on a first ctrl-C only sets the flag; a second one ends the program as usual
bool interrupted();

// While it lives, the first ctrl-C or SIGTERM calls `stop` at once from a thread of its own, whatever the rest of the
// program is doing or waiting for, and again every 50 ms: a move that was begun at the very moment is stopped as well.
// Needs watch_interrupts() before. What `stop` throws is dropped: it is called where nobody waits for it.
class StopOnInterrupt {
 public:
  explicit StopOnInterrupt(std::function<void()> stop);
  ~StopOnInterrupt();
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;

 private:
  struct Watch;
  std::unique_ptr<Watch> watch_;
};

}  // namespace station
