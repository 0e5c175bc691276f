#include "station/bench/calibrate/solve_response.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <stdexcept>

#include "calibration/light/lamp_stability.h"
#include "calibration/sensor/photon_transfer.h"
#include "station/bench/camera_adapter.h"
#include "station/documents/gate_list.h"

namespace station {
namespace {

constexpr double kMostNonlinear = 0.01, kMostBad = 0.005, kMostFlicker = 0.002, kMostDriftPerMin = 0.001;
constexpr double kMostDarkPerSecond = 2e-3;  // of the range: sensors have a hundredth of that
constexpr double kLeastCovered = 0.8;

// Seconds since 1970 of "2026-11-21T10:20:30.123Z".
double seconds_of_utc(const std::string& utc) {
  std::tm parts{};
  const char* rest = strptime(utc.c_str(), "%Y-%m-%dT%H:%M:%S", &parts);
  if (rest == nullptr)
    throw std::runtime_error("a calibration picture is dated \"" + utc + "\"; take it again with calibrate");
  return static_cast<double>(timegm(&parts)) + (*rest == '.' ? std::strtod(rest, nullptr) : 0.0);
}

using Pictures = std::vector<CalibrationPicture>;

Pictures of_role(const Pictures& pictures, CalibrationRole role) {
  Pictures found;
  for (const CalibrationPicture& p : pictures)
    if (p.role == role) found.push_back(p);
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  if (found.empty())
    throw std::runtime_error("the calibration has no picture of the role " + to_text(role) +
                             "; take them with calibrate --only response");
  return found;
}

struct Reader {
  const std::filesystem::path& folder;
  const std::function<void(const std::string&)>& progress;

  calibration::SensorPicture operator()(const CalibrationPicture& picture) const {
    progress("sensor: " + picture.id);
    return calibration::read_sensor_file(folder / picture.file);
  }
};

calibration::DarkFit solve_darks(const Pictures& pictures, const Reader& read) {
  std::map<double, calibration::PictureStack> stacks;  // by exposure
  for (const CalibrationPicture& p : of_role(pictures, CalibrationRole::dark)) stacks[p.exposure_s].add(read(p));
  return calibration::fit_dark_maps(stacks.begin()->second, stacks.rbegin()->second);
}

calibration::FlatFit solve_flats(const Pictures& pictures, const Reader& read, double white_level_dn,
                                 calibration::SensorMaps& maps) {
  std::map<std::string, calibration::PictureStack> stacks;  // by the series' first picture
  for (const CalibrationPicture& p : of_role(pictures, CalibrationRole::white_field))
    stacks[p.exposure_of.empty() ? p.id : p.exposure_of].add(read(p));
  std::vector<calibration::PictureStack> flats;
  for (auto& [first, stack] : stacks) flats.push_back(std::move(stack));
  return calibration::fit_flat_maps(flats, white_level_dn, maps);
}

// Pictures of equal exposure, the first with the last, so that the ladder's two halves meet.
std::vector<calibration::PairLevels> measure_ladder(const Pictures& ladder, const Reader& read,
                                                    const calibration::LevelBins& bins,
                                                    const calibration::SensorMaps& maps) {
  std::map<double, Pictures> by_exposure;
  for (const CalibrationPicture& p : ladder) by_exposure[p.exposure_s].push_back(p);
  std::vector<calibration::PairLevels> pairs;
  for (const auto& [exposure_s, same] : by_exposure) {
    if (same.size() < 2) continue;
    const double apart_s = seconds_of_utc(same.back().utc) - seconds_of_utc(same.front().utc);
    pairs.push_back(calibration::measure_pair(read(same.front()), read(same.back()), bins, maps, apart_s));
  }
  return pairs;
}

std::vector<calibration::Gate> gates_of(const SensorSection& sensor, const calibration::FlatFit& flats,
                                        const cv::Size& size, double range_dn) {
  using calibration::at_least, calibration::at_most;
  const int bad = sensor.bad.hot + sensor.bad.noisy + sensor.bad.dead;
  const double drift = std::max(0.0, std::abs(sensor.lamp_drift_per_min) - 2 * sensor.lamp_drift_sigma_per_min);
  return {
      at_most("departure from a straight response below 85 % of the range", sensor.linearity_residual, kMostNonlinear,
              "the correction is only a small one; set the camera to uncompressed RAW and base ISO"),
      at_most("part of the pixels that are bad", static_cast<double>(bad) / size.area(), kMostBad,
              "repaired pixels are guesses; keep the camera cool and the lens cap on in dark frames"),
      at_most("dark frames' brightness per second, of the range", sensor.dark_dn_per_s / range_dn, kMostDarkPerSecond,
              "light reaches the sensor in dark frames; switch lamp and room light off"),
      at_most("lamp's flicker from picture to picture", sensor.lamp_flicker, kMostFlicker,
              "exposures shall last 20 of the lamp's switching periods; use a constant current or longer exposures"),
      at_most("lamp's drift per minute (beyond 2 sigma)", drift, kMostDriftPerMin,
              "the lamp is still warming up; wait and take the pictures again with calibrate --only response"),
      at_least("part of the picture that the white panel filled", flats.covered, kLeastCovered,
               "dust is looked for on white; hold the panel closer to the lens")};
}

}  // namespace

bool is_sensor_role(CalibrationRole role) {
  return role == CalibrationRole::response || role == CalibrationRole::rapid || role == CalibrationRole::dark ||
         role == CalibrationRole::white_field;
}

SensorSection solve_response(const std::filesystem::path& folder, const std::vector<CalibrationPicture>& pictures,
                             const std::function<void(const std::string& label)>& progress) {
  const Reader read{folder, progress};
  const Pictures ladder = of_role(pictures, CalibrationRole::response);
  const auto metered =
      std::find_if(ladder.begin(), ladder.end(), [](const CalibrationPicture& p) { return p.exposure_of.empty(); });
  if (metered == ladder.end())
    throw std::runtime_error("the ladder's metered picture is missing; take it with calibrate --only response");
  const calibration::SensorPicture reference = read(*metered);
  const double range_dn = reference.white_level_dn - reference.black_level_dn;

  calibration::DarkFit darks = solve_darks(pictures, read);
  const calibration::FlatFit flats = solve_flats(pictures, read, reference.white_level_dn, darks.maps);
  const calibration::LevelBins bins = calibration::make_level_bins(reference, darks.maps);
  const auto pairs = measure_ladder(ladder, read, bins, darks.maps);
  const calibration::PhotonTransfer transfer =
      calibration::fit_photon_transfer(pairs, darks, range_dn, reference.exposure_s);
  std::vector<calibration::SensorPicture> rapid;
  for (const CalibrationPicture& p : of_role(pictures, CalibrationRole::rapid)) rapid.push_back(read(p));
  const calibration::LampStability lamp = calibration::lamp_stability(rapid, bins, darks.maps, pairs);

  SensorSection sensor{.response = transfer.response, .gates = {}, .maps_sha256 = {}, .bad_pixels_sha256 = {}};
  sensor.response.iso = reference.iso;
  sensor.response.f_number = f_number_of(reference);
  sensor.response.maps = darks.maps;
  sensor.bias_dn = darks.bias_dn;
  sensor.dark_dn_per_s = darks.dark_dn_per_s;
  sensor.linearity_residual = transfer.linearity_residual;
  sensor.bad = {.hot = darks.bad.hot, .noisy = darks.bad.noisy, .dead = flats.dead};
  sensor.dust_depth = flats.deepest;
  sensor.flat_noise = flats.flat_noise;
  sensor.lamp_flicker = lamp.flicker;
  sensor.lamp_drift_per_min = lamp.drift_per_min;
  sensor.lamp_drift_sigma_per_min = lamp.drift_sigma_per_min;
  sensor.gates = gates_of(sensor, flats, reference.mosaic.size(), range_dn);
  return sensor;
}

std::string describe(const SensorSection& sensor) {
  const calibration::SensorResponse& response = sensor.response;
  double worst = 0;
  for (const calibration::ShutterTime& time : response.shutter)
    worst = std::max(worst, std::abs(time.true_s / time.nominal_s - 1));
  char text[700];
  std::snprintf(
      text, sizeof text,
      "sensor    %.4f DN/e (+-%.2f %%), read noise %.2f e, bias %.2f DN, bends by %.2f %% (+-%.3f), %zu shutter "
      "times off by up to %.2f %%\n"
      "          %d hot, %d noisy, %d dead pixels, dust up to %.1f %% (+-%.2f); lamp flickers by %.3f %%, "
      "drifts by %.3f %% per minute (+-%.3f)\n",
      response.gain_dn_per_e, 100 * response.gain_sigma / response.gain_dn_per_e, response.read_noise_e, sensor.bias_dn,
      100 * response.nonlinearity, 100 * response.nonlinearity_sigma, response.shutter.size(), 100 * worst,
      sensor.bad.hot, sensor.bad.noisy, sensor.bad.dead, 100 * sensor.dust_depth, 100 * sensor.flat_noise,
      100 * sensor.lamp_flicker, 100 * sensor.lamp_drift_per_min, 100 * sensor.lamp_drift_sigma_per_min);
  return text;
}

}  // namespace station
