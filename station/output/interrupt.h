// Ctrl-C, SIGTERM and SIGHUP (a closed terminal, a lost connection): long work asks between its steps whether they
// came, and a moving platform is stopped by them. "Ctrl-C" stands for all three here.
#pragma once

#include <functional>
#include <memory>

namespace station {

// From now on the first `watched` ctrl-C are only counted; the next one ends the program as usual.
void watch_interrupts(int watched = 1);
// At least the first `watched` ctrl-C are only counted; those that came before still count.
void watch_more_interrupts(int watched);
// From now on ctrl-C ends the program at once, until one of the two above is called again: for long work that loses
// nothing by it and does not ask.
void let_interrupts_end();
int interrupts();  // how many came since then
bool interrupted();

// While it lives, the first ctrl-C calls `stop` at once from a thread of its own, whatever the rest of the
// program is doing or waiting for, and the second one `stop_now`. The last of the two that is given is called again
// every 50 ms: a move that was begun at the very moment is stopped as well. Needs watch_interrupts() before. What they
// throw is dropped: they are called where nobody waits for it.
class StopOnInterrupt {
 public:
  explicit StopOnInterrupt(std::function<void()> stop, std::function<void()> stop_now = {});
  ~StopOnInterrupt();
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;

 private:
  struct Watch;
  std::unique_ptr<Watch> watch_;
};

}  // namespace station
