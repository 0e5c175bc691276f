#include "tests/support/fake_devices.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace station {

std::vector<double> FakeCamera::shutter_times_s() {
  std::vector<double> times;
  for (int third = -30; third <= 15; ++third) times.push_back(std::exp2(third / 3.0));
  return times;
}

rig::CameraSettings FakeCamera::configure(const rig::CameraSettings& wanted) {
  if (!stuck_shutter) now = wanted;
  return now;
}

rig::Picture FakeCamera::capture() {
  if (++captures == fail_at_capture)
    throw std::runtime_error("the camera was asked for a picture and did not answer; switch it off and on");
  if (((late_at > 0 && captures >= late_at) || stale) && !last_.bytes.empty()) return last_;
  const double level = std::min(1.0, radiance() * now.exposure_s);
  static int pictures = 0;  // of all cameras of this process
  const std::array<double, 3> content = {level, static_cast<double>(::getpid()), static_cast<double>(++pictures)};
  last_ = {
      .bytes = std::vector<std::byte>(400), .extension = "arw", .settings = now, .utc = "2027-01-15T08:00:00.000Z"};
  if (lies) last_.settings.exposure_s *= 2;
  std::memcpy(last_.bytes.data(), content.data(), sizeof content);
  if (empty) last_.bytes.clear();
  return last_;
}

double FakeCamera::level(const rig::Picture& picture) {
  double level = 0;
  std::memcpy(&level, picture.bytes.data(), sizeof level);
  return level;
}

void FakeTurntable::move_to(double angle_rad) {
  if (!homed) throw std::runtime_error("the platform was asked to turn before it was homed");
  ++moves;
  if (on_move) on_move(angle_rad);
  angle_rad_ = angle_rad + (slips ? 0.05 : 0.0);
}

}  // namespace station
