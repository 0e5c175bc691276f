#include "station/interrupt.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <thread>
#include <utility>

namespace station {
namespace {

constexpr int kStopAgainMs = 50;

std::atomic<bool> interrupt_seen{false};  // a signal handler can reach nothing else

// Becomes readable with the first signal, for threads that wait for it.
std::atomic<int> interrupt_event{-1};

void signal_event(int event) {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(event, &one, sizeof one);  // safe in a signal handler
}

void on_signal(int signal) {
  if (interrupt_seen.exchange(true)) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
  if (interrupt_event >= 0) {
    signal_event(interrupt_event);
  }
}

}  // namespace

void watch_interrupts() {
  interrupt_seen = false;
  if (interrupt_event < 0) {
    interrupt_event = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  }
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t drained = read(interrupt_event, &count, sizeof count);  // of a run before
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
  return interrupt_seen;
}

struct StopOnInterrupt::Watch {
  explicit Watch(std::function<void()> action)
      : stop(std::move(action)), over(eventfd(0, EFD_CLOEXEC)), thread([this] { wait(); }) {}
  ~Watch() {
    signal_event(over);
    thread.join();
    close(over);
  }

  void wait() const {
    std::array<pollfd, 2> watched{pollfd{interrupt_event, POLLIN, 0}, pollfd{over, POLLIN, 0}};
    while (poll(watched.data(), watched.size(), -1) < 0) {
    }
    while (watched[1].revents == 0) {
      try {
        stop();
      } catch (...) {
      }
      poll(&watched[1], 1, kStopAgainMs);
    }
  }

  std::function<void()> stop;
  int over;
  std::thread thread;
};

StopOnInterrupt::StopOnInterrupt(std::function<void()> stop) : watch_(std::make_unique<Watch>(std::move(stop))) {}

StopOnInterrupt::~StopOnInterrupt() = default;

}  // namespace station
