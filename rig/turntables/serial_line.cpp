#include "rig/turntables/serial_line.h"

#include <fcntl.h>
#include <libserialport.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <mutex>

#include "rig/devices/detect.h"

namespace rig {
namespace {

constexpr int kMostEarlyReturns = 3;  // so many waits that end at once with nothing to read mean that the line is gone

std::string system_words() {
  return std::strerror(errno);
}

// The device file that a name stands for, because libserialport knows no links: those below /dev/serial among them.
// A name that is none stays as it is.
std::string device_behind(const std::string& name) {
  std::error_code error;
  if (!std::filesystem::is_symlink(name, error)) return name;
  const std::string device = std::filesystem::canonical(name, error).string();
  if (!error) return device;
  throw std::runtime_error("the port " + name + " is a link to " + std::filesystem::read_symlink(name).string() +
                           ", which is not there; plug the turntable in and switch it on (\"threadstation devices\" "
                           "lists what is there)");
}

std::string named_port(const SerialPortChoice& choice) {
  if (choice.usb_serial.empty()) return choice.port;
  for (const FoundDevice& found : find_serial_ports())
    if (found.serial == choice.usb_serial) return found.port;
  throw std::runtime_error("the turntable's USB adapter with serial number " + choice.usb_serial +
                           " is not plugged in; plug it in and switch the turntable on (\"threadstation devices\" "
                           "lists what is there)");
}

std::string why_not_open(const std::string& port) {
  switch (errno) {
    case EACCES:
    case EPERM:
      return "the port " + port + " may not be opened by this user; add the user to the group dialout and log in again";
    case EBUSY:
      return "the port " + port + " is used by another program; close that one";
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return "there is no port " + port +
             "; plug the turntable in and switch it on (\"threadstation devices\" lists what is there)";
    default:
      return "the port " + port + " could not be opened (" + system_words() +
             "); unplug the turntable, plug it in again and retry";
  }
}

// The lock keeps a second threadstation out; the exclusive mode keeps out every other program.
void take_for_this_program_alone(int descriptor, const std::string& port) {
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 || ioctl(descriptor, TIOCEXCL) != 0) {
    errno = errno == EWOULDBLOCK ? EBUSY : errno;
    throw std::runtime_error(why_not_open(port));
  }
}

std::string unplugged_words(const std::string& port) {
  return "the turntable on " + port +
         " was unplugged or switched off; plug it in, put its mark to the front and home it again";
}

class SerialLine final : public ByteLine {
 public:
  explicit SerialLine(const SerialPortChoice& choice) : name_(named_port(choice)) {
    const std::string device = device_behind(name_);
    if (device != name_) name_ += " (" + device + ")";
    if (sp_get_port_by_name(device.c_str(), &port_) != SP_OK) {
      errno = ENOENT;
      throw std::runtime_error(why_not_open(name_));
    }
    if (sp_open(port_, SP_MODE_READ_WRITE) != SP_OK) {
      const std::string why = why_not_open(name_);
      sp_free_port(port_);
      throw std::runtime_error(why);
    }
    try {
      configure(choice.baud);
    } catch (...) {
      close();
      throw;
    }
  }
  ~SerialLine() override { close(); }
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;

  // On a line that was hung up libserialport's reads look like time-outs; only asking for the number of bytes fails.
  std::string read(double timeout_s) override {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
    for (int early = 0;;) {
      const double left_s = std::chrono::duration<double>(deadline - std::chrono::steady_clock::now()).count();
      if (const std::string bytes = waiting_bytes(); !bytes.empty() || left_s <= 0) return bytes;
      const auto began = std::chrono::steady_clock::now();
      // After a signal libserialport waits for what is left in whole milliseconds: of one that would be none at all.
      if (sp_wait(events_, static_cast<unsigned>(std::ceil(left_s * 1e3)) + 1) != SP_OK)
        throw Unplugged(unplugged_words(name_));
      const auto waited = std::chrono::steady_clock::now() - began;
      early = waited < std::chrono::microseconds(100) && waiting() == 0 ? early + 1 : 0;
      if (early >= kMostEarlyReturns) throw Unplugged(unplugged_words(name_));
    }
  }

  // One system call, so that the lines of two threads never mix. The lock is needed because a terminal refuses a
  // non-blocking write while another thread (one that stops, for example) is writing.
  void write(std::string_view bytes) override {
    const std::lock_guard one_at_a_time(writing_);
    int written = -1;
    do written = sp_nonblocking_write(port_, bytes.data(), bytes.size());
    while (written < 0 && errno == EINTR);  // a signal, before anything was written
    if (written < 0) throw Unplugged(unplugged_words(name_));
    if (static_cast<std::size_t>(written) != bytes.size()) {
      throw std::runtime_error("the turntable on " + name_ +
                               " takes no more commands; switch it off and on, then home it again");
    }
  }

 private:
  void configure(int baud) {
    int descriptor = -1;
    const bool done = sp_get_port_handle(port_, &descriptor) == SP_OK && sp_set_baudrate(port_, baud) == SP_OK &&
                      sp_set_bits(port_, 8) == SP_OK && sp_set_parity(port_, SP_PARITY_NONE) == SP_OK &&
                      sp_set_stopbits(port_, 1) == SP_OK && sp_set_flowcontrol(port_, SP_FLOWCONTROL_NONE) == SP_OK;
    if (!done) {
      throw std::runtime_error("the port " + name_ + " refused " + std::to_string(baud) +
                               " baud; check \"baud\" in the rig file");
    }
    fcntl(descriptor, F_SETFD, FD_CLOEXEC);  // a child process must not keep the port open
    take_for_this_program_alone(descriptor, name_);
    if (sp_new_event_set(&events_) != SP_OK ||
        sp_add_port_events(events_, port_, static_cast<sp_event>(SP_EVENT_RX_READY | SP_EVENT_ERROR)) != SP_OK)
      throw std::runtime_error("the port " + name_ + " cannot be waited for; unplug it, plug it in and retry");
  }

  int waiting() const { return sp_input_waiting(port_); }

  std::string waiting_bytes() {
    const int count = waiting();
    if (count < 0) throw Unplugged(unplugged_words(name_));
    std::string bytes(static_cast<std::size_t>(count), '\0');
    if (count > 0) {
      const int got = sp_nonblocking_read(port_, bytes.data(), bytes.size());
      if (got < 0 && errno == EINTR) return {};
      if (got < 0) throw Unplugged(unplugged_words(name_));
      bytes.resize(static_cast<std::size_t>(got));
    }
    return bytes;
  }

  void close() {
    if (events_ != nullptr) sp_free_event_set(events_);
    sp_close(port_);
    sp_free_port(port_);
  }

  std::string name_;  // in messages: as the rig file names it, and the device behind a link
  sp_port* port_ = nullptr;
  sp_event_set* events_ = nullptr;
  std::mutex writing_;
};

}  // namespace

std::unique_ptr<ByteLine> open_serial_line(const SerialPortChoice& choice) {
  sp_set_debug_handler(nullptr);
  return std::make_unique<SerialLine>(choice);
}

}  // namespace rig
