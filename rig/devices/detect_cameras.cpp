#include <fcntl.h>
#include <gphoto2/gphoto2.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <stdexcept>

#include "rig/devices/detect.h"

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace rig {
namespace {

// libgphoto2 prints what it tries on standard error, which belongs to this program's own lines.
class SilentStandardError {
 public:
  SilentStandardError() : saved_(dup(STDERR_FILENO)) {
    std::fflush(stderr);
    if (const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC); nowhere >= 0) {
      dup2(nowhere, STDERR_FILENO);
      close(nowhere);
    }
  }
  ~SilentStandardError() {
    if (saved_ >= 0) {
      std::fflush(stderr);
      dup2(saved_, STDERR_FILENO);
      close(saved_);
    }
  }
  SilentStandardError(const SilentStandardError&) = delete;
  SilentStandardError& operator=(const SilentStandardError&) = delete;

 private:
  int saved_;
};

// libgphoto2 2.5.30 loads and unloads its drivers, and some of them leave memory behind each time (about 70 kB): not
// this program's leak, so the leak checker does not count it.
struct DriversLeaksForgiven {
#ifdef __SANITIZE_ADDRESS__
  __lsan::ScopedDisabler disabler;
#endif
  DriversLeaksForgiven() {}
};

void check(int status) {
  if (status < GP_OK) {
    throw std::runtime_error(std::string("the computer was asked for its cameras, and libgphoto2 answered \"") +
                             gp_result_as_string(status) + "\"; check that libgphoto2-6 is installed completely");
  }
}

}  // namespace

std::vector<FoundDevice> find_cameras() {
  const SilentStandardError silent;
  const DriversLeaksForgiven forgiven;
  CameraList* list = nullptr;
  check(gp_list_new(&list));
  const std::unique_ptr<CameraList, int (*)(CameraList*)> owner(list, gp_list_free);
  const std::unique_ptr<GPContext, void (*)(GPContext*)> context(gp_context_new(), gp_context_unref);
  check(gp_camera_autodetect(list, context.get()));
  std::vector<FoundDevice> found;
  for (int i = 0; i < gp_list_count(list); ++i) {
    const char *model = nullptr, *port = nullptr;
    check(gp_list_get_name(list, i, &model));
    check(gp_list_get_value(list, i, &port));
    found.push_back({.kind = "camera",
                     .name = model,
                     .port = port,
                     .usb_id = "",
                     .serial = "",
                     .believed_to_be = "a camera that can be driven over USB"});
  }
  return found;
}

}  // namespace rig
