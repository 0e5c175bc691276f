#include "rig/simulated/body_parts.h"

#include <algorithm>

namespace rig {
namespace {

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

constexpr std::array kPlaces{kShutterTimes.size(), kIsoSpeeds.size(), kFNumbersTimes100.size()};

}  // namespace

BodyParts::~BodyParts() {
  if (exposing_.valid()) exposing_.wait();
}

BodyCondition BodyParts::condition() const {
  const std::lock_guard hold(mutex_);
  return condition_;
}

void BodyParts::set_condition(const BodyCondition& condition) {
  const std::lock_guard hold(mutex_);
  condition_ = condition;
}

void BodyParts::set_focus_mode(int mode) {
  const std::lock_guard hold(mutex_);
  condition_.focus_mode = mode;
}

bool BodyParts::has(std::uint16_t property) const {
  const std::lock_guard hold(mutex_);
  return !condition_.missing.contains(property);
}

std::uint16_t BodyParts::f_number_times_100() const {
  return condition().no_aperture_choices ? std::uint16_t{0} : kFNumbersTimes100.at(dial(Dial::f_number));
}

std::vector<std::uint16_t> BodyParts::f_numbers_times_100() const {
  if (condition().no_aperture_choices) return {};
  return {kFNumbersTimes100.begin(), kFNumbersTimes100.end()};
}

std::size_t BodyParts::dial(Dial dial) const {
  const std::lock_guard hold(mutex_);
  return dials_.at(static_cast<std::size_t>(dial));
}

void BodyParts::turn_to(Dial dial, std::size_t place) {
  const std::lock_guard hold(mutex_);
  const std::array locked{condition_.shutter_locked, condition_.iso_locked, condition_.f_number_locked};
  const auto which = static_cast<std::size_t>(dial);
  if (!locked.at(which)) dials_.at(which) = std::min(place, kPlaces.at(which) - 1);
}

void BodyParts::turn_by(Dial dial, int steps) {
  const int further = !condition().oversteps || steps == 0 ? 0 : steps > 0 ? 1 : -1;
  const long place = static_cast<long>(this->dial(dial)) + steps + further;
  turn_to(dial, static_cast<std::size_t>(std::max(place, 0L)));
}

PtpAnswer BodyParts::release(bool raw, bool jpeg) {
  if (condition().store_full) return {kPtpStoreFull, std::nullopt};
  if (exposing()) return {};
  if (exposing_.valid()) exposing_.get();
  const Fraction shutter = kShutterTimes.at(dial(Dial::shutter));
  const CameraSettings settings{.exposure_s = static_cast<double>(shutter.numerator) / shutter.denominator,
                                .iso = static_cast<int>(kIsoSpeeds.at(dial(Dial::iso))),
                                .f_number = kFNumbersTimes100.at(dial(Dial::f_number)) / 100.0};
  exposing_ = std::async(std::launch::async, [this, settings, raw, jpeg] { expose(settings, raw, jpeg); });
  return {};
}

bool BodyParts::exposing() const {
  return exposing_.valid() && exposing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

void BodyParts::expose(const CameraSettings& settings, bool raw, bool jpeg) {
  std::deque<Stored> taken;
  try {
    if (raw) {
      camera_.configure(settings);
      taken.push_back({.raw = true, .bytes = text_of(camera_.capture().bytes)});
    }
    if (jpeg) taken.push_back({.raw = false, .bytes = text_of(camera_.preview())});
  } catch (const std::exception&) {
    return;  // as with a shutter that does not open: no picture ever appears
  }
  const std::lock_guard hold(mutex_);
  if (condition_.repeats_last_picture && !last_.empty()) taken = last_;
  last_ = taken;
  waiting_.insert(waiting_.end(), taken.begin(), taken.end());
}

int BodyParts::waiting() const {
  const std::lock_guard hold(mutex_);
  return static_cast<int>(waiting_.size());
}

std::optional<WaitingPicture> BodyParts::first_waiting() const {
  const std::lock_guard hold(mutex_);
  if (waiting_.empty()) return std::nullopt;
  return WaitingPicture{.raw = waiting_.front().raw, .size = waiting_.front().bytes.size()};
}

std::string BodyParts::first_bytes(std::size_t offset, std::size_t count) const {
  const std::lock_guard hold(mutex_);
  if (waiting_.empty() || offset > waiting_.front().bytes.size()) return {};
  return waiting_.front().bytes.substr(offset, count);
}

void BodyParts::drop_first() {
  const std::lock_guard hold(mutex_);
  if (!waiting_.empty()) waiting_.pop_front();
}

PtpAnswer BodyParts::live_view(const std::string& before_jpeg) const {
  try {
    return {kPtpOk, before_jpeg + text_of(camera_.preview())};
  } catch (const std::exception&) {
    return {kPtpGeneralError, std::nullopt};
  }
}

std::optional<PtpAnswer> BodyParts::plain_answer(const PtpRequest& request, const PtpDeviceInfo& device) const {
  switch (request.code) {
    case 0x1001:
      return PtpAnswer{kPtpOk, device_info(device)};
    case 0x1002:  // open and close the session
    case 0x1003:
      return PtpAnswer{};
    case 0x1004:
      return PtpAnswer{kPtpOk, PtpWriter().list(std::vector<std::uint32_t>{kPtpStorage}).take()};
    case 0x1005:
      return PtpAnswer{kPtpOk, storage_info()};
    case 0x1007:
      return PtpAnswer{kPtpOk, PtpWriter().list(std::vector<std::uint32_t>{}).take()};
    default:
      return std::nullopt;
  }
}

std::string BodyParts::device_info(const PtpDeviceInfo& device) const {
  PtpWriter out;
  out.put(std::uint16_t{100}).put(device.vendor).put(std::uint16_t{100}).text(device.vendor_text);
  out.put(std::uint16_t{0}).list(device.operations).list(device.events).list(device.properties);
  out.list(device.formats).list(device.formats);
  out.text(device.manufacturer).text(device.model).text(device.version).text(camera_.identity().serial);
  return out.take();
}

std::string BodyParts::storage_info() const {
  const std::uint64_t all = std::uint64_t{64} << 30, free = condition().store_full ? 0 : all / 2;
  return PtpWriter()
      .put(std::uint16_t{4})
      .put(std::uint16_t{2})
      .put(std::uint16_t{0})
      .put(all)
      .put(free)
      .put(static_cast<std::uint32_t>(free / (std::uint64_t{50} << 20)))
      .text("card")
      .text("")
      .take();
}

std::string BodyParts::described(std::uint32_t storage, std::uint16_t format, std::size_t size,
                                 const std::string& name) {
  PtpWriter out;
  out.put(storage).put(format).put(std::uint16_t{0}).put(static_cast<std::uint32_t>(size)).put(kPtpJpeg);
  for (int i = 0; i < 7; ++i)  // thumbnail, size, depth, parent
    out.put(std::uint32_t{0});
  out.put(std::uint16_t{0}).put(std::uint32_t{0}).put(std::uint32_t{0});
  out.text(name).text("").text("").text("");
  return out.take();
}

std::uint32_t parameter(const PtpRequest& request, std::size_t index) {
  return index < request.parameters.size() ? request.parameters[index] : 0;
}

std::uint16_t aperture_property(CameraMake make) {
  return make == CameraMake::canon ? 0xd101 : 0x5007;
}

std::unique_ptr<SimulatedBody> make_simulated_body(Camera& camera, CameraMake make) {
  switch (make) {
    case CameraMake::canon:
      return make_simulated_canon(camera);
    case CameraMake::nikon:
      return make_simulated_nikon(camera);
    case CameraMake::sony:
      break;
  }
  return make_simulated_sony(camera);
}

}  // namespace rig
