#include "station/output/interrupt.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <thread>
#include <utility>

namespace station {
namespace {

constexpr int kStopAgainMs = 50;

std::atomic<int> interrupts_seen{0};  // a signal handler can reach nothing else
std::atomic<int> interrupts_watched{1};
std::atomic<bool> watching{false};

// Becomes readable with the first signal, for threads that wait for it.
std::atomic<int> interrupt_event{-1};

void signal_event(int event) {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(event, &one, sizeof one);  // safe in a signal handler
}

void on_signal(int signal) {
  if (interrupts_seen.fetch_add(1) >= interrupts_watched) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
  if (interrupt_event >= 0) signal_event(interrupt_event);
}

}  // namespace

void watch_interrupts(int watched) {
  interrupts_seen = 0;
  interrupts_watched = watched;
  watching = true;
  if (interrupt_event < 0) interrupt_event = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t drained = read(interrupt_event, &count, sizeof count);  // of a run before
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (signal == SIGHUP && before.sa_handler == SIG_IGN) continue;  // nohup: the run is to outlive its terminal
    sigaction(signal, &action, nullptr);
  }
}

void watch_more_interrupts(int watched) {
  if (!watching) watch_interrupts(watched);
  interrupts_watched = std::max(interrupts_watched.load(), watched);
}

void let_interrupts_end() {
  watching = false;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction now {};
    sigaction(signal, nullptr, &now);
    if (now.sa_handler == on_signal) std::signal(signal, SIG_DFL);
  }
}

int interrupts() {
  return interrupts_seen;
}

bool interrupted() {
  return interrupts() > 0;
}

struct StopOnInterrupt::Watch {
  Watch(std::function<void()> first, std::function<void()> second)
      : actions{std::move(first), std::move(second)}, over(eventfd(0, EFD_CLOEXEC)), thread([this] { wait(); }) {}
  ~Watch() {
    signal_event(over);
    thread.join();
    close(over);
  }

  // The last action goes on until it is over: a move that was begun at the very moment is stopped as well.
  void wait() const {
    const int last = actions[1] ? 1 : 0;
    for (int done = 0; done <= last;) {
      std::array<pollfd, 2> watched{pollfd{interrupt_event, POLLIN, 0}, pollfd{over, POLLIN, 0}};
      if (interrupts() <= done) {
        // Not for ever: another watch may have taken the event between the look above and this one.
        while (poll(watched.data(), watched.size(), kStopAgainMs) < 0) {
        }
        if (watched[1].revents != 0 && interrupts() <= done) return;
        std::uint64_t count = 0;
        [[maybe_unused]] const ssize_t drained = read(interrupt_event, &count, sizeof count);
      }
      while (done <= last && done < interrupts()) act(actions.at(static_cast<std::size_t>(done++)));
    }
    pollfd ended{over, POLLIN, 0};
    while (poll(&ended, 1, kStopAgainMs) <= 0) act(actions.at(static_cast<std::size_t>(last)));
  }

  static void act(const std::function<void()>& action) {
    try {
      action();
    } catch (...) {
    }
  }

  std::array<std::function<void()>, 2> actions;
  int over;
  std::thread thread;
};

StopOnInterrupt::StopOnInterrupt(std::function<void()> stop, std::function<void()> stop_now)
    : watch_(std::make_unique<Watch>(std::move(stop), std::move(stop_now))) {}

StopOnInterrupt::~StopOnInterrupt() = default;

}  // namespace station
