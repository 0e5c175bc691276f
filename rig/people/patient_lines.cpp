#include "rig/people/patient_lines.h"

#include <chrono>
#include <condition_variable>
#include <istream>
#include <mutex>
#include <thread>

namespace rig {

struct PatientLines::Coming {
  std::mutex mutex;
  std::condition_variable came;
  bool done = false;
  std::optional<std::string> line;
};

namespace {

std::optional<std::string> line_of(std::istream& in) {
  std::string line;
  if (!std::getline(in, line)) return std::nullopt;
  return line;
}

}  // namespace

PatientLines::Said PatientLines::next(const std::function<std::optional<std::string>()>& meanwhile) {
  constexpr auto kBetween = std::chrono::milliseconds(100);
  if (!meanwhile && !coming_) return {line_of(in_), std::nullopt};
  if (!coming_) {
    coming_ = std::make_shared<Coming>();
    std::thread([&in = in_, coming = coming_] {
      std::optional<std::string> line = line_of(in);
      const std::scoped_lock lock(coming->mutex);
      coming->line = std::move(line);
      coming->done = true;
      coming->came.notify_all();
    }).detach();
  }
  for (;;) {
    {
      std::unique_lock lock(coming_->mutex);
      const auto done = [&] { return coming_->done; };
      if (meanwhile)
        coming_->came.wait_for(lock, kBetween, done);
      else
        coming_->came.wait(lock, done);
      if (coming_->done) break;
    }
    if (auto other = meanwhile()) return {std::nullopt, std::move(other)};
  }
  const Said said{coming_->line, std::nullopt};
  coming_.reset();
  return said;
}

}  // namespace rig
