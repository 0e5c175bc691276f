#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>

#include "rig/turntables/serial_line.h"

namespace rig {
namespace {

class PtyLine final : public ByteLine {
 public:
  explicit PtyLine(std::string path)
      : path_(std::move(path)), descriptor_(::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    const bool opened = descriptor_ >= 0;
    if (!opened || flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const std::string why = opened ? "is used by another program; close that one"
                                     : std::string("could not be opened (") + std::strerror(errno) +
                                           "); start the program behind it and use the port that it prints "
                                           "(\"threadstation simulate-hardware\" is one with a simulated turntable)";
      if (opened) ::close(descriptor_);
      throw std::runtime_error("the pseudo-terminal " + path_ + " " + why);
    }
    termios settings{};
    if (tcgetattr(descriptor_, &settings) == 0) {
      cfmakeraw(&settings);
      tcsetattr(descriptor_, TCSANOW, &settings);
    }
  }
  ~PtyLine() override { ::close(descriptor_); }
  PtyLine(const PtyLine&) = delete;
  PtyLine& operator=(const PtyLine&) = delete;

  std::string read(double timeout_s) override {
    if (!wait(timeout_s)) return {};
    std::array<char, 4096> bytes{};
    const ssize_t got = ::read(descriptor_, bytes.data(), bytes.size());
    if (got > 0) return {bytes.data(), static_cast<std::size_t>(got)};
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return {};
    throw Unplugged(unplugged());
  }

  // The lock is needed because a terminal refuses a non-blocking write while another thread is writing.
  void write(std::string_view bytes) override {
    const std::lock_guard one_at_a_time(writing_);
    ssize_t written = -1;
    do written = ::write(descriptor_, bytes.data(), bytes.size());
    while (written < 0 && errno == EINTR);  // a signal, before anything was written
    if (written < 0 && errno != EAGAIN) throw Unplugged(unplugged());
    if (written != static_cast<ssize_t>(bytes.size())) {
      throw std::runtime_error("the turntable on the pseudo-terminal " + path_ +
                               " takes no more commands; start the program behind it again, then home it");
    }
  }

 private:
  // A signal does not end the wait, because an empty read must mean that the whole time has passed.
  bool wait(double timeout_s) const {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
    for (;;) {
      const double left_s = std::chrono::duration<double>(deadline - std::chrono::steady_clock::now()).count();
      pollfd watched{.fd = descriptor_, .events = POLLIN, .revents = 0};
      const int ready = ::poll(&watched, 1, std::max(0, static_cast<int>(std::ceil(left_s * 1e3))));
      if (ready >= 0 || errno != EINTR) return ready > 0;
    }
  }

  std::string unplugged() const {
    return "the turntable on the pseudo-terminal " + path_ +
           " was unplugged or switched off; start the program behind it again, put its mark to the front and home it";
  }

  std::string path_;
  int descriptor_;
  std::mutex writing_;
};

}  // namespace

std::unique_ptr<ByteLine> open_pty_line(const std::string& path) {
  return std::make_unique<PtyLine>(path);
}

}  // namespace rig
