// What simulated camera bodies of every make have: dials, a shutter, a memory for pictures, a live view, and the
// answers of plain PTP.
#pragma once

#include <array>
#include <deque>
#include <future>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "rig/cameras/ptp_bytes.h"
#include "rig/simulated/simulated_body.h"

namespace rig {

// PTP's answers, data types and formats.
inline constexpr std::uint16_t kPtpOk = 0x2001, kPtpGeneralError = 0x2002, kPtpNotSupported = 0x2005,
                               kPtpInvalidHandle = 0x2009, kPtpNoSuchProperty = 0x200a, kPtpStoreFull = 0x200c,
                               kPtpBusy = 0x2019;
inline constexpr std::uint16_t kPtpI8 = 1, kPtpU8 = 2, kPtpI16 = 3, kPtpU16 = 4, kPtpU32 = 6;
inline constexpr std::uint16_t kPtpJpeg = 0x3801;
inline constexpr std::uint32_t kPtpStorage = 0x00010001;

struct Fraction {
  std::uint32_t numerator, denominator;
};

// Shutter times in thirds of stops, in libgphoto2's order for Sony's cameras, up to the shortest (1/8000 s).
inline constexpr std::array kShutterTimes{
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
inline constexpr std::array<std::uint32_t, 28> kIsoSpeeds{
    50,   64,   80,   100,  125,  160,  200,  250,  320,  400,   500,   640,   800,   1000,
    1250, 1600, 2000, 2500, 3200, 4000, 5000, 6400, 8000, 10000, 12800, 16000, 20000, 25600};
inline constexpr std::array<std::uint16_t, 19> kFNumbersTimes100{
    280, 320, 350, 400, 450, 500, 560, 630, 710, 800, 900, 1000, 1100, 1300, 1400, 1600, 1800, 2000, 2200};

enum class Dial { shutter, iso, f_number };  // positions are the places in the tables above

struct PtpDeviceInfo {
  std::uint32_t vendor = 0;
  std::string vendor_text;
  std::vector<std::uint16_t> operations, events, properties, formats;
  std::string manufacturer, model, version;
};

struct WaitingPicture {
  bool raw = false;
  std::size_t size = 0;
};

// The parts of one body; any thread may ask them.
class BodyParts {
 public:
  explicit BodyParts(Camera& camera) : camera_(camera) {}
  ~BodyParts();
  BodyParts(const BodyParts&) = delete;
  BodyParts& operator=(const BodyParts&) = delete;

  BodyCondition condition() const;
  void set_condition(const BodyCondition& condition);
  void set_focus_mode(int mode);
  bool has(std::uint16_t property) const;
  std::uint16_t f_number_times_100() const;                // 0 where the aperture reads nothing
  std::vector<std::uint16_t> f_numbers_times_100() const;  // the choices; none where it has none

  // A locked dial stays where it is; turn_by() goes a step further on a camera that oversteps.
  std::size_t dial(Dial dial) const;
  void turn_to(Dial dial, std::size_t place);
  void turn_by(Dial dial, int steps);

  // Begins an exposure at the dials' settings; does nothing while the shutter is open.
  PtpAnswer release(bool raw, bool jpeg);
  bool exposing() const;

  int waiting() const;
  std::optional<WaitingPicture> first_waiting() const;
  std::string first_bytes(std::size_t offset, std::size_t count) const;  // of the first waiting picture
  void drop_first();
  PtpAnswer live_view(const std::string& before_jpeg = {}) const;

  // The answers that every make gives alike: device, session, storage, no older pictures. Nothing for all others.
  std::optional<PtpAnswer> plain_answer(const PtpRequest& request, const PtpDeviceInfo& device) const;
  // A PTP object: the first waiting picture, or `size` bytes of live view.
  static std::string described(std::uint32_t storage, std::uint16_t format, std::size_t size, const std::string& name);

 private:
  struct Stored {
    bool raw = false;
    std::string bytes;
  };
  void expose(const CameraSettings& settings, bool raw, bool jpeg);
  std::string device_info(const PtpDeviceInfo& device) const;
  std::string storage_info() const;

  Camera& camera_;
  mutable std::mutex mutex_;
  BodyCondition condition_;
  std::array<std::size_t, 3> dials_{21, 3, 9};  // 1/4 s, ISO 100, f/8
  std::deque<Stored> waiting_, last_;
  std::future<void> exposing_;
};

// The first number that the host sent along with a request.
template <typename Number>
Number sent(const PtpRequest& request) {
  return ptp_number<Number>(request.data, 0).value_or(0);
}

std::uint32_t parameter(const PtpRequest& request, std::size_t index);

// The place of a value in one of the tables above; the place where the dial stands when there is none.
template <typename Table, typename Value>
std::size_t place_of(const Table& table, Value wanted, std::size_t otherwise) {
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table[i] == wanted) return i;
  return otherwise;
}

// The values of a PTP property: those of the camera's manual, and the present one. `values` empty: any value.
template <typename Number>
void put_values(PtpWriter& out, Number now, const std::vector<Number>& values) {
  out.put(now).put(now).put(std::uint8_t(values.empty() ? 0 : 2));
  if (values.empty()) return;
  out.put(static_cast<std::uint16_t>(values.size()));
  for (const Number one : values) out.put(one);
}

}  // namespace rig
