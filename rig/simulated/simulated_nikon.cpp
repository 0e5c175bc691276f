#include <map>
#include <mutex>
#include <utility>

#include "rig/simulated/body_parts.h"

namespace rig {
namespace {

constexpr std::uint16_t kBattery = 0x5001, kQuality = 0x5004, kFNumber = 0x5007, kFocusMode = 0x500a,
                        kExposureTime = 0x500d, kProgram = 0x500e, kIso = 0x500f, kShutter = 0xd100,
                        kAutofocusMode = 0xd161, kAutoIso = 0xd16a, kLiveViewStatus = 0xd1a2;
constexpr std::uint16_t kPropertyChanged = 0x4006, kObjectAddedInMemory = 0xc101, kNef = 0x3000;
constexpr std::uint32_t kPictureHandle = 0xffff0001;
constexpr std::uint16_t kNotLiveView = 0xa00b;
constexpr std::uint8_t kJpegFine = 2, kRaw = 4, kRawAndFine = 7;

class Nikon final : public SimulatedBody {
 public:
  explicit Nikon(Camera& camera) : parts_(camera) {}

  std::string name() const override { return "D750"; }
  void set_condition(const BodyCondition& condition) override {
    const std::lock_guard hold(mutex_);
    parts_.set_condition(condition);
    if (condition.jpeg_only) quality_ = kJpegFine;
  }
  int waiting_pictures() override { return parts_.waiting(); }
  bool shows_live_view() override {
    const std::lock_guard hold(mutex_);
    return live_view_;
  }
  std::optional<std::pair<std::uint16_t, std::uint32_t>> picture_event() const override { return std::nullopt; }

  PtpAnswer handle(const PtpRequest& request) override {
    const std::lock_guard hold(mutex_);
    if (request.code == 0x1002) announced_ = false;  // a new host hears of a picture that waits
    if (auto answer = parts_.plain_answer(request, device())) return *std::move(answer);
    const auto property = static_cast<std::uint16_t>(parameter(request, 0));
    switch (request.code) {
      case 0x1008:
        return object_info();
      case 0x1009:
        return object();
      case 0x100b:  // the picture leaves the memory when it is fetched
        return {};
      case 0x1014:
        return described_property(property);
      case 0x1015:
        return value_of(property);
      case 0x1016:
        return set_value(property, request);
      case 0x90c7:
        return {kPtpOk, events()};
      case 0x90c8:
        return {parts_.exposing() ? kPtpBusy : kPtpOk, std::nullopt};
      case 0x90ca:
        return {kPtpOk, PtpWriter().list(offered({kShutter, kAutofocusMode, kAutoIso, kLiveViewStatus})).take()};
      case 0x9201:
      case 0x9202:
        live_view_ = request.code == 0x9201;
        return {};
      case 0x9203:
        return live_view_ ? parts_.live_view(std::string(384, '\0')) : PtpAnswer{kNotLiveView, std::nullopt};
      case 0x9207:
        return parts_.release(quality_ >= kRaw, quality_ != kRaw);
      default:
        return {kPtpNotSupported, std::nullopt};
    }
  }

 private:
  PtpDeviceInfo device() const {
    return {.vendor = 0x0a,
            .vendor_text = "",
            .operations = {0x1001, 0x1002, 0x1003, 0x1004, 0x1005, 0x1006, 0x1007, 0x1008, 0x1009, 0x100a, 0x100b,
                           0x1014, 0x1015, 0x1016, 0x90c7, 0x90c8, 0x90ca, 0x9201, 0x9202, 0x9203, 0x9207},
            .events = {0x4002, kPropertyChanged, 0x400d, kObjectAddedInMemory, 0xc102},
            .properties = offered({kBattery, kQuality, kFNumber, kFocusMode, kExposureTime, kProgram, kIso}),
            .formats = {kPtpJpeg, kNef},
            .manufacturer = "Nikon Corporation",
            .model = "D750",
            .version = "V1.11"};
  }

  std::vector<std::uint16_t> offered(std::vector<std::uint16_t> properties) const {
    std::erase_if(properties, [this](std::uint16_t property) { return !parts_.has(property); });
    return properties;
  }

  template <typename Number>
  static PtpAnswer property(std::uint16_t code, std::uint16_t type, bool writable, Number value,
                            const std::vector<Number>& values = {}) {
    PtpWriter out;
    out.put(code).put(type).put(std::uint8_t{writable});
    put_values(out, value, values);
    return {kPtpOk, out.take()};
  }

  // Shutter times in PTP's own unit of 0.1 ms, and as Nikon's fractions, which are exact.
  static std::uint32_t tenths_of_ms(const Fraction& time) { return 10000 * time.numerator / time.denominator; }
  static std::uint32_t fraction(const Fraction& time) { return time.numerator << 16 | time.denominator; }
  template <typename Code>
  static std::vector<std::uint32_t> shutter_codes(const Code& code) {
    std::vector<std::uint32_t> codes;
    for (const Fraction& time : kShutterTimes) codes.push_back(code(time));
    return codes;
  }

  PtpAnswer described_property(std::uint16_t code) const {
    if (!parts_.has(code)) return {kPtpNoSuchProperty, std::nullopt};
    const BodyCondition now = parts_.condition();
    const Fraction shutter = kShutterTimes.at(parts_.dial(Dial::shutter));
    switch (code) {
      case kBattery:
        return property<std::uint8_t>(code, kPtpU8, false, static_cast<std::uint8_t>(now.battery_percent));
      case kQuality:
        return property<std::uint8_t>(code, kPtpU8, true, quality_,
                                      now.jpeg_only
                                          ? std::vector<std::uint8_t>{0, 1, kJpegFine}
                                          : std::vector<std::uint8_t>{0, 1, kJpegFine, kRaw, 5, 6, kRawAndFine});
      case kFNumber:
        return property<std::uint16_t>(code, kPtpU16, true, parts_.f_number_times_100(), parts_.f_numbers_times_100());
      case kFocusMode:
        return property<std::uint16_t>(
            code, kPtpU16, false, static_cast<std::uint16_t>(now.focus_mode == 1 ? 1 : 0x8010), {1, 0x8010, 0x8011});
      case kAutofocusMode:
        return property<std::uint8_t>(code, kPtpU8, true, static_cast<std::uint8_t>(now.focus_mode == 1 ? 4 : 0),
                                      {0, 1, 4});
      case kProgram:
        return property<std::uint16_t>(code, kPtpU16, false, static_cast<std::uint16_t>(now.exposure_program),
                                       {1, 2, 3, 4});
      case kExposureTime:
        return property<std::uint32_t>(code, kPtpU32, true, tenths_of_ms(shutter), shutter_codes(tenths_of_ms));
      case kShutter:
        return property<std::uint32_t>(code, kPtpU32, true, fraction(shutter), shutter_codes(fraction));
      case kIso: {
        const auto speed = [](std::uint32_t iso) { return static_cast<std::uint16_t>(iso); };
        std::vector<std::uint16_t> speeds;
        for (const std::uint32_t iso : kIsoSpeeds) speeds.push_back(speed(iso));
        return property<std::uint16_t>(code, kPtpU16, true, speed(kIsoSpeeds.at(parts_.dial(Dial::iso))), speeds);
      }
      case kAutoIso:
        return {kPtpOk, on_or_off(code, now.auto_iso)};
      case kLiveViewStatus:
        return property<std::uint8_t>(code, kPtpU8, false, std::uint8_t{live_view_});
      default:
        return {kPtpNoSuchProperty, std::nullopt};
    }
  }

  // A range of 0 to 1 in steps of 1.
  static std::string on_or_off(std::uint16_t code, bool on) {
    return PtpWriter()
        .put(code)
        .put(kPtpU8)
        .put(std::uint8_t{1})
        .put(std::uint8_t{0})
        .put(std::uint8_t{on})
        .bytes(std::string("\1\0\1\1", 4))
        .take();
  }

  PtpAnswer value_of(std::uint16_t code) const {
    if (code != kLiveViewStatus) return {kPtpNoSuchProperty, std::nullopt};
    return {kPtpOk, PtpWriter().put(std::uint8_t{live_view_}).take()};
  }

  PtpAnswer set_value(std::uint16_t code, const PtpRequest& request) {
    const BodyCondition now = parts_.condition();
    const auto turn = [this](Dial dial, std::size_t place) {
      parts_.turn_by(dial, static_cast<int>(place) - static_cast<int>(parts_.dial(dial)));
    };
    if (code == kQuality && !now.quality_locked)
      quality_ = sent<std::uint8_t>(request);
    else if (code == kFNumber)
      turn(Dial::f_number, place_of(kFNumbersTimes100, sent<std::uint16_t>(request), parts_.dial(Dial::f_number)));
    else if (code == kShutter)
      turn(Dial::shutter, place_of(shutter_codes(fraction), sent<std::uint32_t>(request), parts_.dial(Dial::shutter)));
    else if (code == kExposureTime)
      turn(Dial::shutter,
           place_of(shutter_codes(tenths_of_ms), sent<std::uint32_t>(request), parts_.dial(Dial::shutter)));
    else if (code == kIso)
      turn(Dial::iso, place_of(kIsoSpeeds, std::uint32_t{sent<std::uint16_t>(request)}, parts_.dial(Dial::iso)));
    return {};
  }

  // What happened since the last question: properties that changed, and a picture that is ready. The next picture is
  // told of when this one was fetched.
  std::string events() {
    std::uint16_t count = 0;
    PtpWriter list;
    const auto add = [&](std::uint16_t code, std::uint32_t parameter) {
      list.put(code).put(parameter);
      ++count;
    };
    for (const std::uint16_t code : {kQuality, kFNumber, kFocusMode, kProgram, kIso, kShutter, kAutoIso})
      if (const auto now = described_property(code).data; now && std::exchange(told_[code], *now) != *now)
        add(kPropertyChanged, code);
    if (parts_.waiting() > 0 && !std::exchange(announced_, true)) add(kObjectAddedInMemory, kPictureHandle);
    return PtpWriter().put(count).bytes(list.take()).take();
  }

  PtpAnswer object_info() const {
    const auto picture = parts_.first_waiting();
    if (!picture) return {kPtpInvalidHandle, std::nullopt};
    constexpr std::uint32_t kInMemory = 0;  // no storage
    return {kPtpOk, BodyParts::described(kInMemory, picture->raw ? kNef : kPtpJpeg, picture->size,
                                         picture->raw ? "DSC_0001.NEF" : "DSC_0001.JPG")};
  }

  PtpAnswer object() {
    const auto picture = parts_.first_waiting();
    if (!picture) return {kPtpInvalidHandle, std::nullopt};
    PtpAnswer answer{kPtpOk, parts_.first_bytes(0, picture->size), true};
    parts_.drop_first();
    announced_ = false;
    return answer;
  }

  BodyParts parts_;
  std::mutex mutex_;
  std::uint8_t quality_ = kRaw;
  std::map<std::uint16_t, std::string> told_;  // properties as the host last heard of them
  bool live_view_ = false, announced_ = false;
};

}  // namespace

std::unique_ptr<SimulatedBody> make_simulated_nikon(Camera& camera) {
  return std::make_unique<Nikon>(camera);
}

}  // namespace rig
