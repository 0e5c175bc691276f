// Lets libserialport open a pseudo-terminal in this test program: it asks the system for two things that only real
// ports have, an entry below /sys/class/tty and modem lines. Both are answered here for pseudo-terminals alone.
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

namespace {

bool is_pty_entry(const char* path) {
  return std::string_view(path).starts_with("/sys/class/tty/pts/");
}

}  // namespace

extern "C" {

// Debian 12's libserialport asks for this older name of lstat.
int __lxstat(int, const char* path, struct stat* status) {
  if (is_pty_entry(path)) {
    std::memset(status, 0, sizeof *status);
    status->st_mode = S_IFLNK | 0777;
    return 0;
  }
  return lstat(path, status);
}

ssize_t readlink(const char* path, char* target, std::size_t size) {
  if (is_pty_entry(path)) {
    const std::string_view answer = "../../devices/virtual/tty/pts";
    const std::size_t count = std::min(size, answer.size());
    std::memcpy(target, answer.data(), count);
    return static_cast<ssize_t>(count);
  }
  return syscall(SYS_readlink, path, target, size);
}

int ioctl(int descriptor, unsigned long request, ...) {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  const long status = syscall(SYS_ioctl, descriptor, request, argument);
  const bool modem_lines = request == TIOCMGET || request == TIOCMBIS || request == TIOCMBIC || request == TIOCMSET;
  if (status < 0 && errno == ENOTTY && modem_lines) {
    if (request == TIOCMGET) *static_cast<int*>(argument) = 0;
    return 0;
  }
  return static_cast<int>(status);
}

}  // extern "C"
