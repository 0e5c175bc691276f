#include "station/documents/sensor_section.h"

#include <array>
#include <stdexcept>

#include "renderer/picture/image_file.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/gate_list.h"

namespace station {
namespace {

using nlohmann::json;
constexpr double kMostOfSensor = 1e9;

void require_same(const std::filesystem::path& file, const std::string& sha256) {
  if (!std::filesystem::is_regular_file(file) || sha256_of_file(file) != sha256)
    throw std::runtime_error(
        file.string() + " is missing or differs from the calibration's hash; solve it again with calibrate --solve");
}

}  // namespace

json to_json(const SensorSection& sensor) {
  const calibration::SensorResponse& response = sensor.response;
  json shutter = json::array();
  for (const calibration::ShutterTime& time : response.shutter)
    shutter.push_back({{"nominal_s", time.nominal_s}, {"true_s", time.true_s}, {"sigma_s", time.sigma_s}});
  json section{{"iso", response.iso},
               {"f_number", response.f_number},
               {"bias_dn", sensor.bias_dn},
               {"dark_dn_per_s", sensor.dark_dn_per_s},
               {"gain_dn_per_e", response.gain_dn_per_e},
               {"gain_sigma", response.gain_sigma},
               {"read_noise_e", response.read_noise_e},
               {"read_noise_sigma", response.read_noise_sigma},
               {"nonlinearity", response.nonlinearity},
               {"nonlinearity_sigma", response.nonlinearity_sigma},
               {"linearity_residual", sensor.linearity_residual},
               {"shutter", shutter},
               {"bad_pixels", {{"hot", sensor.bad.hot}, {"noisy", sensor.bad.noisy}, {"dead", sensor.bad.dead}}},
               {"dust_depth", sensor.dust_depth},
               {"flat_noise", sensor.flat_noise},
               {"lamp_flicker", sensor.lamp_flicker},
               {"lamp_drift_per_min", sensor.lamp_drift_per_min},
               {"lamp_drift_sigma_per_min", sensor.lamp_drift_sigma_per_min},
               {"gates", to_json(sensor.gates)}};
  if (has_map_files(sensor))
    section.update({{"maps_sha256", sensor.maps_sha256}, {"bad_pixels_sha256", sensor.bad_pixels_sha256}});
  return section;
}

SensorSection parse_sensor_section(ObjectReader reader) {
  SensorSection sensor;
  calibration::SensorResponse& response = sensor.response;
  response.iso = reader.integer("iso", 1, 1 << 24);
  response.f_number = reader.number("f_number", 0.1, 1000);
  sensor.bias_dn = reader.number("bias_dn", -kMostOfSensor, kMostOfSensor);
  sensor.dark_dn_per_s = reader.number("dark_dn_per_s", -kMostOfSensor, kMostOfSensor);
  response.gain_dn_per_e = reader.number("gain_dn_per_e", 1e-9, kMostOfSensor);
  response.gain_sigma = reader.number("gain_sigma", 0, kMostOfSensor);
  response.read_noise_e = reader.number("read_noise_e", 0, kMostOfSensor);
  response.read_noise_sigma = reader.number("read_noise_sigma", 0, kMostOfSensor);
  response.nonlinearity = reader.number("nonlinearity", -1, 1);
  response.nonlinearity_sigma = reader.number("nonlinearity_sigma", 0, kMostOfSensor);
  sensor.linearity_residual = reader.number("linearity_residual", 0, kMostOfSensor);
  for (ObjectReader& entry : reader.objects("shutter")) {
    response.shutter.push_back({.nominal_s = entry.number("nominal_s", 1e-9, 1e6),
                                .true_s = entry.number("true_s", 1e-9, 1e6),
                                .sigma_s = entry.number("sigma_s", 0, 1e6)});
    entry.finish();
  }
  ObjectReader bad = reader.object("bad_pixels");
  sensor.bad = {.hot = bad.integer("hot", 0, 1 << 30),
                .noisy = bad.integer("noisy", 0, 1 << 30),
                .dead = bad.integer("dead", 0, 1 << 30)};
  bad.finish();
  sensor.dust_depth = reader.number("dust_depth", -kMostOfSensor, kMostOfSensor);
  sensor.flat_noise = reader.number("flat_noise", 0, kMostOfSensor);
  sensor.lamp_flicker = reader.number("lamp_flicker", 0, kMostOfSensor);
  sensor.lamp_drift_per_min = reader.number("lamp_drift_per_min", -kMostOfSensor, kMostOfSensor);
  sensor.lamp_drift_sigma_per_min = reader.number("lamp_drift_sigma_per_min", 0, kMostOfSensor);
  if (reader.has("maps_sha256") || reader.has("bad_pixels_sha256")) {  // both or none
    sensor.maps_sha256 = reader.text("maps_sha256");
    sensor.bad_pixels_sha256 = reader.text("bad_pixels_sha256");
  }
  sensor.gates = parse_gates(reader, "gates");
  reader.finish();
  return sensor;
}

void write_sensor_maps(const std::filesystem::path& folder, SensorSection& sensor) {
  const calibration::SensorMaps& maps = sensor.response.maps;
  const std::array<cv::Mat1f, 3> planes{maps.bias_dn, maps.dark_dn_per_s, maps.flat};
  cv::Mat3f picture;
  cv::merge(planes.data(), planes.size(), picture);
  renderer::write_exr(folder / kSensorMapsFile, picture,
                      {{"threadstation/content", "sensor pixels: R bias, DN; G dark current, DN per second; B flat"}});
  renderer::write_png(folder / kBadPixelsFile, maps.bad);
  sensor.maps_sha256 = sha256_of_file(folder / kSensorMapsFile);
  sensor.bad_pixels_sha256 = sha256_of_file(folder / kBadPixelsFile);
}

bool has_map_files(const SensorSection& sensor) {
  return !sensor.maps_sha256.empty();
}

void fill_in_sensor_maps(const std::filesystem::path& folder, const cv::Size& size, SensorSection& sensor) {
  calibration::SensorMaps& maps = sensor.response.maps;
  if (!has_map_files(sensor)) {
    maps = {.bias_dn = cv::Mat1f(size, static_cast<float>(sensor.bias_dn)),
            .dark_dn_per_s = cv::Mat1f(size, static_cast<float>(sensor.dark_dn_per_s)),
            .flat = cv::Mat1f(size, 1.0F),
            .bad = cv::Mat1b(size, uchar{0})};
    return;
  }
  require_same(folder / kSensorMapsFile, sensor.maps_sha256);
  require_same(folder / kBadPixelsFile, sensor.bad_pixels_sha256);
  std::array<cv::Mat1f, 3> planes;
  cv::split(renderer::read_exr(folder / kSensorMapsFile), planes.data());
  maps.bias_dn = planes[0];
  maps.dark_dn_per_s = planes[1];
  maps.flat = planes[2];
  maps.bad = renderer::read_png_grey(folder / kBadPixelsFile);
}

}  // namespace station
