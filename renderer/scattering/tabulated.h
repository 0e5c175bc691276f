// A scattering model that is the simulation itself: tables of the azimuthal distribution over inclination and
// absorption, interpolated. It is a reference for the thread model: nothing in it is fitted, but it knows nothing about
// the offset h (a table is the mean over the thread's width), and its longitudinal part is a single lobe around the
// specular cone.
//
//   f_cos = M(theta_o, theta_i; v) p(phi | |theta_o|, sigma_a)                                   (RGB; lobes.h)
//
// p is constant within a bin of azimuth and linear in |theta_o| and in the absorption between the table's nodes; beyond
// the last node it stays as it is there.
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
  // [theta][absorption], per radian; bin i of n covers -pi + [i, i+1] 2 pi / n.
  std::vector<std::vector<Eigen::ArrayXd>> densities;
};

// Simulates the table: 16 inclinations from 0 to 85 degrees in even steps and 16 absorptions, 0 and 0.003 to 3 per
// fiber radius in even ratios. Thread, rays, bins and seed are those of `options`, whose theta, absorption and progress
// are not used.
AzimuthalTable simulate_table(MultiFiberOptions options, const std::function<bool(double)>& progress = {});

struct TabulatedParameters {
  Eigen::Vector3d sigma_a = Eigen::Vector3d::Zero();  // per fiber radius, RGB
  double alpha = 0.3;                                 // longitudinal roughness, 0.02 .. 1 (perceptual)
};

class TabulatedModel;

// The distribution as seen from one direction o, whatever the offset. It refers to the model and must not outlive it.
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
  std::size_t below_ = 0;  // node of the inclination; share_ is the weight of the next node
  double share_ = 0;
};

class TabulatedModel {
 public:
  // Errors: std::invalid_argument when the table's nodes do not rise from 0 or its sizes do not fit together.
  TabulatedModel(const AzimuthalTable& table, const TabulatedParameters& parameters);
  TabulatedLobes lobes_at(double h, const Vec3<double>& wo) const;

 private:
  friend class TabulatedLobes;
  // The distributions at one inclination for the model's three absorptions.
  struct Row {
    Eigen::Array<double, Eigen::Dynamic, 3> density;  // bins x RGB
    Eigen::ArrayXd cumulative;                        // of the mean colour, 1 at the end; directions are sampled by it
  };
  std::vector<double> thetas_;
  std::vector<Row> rows_;
  int bins_ = 0;
  LobeWidths<double> widths_;  // only lane 0 is used
};

}  // namespace renderer
