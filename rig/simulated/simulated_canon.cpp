#include <map>
#include <mutex>

#include "rig/simulated/body_parts.h"

namespace rig {
namespace {

constexpr std::uint16_t kAperture = 0xd101, kShutter = 0xd102, kIso = 0xd103, kProgram = 0xd105, kFocusMode = 0xd108,
                        kBattery = 0xd111, kAvailableShots = 0xd11b, kDestination = 0xd11c, kQuality = 0xd120,
                        kLiveViewOutput = 0xd1b0, kLiveViewMode = 0xd1b1;
constexpr std::uint32_t kTransferAsked = 0xc186, kValueChanged = 0xc189, kValuesOffered = 0xc18a;
constexpr std::uint32_t kPictureHandle = 0x01000001;
constexpr std::uint16_t kCr2 = 0xb103, kNotReady = 0xa102;

// A file format as Canon writes it: the number of files, and for each its 16 bytes: type, size, compression.
enum class Quality : std::uint32_t { raw, large_fine_jpeg, raw_and_jpeg };

std::string format_of(Quality quality) {
  constexpr std::uint32_t kBytes = 16, kRaw = 6, kJpeg = 1, kLarge = 0, kLossless = 4, kFine = 3;
  PtpWriter out;
  out.put(std::uint32_t{quality == Quality::raw_and_jpeg ? 2U : 1U});
  if (quality != Quality::large_fine_jpeg) out.put(kBytes).put(kRaw).put(kLarge).put(kLossless);
  if (quality != Quality::raw) out.put(kBytes).put(kJpeg).put(kLarge).put(kFine);
  return out.take();
}

std::string number(std::uint32_t value) {
  return PtpWriter().put(value).take();
}

// Canon counts eighths of a stop, of which its dials have those next to thirds.
std::uint32_t eighths(std::size_t thirds) {
  constexpr std::array<std::uint32_t, 3> kWithinAStop{0, 3, 5};
  return static_cast<std::uint32_t>(8 * (thirds / 3)) + kWithinAStop.at(thirds % 3);
}

struct CanonDial {
  Dial dial;
  std::uint32_t first;  // the code of the first place
  std::size_t places;
};

// The codes of the tables in body_parts.h: 30 s is 0x10, ISO 50 is 0x40, f/2.8 is 0x20.
const std::map<std::uint16_t, CanonDial> kDials{{kShutter, {Dial::shutter, 0x10, kShutterTimes.size()}},
                                                {kIso, {Dial::iso, 0x40, kIsoSpeeds.size()}},
                                                {kAperture, {Dial::f_number, 0x20, kFNumbersTimes100.size()}}};

std::uint32_t code_at(const CanonDial& dial, std::size_t place) {
  return dial.first + eighths(place);
}

std::string event(std::uint32_t type, const std::string& body) {
  return PtpWriter().put(static_cast<std::uint32_t>(8 + body.size())).put(type).bytes(body).take();
}

constexpr std::uint32_t kToComputer = 2;  // of kLiveViewOutput

class Canon final : public SimulatedBody {
 public:
  explicit Canon(Camera& camera) : parts_(camera) {}

  std::string name() const override { return "EOS6D"; }
  void set_condition(const BodyCondition& condition) override {
    const std::lock_guard hold(mutex_);
    parts_.set_condition(condition);
    if (condition.jpeg_only) quality_ = Quality::large_fine_jpeg;
  }
  int waiting_pictures() override { return parts_.waiting(); }
  bool shows_live_view() override {
    const std::lock_guard hold(mutex_);
    return (live_view_output_ & kToComputer) != 0;
  }
  std::optional<std::pair<std::uint16_t, std::uint32_t>> picture_event() const override { return std::nullopt; }

  PtpAnswer handle(const PtpRequest& request) override {
    const std::lock_guard hold(mutex_);
    if (auto answer = parts_.plain_answer(request, device())) return *std::move(answer);
    switch (request.code) {
      case 0x101b:
        return part_of_picture(request);
      case 0x9101:
        return {kPtpOk, PtpWriter().list(std::vector<std::uint32_t>{kPtpStorage}).take()};
      case 0x9102:
        return {kPtpOk, std::string(64, '\0')};
      case 0x9110:
        return set_value(request.data);
      case 0x9115:
        told_.clear();  // a new host hears of everything
        announced_ = false;
        return {};
      case 0x9116:
        return {kPtpOk, news()};
      case 0x9117:
        parts_.drop_first();
        announced_ = false;
        return {};
      case 0x9128:  // the button is pressed half (1) or all the way (2)
        return parameter(request, 0) == 2 ? parts_.release(takes_raw(), quality_ != Quality::raw) : PtpAnswer{};
      case 0x9153:
        return live_view();
      case 0x100b:
      case 0x9114:
      case 0x911a:
      case 0x911b:
      case 0x911c:
      case 0x911d:
      case 0x9129:
        return {};
      default:
        return {kPtpNotSupported, std::nullopt};
    }
  }

 private:
  static const PtpDeviceInfo& device() {
    static const PtpDeviceInfo info{
        .vendor = 0x0b,
        .vendor_text = "",
        .operations = {0x1001, 0x1002, 0x1003, 0x1004, 0x1005, 0x1006, 0x1007, 0x1008, 0x1009,
                       0x100b, 0x101b, 0x9101, 0x9102, 0x9110, 0x9114, 0x9115, 0x9116, 0x9117,
                       0x911a, 0x911b, 0x911c, 0x911d, 0x9128, 0x9129, 0x9153},
        .events = {0x4009, 0xc101},
        .properties = {},
        .formats = {kPtpJpeg, kCr2},
        .manufacturer = "Canon Inc.",
        .model = "Canon EOS 6D",
        .version = "3-1.1.8"};
    return info;
  }

  bool takes_raw() const { return quality_ != Quality::large_fine_jpeg; }

  // The present values of all properties.
  std::map<std::uint16_t, std::string> values() const {
    constexpr std::uint32_t kHalf = 1, kFull = 2, kLow = 0, kManyShots = 1000;
    constexpr std::array<std::uint32_t, 5> kPrograms{3, 3, 0, 2, 1};  // of M, P, A (Av), S (Tv), which are 1 ... 4
    const BodyCondition now = parts_.condition();
    std::map<std::uint16_t, std::string> values{
        {kProgram, number(kPrograms.at(static_cast<std::size_t>(now.exposure_program)))},
        {kFocusMode, number(now.focus_mode == 1 ? 3 : 0)},
        {kBattery, number(now.battery_percent > 60   ? kFull
                          : now.battery_percent > 15 ? kHalf
                                                     : kLow)},
        {kAvailableShots, number(kManyShots)},
        {kDestination, number(destination_)},
        {kQuality, format_of(quality_)},
        {kLiveViewOutput, number(live_view_output_)},
        {kLiveViewMode, number(1)}};
    for (const auto& [property, dial] : kDials) values[property] = number(code_at(dial, parts_.dial(dial.dial)));
    if (now.no_aperture_choices) values[kAperture] = number(0);
    std::erase_if(values, [this](const auto& one) { return !parts_.has(one.first); });
    return values;
  }

  // The values that a property may be given; none where it takes any.
  std::vector<std::string> choices(std::uint16_t property) const {
    std::vector<std::string> all;
    if (property == kAperture && parts_.condition().no_aperture_choices) return all;
    if (property == kQuality && parts_.condition().jpeg_only) return {format_of(Quality::large_fine_jpeg)};
    if (property == kQuality)
      for (const Quality one : {Quality::raw, Quality::large_fine_jpeg, Quality::raw_and_jpeg})
        all.push_back(format_of(one));
    if (property == kDestination) all = {number(2), number(4)};  // card, host
    if (const auto dial = kDials.find(property); dial != kDials.end())
      for (std::size_t place = 0; place < dial->second.places; ++place)
        all.push_back(number(code_at(dial->second, place)));
    return all;
  }

  // Everything that the host has not been told: values that changed, at first with their choices, and one picture.
  std::string news() {
    constexpr std::uint32_t kList = 3;
    PtpWriter out;
    for (const auto& [property, value] : values()) {
      const auto told = told_.find(property);
      if (told != told_.end() && told->second == value) continue;
      out.bytes(event(kValueChanged, number(property) + value));
      const std::vector<std::string> offered = told == told_.end() ? choices(property) : std::vector<std::string>{};
      if (!offered.empty()) {
        std::string list = number(property) + number(kList) + number(static_cast<std::uint32_t>(offered.size()));
        for (const std::string& one : offered) list += one;
        out.bytes(event(kValuesOffered, list));
      }
      told_[property] = value;
    }
    const auto picture = parts_.first_waiting();
    if (picture && !announced_) {
      announced_ = true;
      out.bytes(event(kTransferAsked, PtpWriter()
                                          .put(kPictureHandle)
                                          .put(static_cast<std::uint32_t>(picture->raw ? kCr2 : kPtpJpeg))
                                          .put(std::uint32_t{0})
                                          .put(static_cast<std::uint32_t>(picture->size))
                                          .put(std::uint32_t{0})
                                          .bytes(picture->raw ? "IMG_0001.CR2" : "IMG_0001.JPG")
                                          .bytes(std::string(4, '\0'))
                                          .take()));
    }
    return out.bytes(event(0, "")).take();
  }

  // The data are their own length, the property and its value.
  PtpAnswer set_value(const std::string& data) {
    const auto property = static_cast<std::uint16_t>(ptp_number<std::uint32_t>(data, 4).value_or(0));
    const std::uint32_t value = ptp_number<std::uint32_t>(data, 8).value_or(0);
    if (property == kQuality && !parts_.condition().quality_locked) {
      for (const Quality one : {Quality::raw, Quality::large_fine_jpeg, Quality::raw_and_jpeg})
        if (data.substr(8) == format_of(one)) quality_ = one;
    } else if (property == kDestination) {
      destination_ = value;
    } else if (property == kLiveViewOutput) {
      live_view_output_ = value;
    } else if (const auto dial = kDials.find(property); dial != kDials.end()) {
      for (std::size_t place = 0; place < dial->second.places; ++place)
        if (code_at(dial->second, place) == value)
          parts_.turn_by(dial->second.dial, static_cast<int>(place) - static_cast<int>(parts_.dial(dial->second.dial)));
    }
    told_.erase(property);  // the camera says what became of it
    return {};
  }

  PtpAnswer part_of_picture(const PtpRequest& request) const {
    if (parameter(request, 0) != kPictureHandle || parts_.waiting() == 0) return {kPtpInvalidHandle, std::nullopt};
    return {kPtpOk, parts_.first_bytes(parameter(request, 1), parameter(request, 2)), true};
  }

  // Blocks of length, type and data; type 1 is the JPEG.
  PtpAnswer live_view() const {
    if ((live_view_output_ & kToComputer) == 0) return {kNotReady, std::nullopt};
    PtpAnswer answer = parts_.live_view();
    if (answer.data) answer.data = event(1, *answer.data);
    return answer;
  }

  BodyParts parts_;
  std::mutex mutex_;
  Quality quality_ = Quality::raw;
  std::uint32_t destination_ = 2, live_view_output_ = 0;
  std::map<std::uint16_t, std::string> told_;
  bool announced_ = false;
};

}  // namespace

std::unique_ptr<SimulatedBody> make_simulated_canon(Camera& camera) {
  return std::make_unique<Canon>(camera);
}

}  // namespace rig
