#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "rig/simulated/live_view.h"
#include "rig/simulated/noise.h"
#include "rig/simulated/raw_writer.h"
#include "rig/simulated/simulated_bench.h"

namespace rig {
namespace {

constexpr double kCalibratedFNumber = 8.0;
constexpr double kBaseIso = 100.0;
constexpr double kCountedElectrons = 50.0;  // shot noise is Poisson below this mean, normal of the same variance above

// Thirds of a stop, as engraved on cameras.
constexpr std::array kShutterTimesS{
    1 / 8000., 1 / 6400., 1 / 5000., 1 / 4000., 1 / 3200., 1 / 2500., 1 / 2000., 1 / 1600., 1 / 1250., 1 / 1000.,
    1 / 800.,  1 / 640.,  1 / 500.,  1 / 400.,  1 / 320.,  1 / 250.,  1 / 200.,  1 / 160.,  1 / 125.,  1 / 100.,
    1 / 80.,   1 / 60.,   1 / 50.,   1 / 40.,   1 / 30.,   1 / 25.,   1 / 20.,   1 / 15.,   1 / 13.,   1 / 10.,
    1 / 8.,    1 / 6.,    1 / 5.,    1 / 4.,    1 / 3.,    0.4,       0.5,       0.6,       0.8,       1.,
    1.3,       1.6,       2.,        2.5,       3.2,       4.,        5.,        6.,        8.,        10.,
    13.,       15.,       20.,       25.,       30.};
constexpr std::array kIsos{50,   64,   80,   100,  125,  160,  200,  250,  320,  400,   500,   640,   800,   1000,
                           1250, 1600, 2000, 2500, 3200, 4000, 5000, 6400, 8000, 10000, 12800, 16000, 20000, 25600};
constexpr std::array kFNumbers{2.8, 3.2, 3.5, 4.,  4.5, 5.,  5.6, 6.3, 7.1, 8.,
                               9.,  10., 11., 13., 14., 16., 18., 20., 22.};

// The numbers of one exposure that are the same for every pixel.
struct Conversion {
  double exposure_s, electrons_per_radiance, dark_electrons, read_noise_e, dn_per_electron, black_dn, white_dn;
  double lost_per_electron;  // the part of all electrons lost for each of them, which makes the response bend
};

Conversion conversion(const TrueSensor& sensor, const CameraSettings& settings) {
  const double aperture = std::pow(kCalibratedFNumber / settings.f_number, 2);
  const double gain = settings.iso / kBaseIso;
  return {.exposure_s = settings.exposure_s,
          .electrons_per_radiance = settings.exposure_s * aperture * sensor.full_well_e,
          .dark_electrons = settings.exposure_s * sensor.dark_current_e_s,
          .read_noise_e = sensor.read_noise_e,
          .dn_per_electron = gain * (sensor.white_level_dn - sensor.black_level_dn) / sensor.full_well_e,
          .black_dn = sensor.black_level_dn,
          .white_dn = sensor.white_level_dn,
          .lost_per_electron = sensor.defects.nonlinearity / sensor.full_well_e};
}

// The lens's gain at a pixel; 1 at the centre of the image.
double vignetting(const TrueLens& lens, int row, int column) {
  const double x = column - (lens.width_px - 1) / 2.0, y = row - (lens.height_px - 1) / 2.0;
  const double width = lens.width_px, height = lens.height_px;
  const double r2 = 4 * (x * x + y * y) / (width * width + height * height);
  return 1 + (lens.vignetting[0] + lens.vignetting[1] * r2) * r2;
}

// The colour of a pixel in the RGGB mosaic: red (0) where row and column are even, blue (2) where both are odd.
int mosaic_channel(int row, int column) {
  return (row & 1) + (column & 1);
}

// The properties of a single pixel.
struct PixelOwn {
  double offset_dn, dark_current_e_s, read_noise_factor;
};

std::uint16_t exposed_dn(const Conversion& convert, double radiance, const PixelOwn& own, NoiseStream& noise) {
  const double mean_e = std::max(radiance, 0.0) * convert.electrons_per_radiance + convert.dark_electrons +
                        own.dark_current_e_s * convert.exposure_s;
  const auto [read, shot] = noise.normals();
  const double counted_e = mean_e < kCountedElectrons ? noise.small_poisson(mean_e) : mean_e + std::sqrt(mean_e) * shot;
  const double kept_e = counted_e * (1 - convert.lost_per_electron * counted_e);
  const double dn = convert.black_dn + own.offset_dn +
                    (kept_e + convert.read_noise_e * own.read_noise_factor * read) * convert.dn_per_electron;
  return static_cast<std::uint16_t>(std::lround(std::clamp(dn, 0.0, convert.white_dn)));
}

void check_drawing(const cv::Mat3f& radiance, const TrueLens& lens) {
  if (radiance.cols != lens.width_px || radiance.rows != lens.height_px) {
    throw std::runtime_error("the simulated bench was to be drawn with " + std::to_string(lens.width_px) + " x " +
                             std::to_string(lens.height_px) + " pixels, but the drawing has " +
                             std::to_string(radiance.cols) + " x " + std::to_string(radiance.rows));
  }
  const bool finite = std::all_of(radiance.begin(), radiance.end(), [](const cv::Vec3f& pixel) {
    return std::isfinite(pixel[0]) && std::isfinite(pixel[1]) && std::isfinite(pixel[2]);
  });
  if (!finite) throw std::runtime_error("the drawing of the simulated bench has pixels that are not finite numbers");
}

void check_sensor(const TrueSensor& sensor) {
  const double black_dn = sensor.black_level_dn;
  if (!(black_dn >= 0 && black_dn < kRawWhiteLevelDn && black_dn == std::round(black_dn)) ||
      sensor.white_level_dn != kRawWhiteLevelDn || !(sensor.full_well_e > 0)) {
    throw std::runtime_error("a sensor was to be simulated with black level " + std::to_string(black_dn) +
                             ", white level " + std::to_string(sensor.white_level_dn) + " and full well " +
                             std::to_string(sensor.full_well_e) +
                             " electrons; its files hold a whole black level below the white level 16383");
  }
}

class SimulatedCamera final : public Camera {
 public:
  SimulatedCamera(SimulatedBench& bench, Clock& clock, CameraMake make) : bench_(bench), clock_(clock), make_(make) {
    check_sensor(bench.truth().sensor);
  }

  CameraIdentity identity() override {
    return {.make = make_ == CameraMake::sony ? "Sony" : raw_names(make_).make,
            .model = raw_names(make_).model,
            .serial = "SIM" + std::to_string(bench_.truth().seed),
            .width_px = bench_.truth().lens.width_px,
            .height_px = bench_.truth().lens.height_px};
  }

  std::vector<double> shutter_times_s() override { return {kShutterTimesS.begin(), kShutterTimesS.end()}; }

  CameraSettings configure(const CameraSettings& wanted) override {
    if (std::ranges::find(kIsos, wanted.iso) == kIsos.end()) {
      throw std::runtime_error("ISO " + std::to_string(wanted.iso) +
                               " was asked; the camera offers thirds of a stop from 50 to 25600, ISO 100 is the base");
    }
    if (!std::isfinite(wanted.f_number) || wanted.f_number <= 0) {
      throw std::runtime_error("f/" + std::to_string(wanted.f_number) +
                               " was asked; the camera offers f/2.8 to f/22, f/8 is the calibrated aperture");
    }
    const double exposure_s = nearest_shutter_s(shutter_times_s(), wanted.exposure_s);
    const auto stops = [&](double offered) { return std::abs(std::log2(offered / wanted.f_number)); };
    settings_ = {exposure_s, wanted.iso, *std::ranges::min_element(kFNumbers, {}, stops)};
    return settings_;
  }

  Picture capture() override {
    const BenchState now = bench_.state();
    if (!drawn_state_ || !same_state(*drawn_state_, now)) {
      drawn_state_.reset();  // when drawing fails, the old drawing must not be taken for the new one
      by_lamp_ = focused(bench_.draw_lamp(), now.lens);
      without_lamp_ = focused(bench_.draw_without_lamp(), now.lens);
      drawn_state_ = now;
    }
    RawFrame frame;
    frame.mosaic = expose(light_of(now.lens));
    frame.black_level_dn = static_cast<std::uint16_t>(bench_.truth().sensor.black_level_dn);
    frame.settings = settings_;
    if (!now.lens.electronic_aperture) frame.settings.f_number = 0;
    frame.make = make_;
    frame.utc = clock_.utc();
    frame.serial = identity().serial;
    clock_.sleep_s(settings_.exposure_s);
    return {
        .bytes = encode_raw(frame), .extension = raw_names(make_).extension, .settings = settings_, .utc = frame.utc};
  }

  std::vector<std::byte> preview() override {
    const BenchState now = bench_.state();
    if (!shown_state_ || !same_state(*shown_state_, now)) {
      shown_state_.reset();  // as in capture()
      shown_ = live_view_jpeg(focused(bench_.draw_roughly(), now.lens));
      shown_state_ = now;
    }
    const auto* bytes = reinterpret_cast<const std::byte*>(shown_.data());
    return {bytes, bytes + shown_.size()};
  }

 private:
  static cv::Mat3f focused(const cv::Mat3f& drawn, const TrueLens& lens) {
    if (drawn.empty()) return drawn;
    check_drawing(drawn, lens);
    if (!(lens.blur_px > 0)) return drawn;
    cv::Mat3f blurred;
    cv::GaussianBlur(drawn, blurred, {0, 0}, lens.blur_px);
    return blurred;
  }

  // The picture that falls on the sensor in the coming exposure: the mean radiance over the exposure time.
  cv::Mat3f light_of(const TrueLens& lens) const {
    cv::Mat3f light =
        without_lamp_.empty() ? cv::Mat3f(lens.height_px, lens.width_px, cv::Vec3f()) : without_lamp_.clone();
    if (!by_lamp_.empty())
      light += by_lamp_ * lamp_strength(bench_.truth().lamp_changes, clock_.monotonic_s(), settings_.exposure_s);
    return light;
  }

  // The raw values of a picture. The noise differs from picture to picture and is the same in each run.
  cv::Mat1w expose(const cv::Mat3f& light) {
    const BenchTruth& truth = bench_.truth();
    if (defects_.sensitivity.empty()) defects_ = defect_maps(truth.sensor.defects, light.size(), truth.seed);
    CameraSettings true_settings = settings_;
    true_settings.exposure_s *= shutter_factor(truth.sensor.defects, settings_.exposure_s, truth.seed);
    const Conversion convert = conversion(truth.sensor, true_settings);
    NoiseStream noise(truth.seed, ++pictures_taken_);
    cv::Mat1w mosaic(light.size());
    for (int row = 0; row < mosaic.rows; ++row) {
      for (int column = 0; column < mosaic.cols; ++column) {
        const double radiance = static_cast<double>(light(row, column)[mosaic_channel(row, column)]);
        const double gain = vignetting(truth.lens, row, column) * defects_.sensitivity(row, column);
        const PixelOwn own{.offset_dn = defects_.offset_dn(row, column),
                           .dark_current_e_s = defects_.dark_current_e_s(row, column),
                           .read_noise_factor = defects_.read_noise_factor(row, column)};
        mosaic(row, column) = exposed_dn(convert, radiance * gain, own, noise);
      }
    }
    return mosaic;
  }

  SimulatedBench& bench_;
  Clock& clock_;
  const CameraMake make_;
  CameraSettings settings_;
  std::uint64_t pictures_taken_ = 0;
  std::optional<BenchState> drawn_state_;  // the state that the drawings show
  cv::Mat3f by_lamp_, without_lamp_;       // the drawings; one of them may be empty
  std::optional<BenchState> shown_state_;  // the state that the frame of the live view shows
  std::string shown_;                      // that frame, JPEG
  DefectMaps defects_;
};

}  // namespace

std::unique_ptr<Camera> make_simulated_camera(SimulatedBench& bench, Clock& clock, CameraMake make) {
  return std::make_unique<SimulatedCamera>(bench, clock, make);
}

}  // namespace rig
