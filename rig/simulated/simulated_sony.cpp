#include <mutex>

#include "rig/simulated/body_parts.h"

namespace rig {
namespace {

constexpr std::uint16_t kQuality = 0x5004, kWhiteBalance = 0x5005, kFNumber = 0x5007, kFocusMode = 0x500a,
                        kProgram = 0x500e, kCompensation = 0x5010, kReleaseMode = 0x5013, kShutter = 0xd20d,
                        kFocusFound = 0xd213, kInMemory = 0xd215, kBattery = 0xd218, kIso = 0xd21e, kHalfPress = 0xd2c1,
                        kFullPress = 0xd2c2, kMovie = 0xd2c8, kFocusHold = 0xd2c7;
constexpr std::uint32_t kPictureHandle = 0xffffc001, kLiveViewHandle = 0xffffc002;
constexpr std::uint16_t kPictureReady = 0xc201, kArw = 0xb101;
constexpr std::uint8_t kJpegFine = 3, kRaw = 16, kRawAndJpeg = 19;

// The entries of the list of all properties.
class PropertyList {
 public:
  explicit PropertyList(const BodyParts& parts) : parts_(parts) {}

  // With `values` empty the property takes any value.
  template <typename Number>
  void put(std::uint16_t code, std::uint16_t type, Number value, const std::vector<Number>& values = {},
           bool writable = true) {
    if (!parts_.has(code)) return;
    entries_.put(code).put(type).put(std::uint8_t{writable}).put(std::uint8_t{1});
    put_values(entries_, value, values);
    ++count_;
  }
  std::string take() { return PtpWriter().put(count_).put(std::uint32_t{0}).bytes(entries_.take()).take(); }

 private:
  const BodyParts& parts_;
  PtpWriter entries_;
  std::uint32_t count_ = 0;
};

class Sony final : public SimulatedBody {
 public:
  explicit Sony(Camera& camera) : parts_(camera) {}

  std::string name() const override { return "ILCE-7M2"; }
  void set_condition(const BodyCondition& condition) override {
    const std::lock_guard hold(mutex_);
    parts_.set_condition(condition);
    if (condition.jpeg_only) quality_ = kJpegFine;
  }
  int waiting_pictures() override { return parts_.waiting(); }
  std::optional<std::pair<std::uint16_t, std::uint32_t>> picture_event() const override {
    return std::pair{kPictureReady, kPictureHandle};
  }

  PtpAnswer handle(const PtpRequest& request) override {
    const std::lock_guard hold(mutex_);
    if (auto answer = parts_.plain_answer(request, device())) return *std::move(answer);
    const std::uint32_t first = parameter(request, 0);
    switch (request.code) {
      case 0x1008:
        return object_info(first);
      case 0x1009:
        return object(first);
      case 0x9201:
        return {kPtpOk, PtpWriter().put(std::uint64_t{0}).take()};
      case 0x9202:
        return {kPtpOk, vendor_codes()};
      case 0x9205:
        return set_value(static_cast<std::uint16_t>(first), request);
      case 0x9207:
        return control(static_cast<std::uint16_t>(first), request);
      case 0x9209:
        return {kPtpOk, all_properties()};
      default:
        return {kPtpNotSupported, std::nullopt};
    }
  }

 private:
  static const PtpDeviceInfo& device() {
    static const PtpDeviceInfo info{.vendor = 0x11,
                                    .vendor_text = "Sony PTP Extensions",
                                    .operations = {0x1001, 0x1002, 0x1003, 0x1004, 0x1005, 0x1006, 0x1007, 0x1008,
                                                   0x1009, 0x100a, 0x101b, 0x9201, 0x9202, 0x9205, 0x9207, 0x9209},
                                    .events = {kPictureReady, 0xc202, 0xc203},
                                    .properties = {},
                                    .formats = {kPtpJpeg, kArw},
                                    .manufacturer = "Sony Corporation",
                                    .model = "ILCE-7M2",
                                    .version = "3.30"};
    return info;
  }

  std::string vendor_codes() const {
    std::vector<std::uint16_t> properties{kQuality,     kWhiteBalance, kFNumber,    kFocusMode, kProgram, kCompensation,
                                          kReleaseMode, kShutter,      kFocusFound, kInMemory,  kBattery, kIso};
    std::erase_if(properties, [this](std::uint16_t property) { return !parts_.has(property); });
    return PtpWriter()
        .put(std::uint16_t{0xc8})
        .list(properties)
        .list(std::vector<std::uint16_t>{kHalfPress, kFullPress, kFocusHold, kMovie})
        .take();
  }

  std::string all_properties() const {
    const BodyCondition now = parts_.condition();
    const Fraction shutter = kShutterTimes.at(parts_.dial(Dial::shutter));
    PropertyList list(parts_);
    list.put<std::uint8_t>(kQuality, kPtpU8, quality_,
                           now.jpeg_only ? std::vector<std::uint8_t>{2, kJpegFine, 4}
                                         : std::vector<std::uint8_t>{2, kJpegFine, 4, kRaw, kRawAndJpeg});
    list.put<std::uint16_t>(kWhiteBalance, kPtpU16, 4, {2, 4});
    list.put<std::uint16_t>(kFNumber, kPtpU16, parts_.f_number_times_100(), parts_.f_numbers_times_100());
    list.put<std::uint16_t>(kFocusMode, kPtpU16, static_cast<std::uint16_t>(now.focus_mode), {1, 2});
    list.put<std::uint16_t>(kProgram, kPtpU16, static_cast<std::uint16_t>(now.exposure_program), {1, 2, 3, 4}, false);
    list.put<std::int16_t>(kCompensation, kPtpI16, 0, {0});
    list.put<std::uint16_t>(kReleaseMode, kPtpU16, 1, {1});
    list.put<std::uint32_t>(kShutter, kPtpU32, shutter.numerator << 16 | shutter.denominator);
    list.put<std::uint8_t>(kFocusFound, kPtpU8, 2, {}, false);
    const int waiting = parts_.waiting();
    list.put<std::uint16_t>(kInMemory, kPtpU16, static_cast<std::uint16_t>(waiting == 0 ? 0 : 0x8000 + waiting), {},
                            false);
    list.put<std::int8_t>(kBattery, kPtpI8, static_cast<std::int8_t>(now.battery_percent), {}, false);
    list.put<std::uint32_t>(kIso, kPtpU32, kIsoSpeeds.at(parts_.dial(Dial::iso)),
                            {kIsoSpeeds.begin(), kIsoSpeeds.end()});
    for (const std::uint16_t button : {kHalfPress, kFullPress, kFocusHold, kMovie})
      list.put<std::uint16_t>(button, kPtpU16, 1, {1, 2});
    return list.take();
  }

  // Sets a property to an absolute value. The shutter accepts one and ignores it, as in the real camera: libgphoto2
  // sends a wrong one after its steps.
  PtpAnswer set_value(std::uint16_t property, const PtpRequest& request) {
    if (property == kQuality && !parts_.condition().quality_locked)
      quality_ = sent<std::uint8_t>(request);
    else if (property == kFNumber)
      parts_.turn_to(Dial::f_number,
                     place_of(kFNumbersTimes100, sent<std::uint16_t>(request), parts_.dial(Dial::f_number)));
    else if (property == kIso)
      parts_.turn_to(Dial::iso, place_of(kIsoSpeeds, sent<std::uint32_t>(request), parts_.dial(Dial::iso)));
    else if (property == kFocusMode)
      parts_.set_focus_mode(sent<std::uint16_t>(request));
    return {};
  }

  // Moves a property by steps or presses a button.
  PtpAnswer control(std::uint16_t property, const PtpRequest& request) {
    const int steps = sent<std::int8_t>(request);
    if (property == kFNumber)
      parts_.turn_by(Dial::f_number, steps);
    else if (property == kIso)
      parts_.turn_by(Dial::iso, steps);
    else if (property == kShutter)
      parts_.turn_by(Dial::shutter, steps);
    else if (property == kFullPress && steps == 2)
      return parts_.release(quality_ >= kRaw, quality_ != kRaw);
    return {};
  }

  PtpAnswer object_info(std::uint32_t handle) const {
    if (handle == kLiveViewHandle)
      return {kPtpOk, BodyParts::described(kPtpStorage, kPtpJpeg, 0x10000, "DSC00001.JPG")};
    const auto picture = parts_.first_waiting();
    if (handle != kPictureHandle || !picture) return {kPtpInvalidHandle, std::nullopt};
    return {kPtpOk, BodyParts::described(kPtpStorage, picture->raw ? kArw : kPtpJpeg, picture->size,
                                         picture->raw ? "DSC00001.ARW" : "DSC00001.JPG")};
  }

  PtpAnswer object(std::uint32_t handle) {
    if (handle == kLiveViewHandle) return live_view();
    const auto picture = parts_.first_waiting();
    if (handle != kPictureHandle || !picture) return {kPtpInvalidHandle, std::nullopt};
    PtpAnswer answer{kPtpOk, parts_.first_bytes(0, picture->size), true};
    parts_.drop_first();
    return answer;
  }

  // Before the JPEG stand where it begins and how long it is.
  PtpAnswer live_view() const {
    constexpr std::uint32_t kOffset = 136;
    PtpAnswer answer = parts_.live_view();
    if (!answer.data) return answer;
    PtpWriter out;
    out.put(kOffset).put(static_cast<std::uint32_t>(answer.data->size()));
    out.bytes(std::string(kOffset - 8, '\0')).bytes(*answer.data);
    return {kPtpOk, out.take()};
  }

  BodyParts parts_;
  std::mutex mutex_;
  std::uint8_t quality_ = kRaw;
};

}  // namespace

std::unique_ptr<SimulatedBody> make_simulated_sony(Camera& camera) {
  return std::make_unique<Sony>(camera);
}

}  // namespace rig
