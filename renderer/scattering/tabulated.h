// The simulation itself as a scattering model: tables of the azimuthal distribution over inclination and absorption,
// interpolated. An oracle for the thread model: nothing is fitted, but nothing is known about the offset h either (a
// table is the mean over the thread's width) and the longitudinal part is one lobe around the specular cone.
//
//   f_cos = M(theta_o, theta_i; v) p(phi | |theta_o|, sigma_a)                                   (RGB; lobes.h)
//
// p is constant within a bin of azimuth, linear in |theta_o| and in the absorption between the table's nodes; beyond the
// last node the last one holds.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "renderer/scattering/lobes.h"
#include "renderer/scattering/multi_fiber.h"

namespace renderer {

struct AzimuthalTable {
  std::vector<double> thetas_rad;   // rising, from 0
  std::vector<double> absorptions;  // per fiber radius, rising, from 0
  // Per radian, bin i of n covers -pi + [i, i+1] 2 pi / n; [theta][absorption].
  std::vector<std::vector<Eigen::ArrayXd>> densities;
};

// 16 inclinations from 0 to 85 degrees in even steps and 16 absorptions: 0 and 0.003 to 3 per fiber radius
// in even ratios. The thread, rays, bins and seed as in `options`; its theta, absorption and progress are not used.
AzimuthalTable simulate_table(MultiFiberOptions options, const std::function<bool(double)>& progress = {});

struct TabulatedParameters {
  Eigen::Vector3d sigma_a = Eigen::Vector3d::Zero();  // per fiber radius, RGB
  double alpha = 0.3;                                 // longitudinal roughness, 0.02 .. 1 (perceptual)
};

class TabulatedModel;

// The distribution as seen from one direction o, whatever the offset. Refers to the model.
class TabulatedLobes {
 public:
  ScatteringValue<double> evaluate(const Vec3<double>& wi) const;
  Vec3<double> sample(double u_lobe, double u_theta, double u_ring, double u_phi) const;
  Rgb<double> albedo() const;

 private:
  friend class TabulatedModel;
  const TabulatedModel* model_ = nullptr;
  Eigen::Vector2d azimuth_o_;
  double sin_theta_o_ = 0, cos_theta_o_ = 1;
  std::size_t below_ = 0;  // node of the inclination, and the share of the next one
  double share_ = 0;
};

class TabulatedModel {
 public:
  // Throws std::invalid_argument when the table is not of the shape above.
  TabulatedModel(const AzimuthalTable& table, const TabulatedParameters& parameters);
  TabulatedLobes lobes_at(double h, const Vec3<double>& wo) const;

 private:
  friend class TabulatedLobes;
  // One inclination with the model's three absorptions.
  struct Row {
    Eigen::Array<double, Eigen::Dynamic, 3> density;  // bins x RGB
    Eigen::ArrayXd cumulative;                        // of the mean colour, 1 at the end; what is sampled
  };
  std::vector<double> thetas_;
  std::vector<Row> rows_;
  int bins_ = 0;
  LobeWidths<double> widths_;  // lane 0
};

}  // namespace renderer
