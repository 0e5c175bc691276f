#include "calibration/light/colour_chart.h"

#include <ceres/ceres.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "calibration/sensor/degree.h"

namespace calibration {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Vector3d kWhiteD50(0.96422, 1.0, 0.82521);

Matrix3d matrix(std::array<double, 9> rows) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
}

// XYZ under D50 from linear sRGB: IEC 61966-2-1 primaries, then Bradford from D65 to D50.
const Matrix3d& xyz_d50_from_srgb() {
  static const Matrix3d out =
      matrix({1.0478112, 0.0228866, -0.0501270, 0.0295424, 0.9904844, -0.0170491, -0.0092345, 0.0150436, 0.7521316}) *
      matrix({0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339, 0.1191920, 0.9503041});
  return out;
}

constexpr double kKappa = 24389.0 / 27.0, kEpsilon = 216.0 / 24389.0;

template <typename T>
T lab_curve(const T& t) {
  using std::exp, std::log;
  if (t > T(kEpsilon)) return exp(log(t) / 3.0);
  return (kKappa * t + 16.0) / 116.0;
}

template <typename T>
Eigen::Matrix<T, 3, 1> lab_of(const Eigen::Matrix<T, 3, 1>& srgb) {
  const Eigen::Matrix<T, 3, 1> xyz = xyz_d50_from_srgb().cast<T>() * srgb;
  const T x = lab_curve(T(xyz[0] / kWhiteD50[0])), y = lab_curve(T(xyz[1])), z = lab_curve(T(xyz[2] / kWhiteD50[2]));
  return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

// The matrix from two free numbers a row; the third makes the row sum to 1, which keeps white.
template <typename T>
Eigen::Matrix<T, 3, 1> applied(const T* free, const Vector3d& camera) {
  Eigen::Matrix<T, 3, 1> out;
  for (int row = 0; row < 3; ++row)
    out[row] = free[2 * row] * (camera[0] - camera[2]) + free[2 * row + 1] * (camera[1] - camera[2]) + T(camera[2]);
  return out;
}

struct SquareResidual {
  Vector3d camera, lab;

  template <typename T>
  bool operator()(const T* free, T* residual) const {
    const Eigen::Matrix<T, 3, 1> found = lab_of<T>(applied(free, camera));
    for (int i = 0; i < 3; ++i) residual[i] = found[i] - lab[i];
    return true;
  }
};

[[noreturn]] void refuse_chart(const std::string& found, const std::string& what_to_do) {
  throw std::runtime_error("colour chart: " + found + ": " + what_to_do);
}

// Whether the bottom row gets darker from left to right, which no other row or direction of the chart does.
void require_this_chart(const std::vector<Vector3d>& camera) {
  for (std::size_t i = 18; i < 23; ++i)
    if (!(camera[i].sum() > camera[i + 1].sum()))
      refuse_chart("the six grey squares do not darken from white to black",
                   "hold the chart upright, the brown square at the top left, without shadow or gloss");
}

}  // namespace

const std::array<ChartSquare, 24>& colour_chart() {
  static const std::array<ChartSquare, 24> chart{
      {{"dark skin", {37.54, 14.37, 14.92}},     {"light skin", {64.66, 19.27, 17.50}},
       {"blue sky", {49.32, -3.82, -22.54}},     {"foliage", {43.46, -12.74, 22.72}},
       {"blue flower", {54.94, 9.61, -24.79}},   {"bluish green", {70.48, -32.26, -0.37}},
       {"orange", {62.73, 35.83, 56.50}},        {"purplish blue", {39.43, 10.75, -45.17}},
       {"moderate red", {50.57, 48.64, 16.67}},  {"purple", {30.10, 22.54, -20.87}},
       {"yellow green", {71.77, -24.13, 58.19}}, {"orange yellow", {71.51, 18.24, 67.37}},
       {"blue", {28.37, 15.42, -49.80}},         {"green", {54.38, -39.72, 32.27}},
       {"red", {42.43, 51.05, 28.62}},           {"yellow", {81.80, 2.67, 80.41}},
       {"magenta", {50.63, 51.28, -14.12}},      {"cyan", {49.57, -29.71, -28.32}},
       {"white", {95.19, -1.03, 2.93}},          {"neutral 8", {81.29, -0.57, 0.44}},
       {"neutral 6.5", {66.89, -0.75, -0.06}},   {"neutral 5", {50.76, -0.13, 0.14}},
       {"neutral 3.5", {35.63, -0.46, -0.48}},   {"black", {20.64, 0.07, -0.46}}}};
  return chart;
}

Vector3d linear_srgb_of_lab(const Vector3d& lab) {
  const double fy = (lab[0] + 16.0) / 116.0;
  const Vector3d f(fy + lab[1] / 500.0, fy, fy - lab[2] / 200.0);
  Vector3d xyz;
  for (int i = 0; i < 3; ++i) {
    const double cube = f[i] * f[i] * f[i];
    xyz[i] = kWhiteD50[i] * (cube > kEpsilon ? cube : (116.0 * f[i] - 16.0) / kKappa);
  }
  return xyz_d50_from_srgb().inverse() * xyz;
}

Vector3d lab_of_linear_srgb(const Vector3d& linear_srgb) {
  return lab_of<double>(linear_srgb);
}

double delta_e_2000(const Vector3d& lab, const Vector3d& other) {
  const auto power7 = [](double x) { return std::pow(x, 7); };
  const double mean_chroma = 0.5 * (std::hypot(lab[1], lab[2]) + std::hypot(other[1], other[2]));
  const double g = 0.5 * (1.0 - std::sqrt(power7(mean_chroma) / (power7(mean_chroma) + power7(25.0))));
  const double a1 = (1.0 + g) * lab[1], a2 = (1.0 + g) * other[1];
  const double c1 = std::hypot(a1, lab[2]), c2 = std::hypot(a2, other[2]);
  const auto hue = [&](double a, double b) {
    const double h = std::atan2(b, a) / kDegree;
    return h < 0.0 ? h + 360.0 : h;
  };
  const double h1 = hue(a1, lab[2]), h2 = hue(a2, other[2]);
  double dh = h2 - h1;
  if (c1 * c2 == 0.0) dh = 0.0;
  if (dh > 180.0) dh -= 360.0;
  if (dh < -180.0) dh += 360.0;
  const double dl = other[0] - lab[0], dc = c2 - c1, dhue = 2.0 * std::sqrt(c1 * c2) * std::sin(0.5 * dh * kDegree);
  const double l = 0.5 * (lab[0] + other[0]), c = 0.5 * (c1 + c2);
  double h = 0.5 * (h1 + h2);
  if (c1 * c2 == 0.0)
    h = h1 + h2;
  else if (std::abs(h1 - h2) > 180.0)
    h += h < 180.0 ? 180.0 : -180.0;
  const double t = 1.0 - 0.17 * std::cos((h - 30.0) * kDegree) + 0.24 * std::cos(2.0 * h * kDegree) +
                   0.32 * std::cos((3.0 * h + 6.0) * kDegree) - 0.20 * std::cos((4.0 * h - 63.0) * kDegree);
  const double off = (l - 50.0) * (l - 50.0);
  const double sl = 1.0 + 0.015 * off / std::sqrt(20.0 + off), sc = 1.0 + 0.045 * c, sh = 1.0 + 0.015 * c * t;
  const double turn = 30.0 * std::exp(-std::pow((h - 275.0) / 25.0, 2));
  const double rc = 2.0 * std::sqrt(power7(c) / (power7(c) + power7(25.0)));
  const double rt = -std::sin(2.0 * turn * kDegree) * rc;
  const double x = dl / sl, y = dc / sc, z = dhue / sh;
  return std::sqrt(x * x + y * y + z * z + rt * y * z);
}

ColourFit fit_colours(const std::vector<Vector3d>& camera) {
  const auto& chart = colour_chart();
  if (camera.size() != chart.size())
    refuse_chart(
        std::to_string(camera.size()) + " squares were measured, the chart has " + std::to_string(chart.size()),
        "bring the whole chart into the picture");
  for (std::size_t i = 0; i < camera.size(); ++i)
    if (!camera[i].allFinite())
      refuse_chart("square \"" + chart[i].name + "\" has no finite value", "take the picture again");
  require_this_chart(camera);
  std::array<double, 6> free{1, 0, 0, 1, 0, 0};
  ceres::Problem problem;
  for (std::size_t i = 0; i < camera.size(); ++i)
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<SquareResidual, 3, 6>(new SquareResidual{camera[i], chart[i].lab_d50}), nullptr,
        free.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  ColourFit fit;
  for (int row = 0; row < 3; ++row)
    fit.linear_srgb_from_camera.row(row) << free[2 * row], free[2 * row + 1], 1.0 - free[2 * row] - free[2 * row + 1];
  for (std::size_t i = 0; i < camera.size(); ++i) {
    const double delta = delta_e_2000(chart[i].lab_d50, lab_of_linear_srgb(fit.linear_srgb_from_camera * camera[i]));
    fit.delta_e.push_back(delta);
    fit.mean_delta_e += delta / static_cast<double>(camera.size());
    fit.largest_delta_e = std::max(fit.largest_delta_e, delta);
  }
  fit.gates = {at_most("colour: mean CIEDE2000 over the chart", fit.mean_delta_e, 4.0,
                       "beyond that pictures for people mislead; see that only the lamp shines and nothing glosses"),
               at_most("colour: largest CIEDE2000 over the chart", fit.largest_delta_e, 12.0,
                       "one square is far off; see that nothing shades or glosses on it, or replace the chart")};
  return fit;
}

}  // namespace calibration
