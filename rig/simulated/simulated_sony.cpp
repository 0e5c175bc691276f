#include "rig/simulated/simulated_sony.h"

#include <algorithm>
#include <array>
#include <deque>
#include <future>
#include <mutex>
#include <utility>

#include "rig/cameras/ptp_bytes.h"

namespace rig {
namespace {

constexpr std::uint16_t kOk = 0x2001, kGeneralError = 0x2002, kNotSupported = 0x2005, kInvalidHandle = 0x2009,
                        kStoreFull = 0x200c;
constexpr std::uint16_t kQuality = 0x5004, kWhiteBalance = 0x5005, kFNumber = 0x5007, kFocusMode = 0x500a,
                        kProgram = 0x500e, kCompensation = 0x5010, kReleaseMode = 0x5013, kShutter = 0xd20d,
                        kFocusFound = 0xd213, kInMemory = 0xd215, kBattery = 0xd218, kIso = 0xd21e, kHalfPress = 0xd2c1,
                        kFullPress = 0xd2c2, kMovie = 0xd2c8, kFocusHold = 0xd2c7;
constexpr std::uint16_t kI8 = 1, kU8 = 2, kI16 = 3, kU16 = 4, kU32 = 6;  // PTP's data types
constexpr std::uint32_t kPictureHandle = 0xffffc001, kLiveViewHandle = 0xffffc002;
constexpr std::uint16_t kArw = 0xb101, kJpeg = 0x3801;
constexpr std::uint32_t kStorage = 0x00010001;

struct Fraction {
  std::uint32_t numerator, denominator;
};

// Shutter times in libgphoto2's order, up to this camera's shortest (1/8000 s).
constexpr std::array kShutterTable{
    Fraction{30, 1},   Fraction{25, 1},   Fraction{20, 1},   Fraction{15, 1},   Fraction{13, 1},   Fraction{10, 1},
    Fraction{8, 1},    Fraction{6, 1},    Fraction{5, 1},    Fraction{4, 1},    Fraction{32, 10},  Fraction{25, 10},
    Fraction{2, 1},    Fraction{16, 10},  Fraction{13, 10},  Fraction{1, 1},    Fraction{8, 10},   Fraction{6, 10},
    Fraction{5, 10},   Fraction{4, 10},   Fraction{1, 3},    Fraction{1, 4},    Fraction{1, 5},    Fraction{1, 6},
    Fraction{1, 8},    Fraction{1, 10},   Fraction{1, 13},   Fraction{1, 15},   Fraction{1, 20},   Fraction{1, 25},
    Fraction{1, 30},   Fraction{1, 40},   Fraction{1, 50},   Fraction{1, 60},   Fraction{1, 80},   Fraction{1, 100},
    Fraction{1, 125},  Fraction{1, 160},  Fraction{1, 200},  Fraction{1, 250},  Fraction{1, 320},  Fraction{1, 400},
    Fraction{1, 500},  Fraction{1, 640},  Fraction{1, 800},  Fraction{1, 1000}, Fraction{1, 1250}, Fraction{1, 1600},
    Fraction{1, 2000}, Fraction{1, 2500}, Fraction{1, 3200}, Fraction{1, 4000}, Fraction{1, 5000}, Fraction{1, 6400},
    Fraction{1, 8000}};
constexpr std::array<std::uint32_t, 28> kIsos{50,   64,   80,   100,   125,   160,   200,   250,  320,  400,
                                              500,  640,  800,  1000,  1250,  1600,  2000,  2500, 3200, 4000,
                                              5000, 6400, 8000, 10000, 12800, 16000, 20000, 25600};
constexpr std::array<std::uint16_t, 19> kFNumbers{280, 320,  350,  400,  450,  500,  560,  630,  710, 800,
                                                  900, 1000, 1100, 1300, 1400, 1600, 1800, 2000, 2200};

struct Waiting {
  std::uint16_t format;
  std::string bytes;
};

// Writes one entry of the list of all properties; with `values` empty the property takes any value.
template <typename Number>
void put_property(PtpWriter& out, std::uint16_t code, std::uint16_t type, Number value,
                  const std::vector<Number>& values = {}, bool writable = true) {
  out.put(code).put(type).put(std::uint8_t{writable}).put(std::uint8_t{1}).put(value).put(value);
  out.put(std::uint8_t(values.empty() ? 0 : 2));
  if (!values.empty()) {
    out.put(static_cast<std::uint16_t>(values.size()));
    for (const Number one : values) out.put(one);
  }
}

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::size_t stepped(std::size_t index, int steps, std::size_t count) {
  return static_cast<std::size_t>(std::clamp<long>(static_cast<long>(index) + steps, 0, static_cast<long>(count) - 1));
}

class Sony final : public SimulatedSony {
 public:
  explicit Sony(Camera& camera) : camera_(camera) {}
  ~Sony() override {
    if (exposing_.valid()) exposing_.wait();
  }

  void set_condition(const SonyCondition& condition) override {
    const std::lock_guard hold(mutex_);
    condition_ = condition;
  }

  int waiting_pictures() override {
    const std::lock_guard hold(mutex_);
    return static_cast<int>(waiting_.size());
  }

  PtpAnswer handle(const PtpRequest& request) override {
    const std::uint32_t first = request.parameters.empty() ? 0 : request.parameters[0];
    switch (request.code) {
      case 0x1001:
        return {kOk, device_info()};
      case 0x1002:  // open and close the session
      case 0x1003:
        return {};
      case 0x1004:
        return {kOk, PtpWriter().list(std::vector<std::uint32_t>{kStorage}).take()};
      case 0x1005:
        return {kOk, storage_info()};
      case 0x1007:
        return {kOk, PtpWriter().list(std::vector<std::uint32_t>{}).take()};
      case 0x1008:
        return object_info(first);
      case 0x1009:
        return object(first);
      case 0x9201:
        return {kOk, PtpWriter().put(std::uint64_t{0}).take()};
      case 0x9202:
        return {kOk, vendor_codes()};
      case 0x9205:
        return set_value(static_cast<std::uint16_t>(first), request.data);
      case 0x9207:
        return control(static_cast<std::uint16_t>(first), request.data);
      case 0x9209:
        return {kOk, all_properties()};
      default:
        return {kNotSupported, std::nullopt};
    }
  }

 private:
  std::string device_info() const {
    const std::vector<std::uint16_t> operations{0x1001, 0x1002, 0x1003, 0x1004, 0x1005, 0x1006, 0x1007, 0x1008,
                                                0x1009, 0x100a, 0x101b, 0x9201, 0x9202, 0x9205, 0x9207, 0x9209};
    PtpWriter out;
    out.put(std::uint16_t{100}).put(std::uint32_t{0x11}).put(std::uint16_t{100}).text("Sony PTP Extensions");
    out.put(std::uint16_t{0}).list(operations).list(std::vector<std::uint16_t>{0xc201, 0xc202, 0xc203});
    out.list(std::vector<std::uint16_t>{})
        .list(std::vector<std::uint16_t>{})
        .list(std::vector<std::uint16_t>{kJpeg, kArw});
    out.text("Sony Corporation").text("ILCE-7M2").text("3.30").text(camera_.identity().serial);
    return out.take();
  }

  static std::string vendor_codes() {
    return PtpWriter()
        .put(std::uint16_t{0xc8})
        .list(std::vector<std::uint16_t>{kQuality, kWhiteBalance, kFNumber, kFocusMode, kProgram, kCompensation,
                                         kReleaseMode, kShutter, kFocusFound, kInMemory, kBattery, kIso})
        .list(std::vector<std::uint16_t>{kHalfPress, kFullPress, kFocusHold, kMovie})
        .take();
  }

  std::string storage_info() {
    const std::lock_guard hold(mutex_);
    const std::uint64_t all = std::uint64_t{64} << 30, free = condition_.store_full ? 0 : all / 2;
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

  std::string all_properties() {
    const std::lock_guard hold(mutex_);
    const Fraction shutter = kShutterTable[shutter_];
    PtpWriter out;
    out.put(std::uint32_t{16}).put(std::uint32_t{0});
    put_property<std::uint8_t>(out, kQuality, kU8, quality_, {2, 3, 4, 16, 19});
    put_property<std::uint16_t>(out, kWhiteBalance, kU16, 4, {2, 4});
    put_property<std::uint16_t>(out, kFNumber, kU16, kFNumbers[f_number_], {kFNumbers.begin(), kFNumbers.end()});
    put_property<std::uint16_t>(out, kFocusMode, kU16, static_cast<std::uint16_t>(condition_.focus_mode), {1, 2});
    put_property<std::uint16_t>(out, kProgram, kU16, static_cast<std::uint16_t>(condition_.exposure_program),
                                {1, 2, 3, 4}, false);
    put_property<std::int16_t>(out, kCompensation, kI16, 0, {0});
    put_property<std::uint16_t>(out, kReleaseMode, kU16, 1, {1});
    put_property<std::uint32_t>(out, kShutter, kU32, shutter.numerator << 16 | shutter.denominator);
    put_property<std::uint8_t>(out, kFocusFound, kU8, 2, {}, false);
    const auto waiting = static_cast<std::uint16_t>(waiting_.size());
    put_property<std::uint16_t>(out, kInMemory, kU16, static_cast<std::uint16_t>(waiting == 0 ? 0 : 0x8000 + waiting),
                                {}, false);
    put_property<std::int8_t>(out, kBattery, kI8, static_cast<std::int8_t>(condition_.battery_percent), {}, false);
    put_property<std::uint32_t>(out, kIso, kU32, kIsos[iso_], {kIsos.begin(), kIsos.end()});
    for (const std::uint16_t button : {kHalfPress, kFullPress, kFocusHold, kMovie})
      put_property<std::uint16_t>(out, button, kU16, 1, {1, 2});
    return out.take();
  }

  // Sets a property to an absolute value. The shutter accepts one and ignores it, as in the real camera: libgphoto2
  // sends a wrong one after its steps.
  PtpAnswer set_value(std::uint16_t property, const std::string& data) {
    const std::lock_guard hold(mutex_);
    const auto choose = [](const auto& values, auto wanted, std::size_t& index) {
      const auto found = std::find(values.begin(), values.end(), wanted);
      index = found == values.end() ? index : static_cast<std::size_t>(found - values.begin());
    };
    if (property == kQuality && !condition_.quality_locked)
      quality_ = ptp_number<std::uint8_t>(data, 0).value_or(quality_);
    else if (property == kFNumber && !condition_.f_number_locked)
      choose(kFNumbers, ptp_number<std::uint16_t>(data, 0).value_or(0), f_number_);
    else if (property == kIso && !condition_.iso_locked)
      choose(kIsos, ptp_number<std::uint32_t>(data, 0).value_or(0), iso_);
    else if (property == kFocusMode)
      condition_.focus_mode = ptp_number<std::uint16_t>(data, 0).value_or(1);
    return {};
  }

  // Moves a property by steps or presses a button.
  PtpAnswer control(std::uint16_t property, const std::string& data) {
    const std::lock_guard hold(mutex_);
    const int asked = ptp_number<std::int8_t>(data, 0).value_or(0);
    const int steps = asked + (!condition_.oversteps || asked == 0 ? 0 : asked > 0 ? 1 : -1);
    if (property == kFNumber && !condition_.f_number_locked)
      f_number_ = stepped(f_number_, steps, kFNumbers.size());
    else if (property == kIso && !condition_.iso_locked)
      iso_ = stepped(iso_, steps, kIsos.size());
    else if (property == kShutter && !condition_.shutter_locked)
      shutter_ = stepped(shutter_, steps, kShutterTable.size());
    else if (property == kFullPress && ptp_number<std::uint8_t>(data, 0) == 2)
      return release();
    return {};
  }

  PtpAnswer release() {
    if (condition_.store_full) return {kStoreFull, std::nullopt};
    if (exposing_.valid()) {
      if (exposing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
        return {};  // the button does nothing while the shutter is open
      exposing_.get();
    }
    const Fraction shutter = kShutterTable[shutter_];
    const CameraSettings settings{.exposure_s = static_cast<double>(shutter.numerator) / shutter.denominator,
                                  .iso = static_cast<int>(kIsos[iso_]),
                                  .f_number = kFNumbers[f_number_] / 100.0};
    exposing_ = std::async(std::launch::async, [this, settings, quality = quality_] { expose(settings, quality); });
    return {};
  }

  void expose(const CameraSettings& settings, std::uint8_t quality) {
    std::deque<Waiting> taken;
    try {
      if (quality >= 16) {
        camera_.configure(settings);
        const Picture picture = camera_.capture();
        taken.push_back({kArw, text_of(picture.bytes)});
      }
      if (quality != 16) taken.push_back({kJpeg, text_of(camera_.preview())});
    } catch (const std::exception&) {
      return;  // as with a shutter that does not open: no picture ever appears
    }
    const std::lock_guard hold(mutex_);
    if (condition_.repeats_last_picture && !last_.empty()) taken = last_;
    last_ = taken;
    waiting_.insert(waiting_.end(), taken.begin(), taken.end());
  }

  static std::string described(std::uint16_t format, std::size_t size) {
    PtpWriter out;
    out.put(kStorage).put(format).put(std::uint16_t{0}).put(static_cast<std::uint32_t>(size)).put(kJpeg);
    for (int i = 0; i < 7; ++i)  // thumbnail, size, depth, parent
      out.put(std::uint32_t{0});
    out.put(std::uint16_t{0}).put(std::uint32_t{0}).put(std::uint32_t{0});
    out.text(format == kArw ? "DSC00001.ARW" : "DSC00001.JPG").text("").text("").text("");
    return out.take();
  }

  PtpAnswer object_info(std::uint32_t handle) {
    if (handle == kLiveViewHandle) return {kOk, described(kJpeg, 0x10000)};
    const std::lock_guard hold(mutex_);
    if (handle != kPictureHandle || waiting_.empty()) return {kInvalidHandle, std::nullopt};
    return {kOk, described(waiting_.front().format, waiting_.front().bytes.size())};
  }

  PtpAnswer object(std::uint32_t handle) {
    if (handle == kLiveViewHandle) return live_view();
    const std::lock_guard hold(mutex_);
    if (handle != kPictureHandle || waiting_.empty()) return {kInvalidHandle, std::nullopt};
    std::string bytes = std::move(waiting_.front().bytes);
    waiting_.pop_front();
    return {kOk, std::move(bytes)};
  }

  PtpAnswer live_view() {
    constexpr std::uint32_t kOffset = 136;
    try {
      const std::string jpeg = text_of(camera_.preview());
      PtpWriter out;
      out.put(kOffset).put(static_cast<std::uint32_t>(jpeg.size()));
      out.bytes(std::string(kOffset - 8, '\0')).bytes(jpeg);
      return {kOk, out.take()};
    } catch (const std::exception&) {
      return {kGeneralError, std::nullopt};
    }
  }

  Camera& camera_;
  std::mutex mutex_;
  SonyCondition condition_;
  std::uint8_t quality_ = 16;  // RAW
  std::size_t shutter_ = 21, iso_ = 3, f_number_ = 9;
  std::deque<Waiting> waiting_, last_;
  std::future<void> exposing_;
};

}  // namespace

std::unique_ptr<SimulatedSony> make_simulated_sony(Camera& camera) {
  return std::make_unique<Sony>(camera);
}

}  // namespace rig
