#include "station/interrupt.h"

#include <atomic>
#include <csignal>

namespace station {
namespace {

std::atomic<bool> interrupt_seen{false};  // a signal handler can reach nothing else

void on_signal(int signal) {
  if (interrupt_seen.exchange(true)) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

}  // namespace

void watch_interrupts() {
  interrupt_seen = false;
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
  return interrupt_seen;
}

}  // namespace station
