#include "rig/simulated/pty_server.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <utility>

namespace rig {
namespace {

constexpr int kFirmwareEveryMs = 2;  // how often, in real time, the server looks for what the firmware says by itself

class ServerThread final : public PtyServer {
 public:
  explicit ServerThread(std::shared_ptr<SimulatedPort> port)
      : port_(std::move(port)), master_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK)) {
    std::array<char, 128> name{};
    if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
        ptsname_r(master_, name.data(), name.size()) != 0) {
      const std::string why = std::strerror(errno);
      if (master_ >= 0) ::close(master_);
      throw std::runtime_error("a pseudo-terminal was needed for the simulated turntable and there is none (" + why +
                               "); check that /dev/pts is mounted");
    }
    path_ = name.data();
    make_raw();
    thread_ = std::jthread([this](const std::stop_token& ending) { serve(ending); });
  }

  std::string path() const override { return path_; }

 private:
  // Switches the terminal's echo off before any program opens it. Opening and closing it once also makes it visible
  // from this side (POLLHUP) that nobody has it open.
  void make_raw() const {
    const int slave = ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios settings{};
    if (slave >= 0 && tcgetattr(slave, &settings) == 0) {
      cfmakeraw(&settings);
      tcsetattr(slave, TCSANOW, &settings);
    }
    if (slave >= 0) ::close(slave);
  }

  void serve(const std::stop_token& ending) {
    bool open = false;
    while (!ending.stop_requested() && port_->plugged()) {
      pollfd watched{.fd = master_, .events = POLLIN, .revents = 0};
      ::poll(&watched, 1, kFirmwareEveryMs);
      const bool hung_up = (watched.revents & POLLHUP) != 0;
      // What a program wrote just before it ended is still to be heard: its last stop, for example.
      if (hung_up && (watched.revents & POLLIN) == 0) {
        open = false;
        port_->transmit();  // the firmware lives on, and nobody hears what it says
        std::this_thread::sleep_for(std::chrono::milliseconds(kFirmwareEveryMs));
        continue;
      }
      if (!std::exchange(open, true)) port_->opened();
      std::array<char, 4096> bytes{};
      if (const ssize_t got = ::read(master_, bytes.data(), bytes.size()); got > 0)
        port_->receive({bytes.data(), static_cast<std::size_t>(got)});
      if (const std::string said = port_->transmit(); !hung_up) say(said);
    }
    ::close(master_);
  }

  // Writes bytes to the terminal; what does not fit because nobody reads it is lost, as on a wire.
  void say(const std::string& bytes) const {
    if (!bytes.empty()) [[maybe_unused]]
      const ssize_t written = ::write(master_, bytes.data(), bytes.size());
  }

  std::shared_ptr<SimulatedPort> port_;
  int master_;
  std::string path_;
  std::jthread thread_;  // the last member, so that the thread ends before what it uses is destroyed
};

}  // namespace

std::unique_ptr<PtyServer> serve_on_pty(std::shared_ptr<SimulatedPort> port) {
  return std::make_unique<ServerThread>(std::move(port));
}

}  // namespace rig
