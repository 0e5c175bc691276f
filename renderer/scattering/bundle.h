// Scattering of a thread that is described by its fibers: a bundle of equal parallel fibers, each of which scatters as
// fiber.h says. A ray that meets the thread meets the fibers of a bundle that is drawn for it (BundleSections), so that
// many rays see the mean over all bundles, as in the simulation of multi_fiber.h.
//
//   parameter    | unit             | default | differentiable
//   fiber_count  | >= 1             | 20      | no   fibers of the thread
//   radius_ratio | 0 .. 1           | 0.15    | no   fiber radius / thread radius; packing fiber_count radius_ratio^2
//   eta          | -                | 1.55    | yes  as in fiber.h, and so are the others
//   sigma_a      | 1 / fiber radius | 0       | yes
//   beta_m       | 0.02 .. 1        | 0.3     | yes
//   beta_n       | 0.02 .. 1        | 0.3     | yes
//
// Where light leaves, how dyes change the width of what passes, and how much passes between fibers are not stated but
// follow. The price is some four scattering events per thread instead of one.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <mutex>
#include <vector>

#include "renderer/scattering/circle_grid.h"
#include "renderer/scattering/fiber.h"

namespace renderer {

struct BundleParameters {
  int fiber_count = 20;
  double radius_ratio = 0.15;  // fiber radius / thread radius
  FiberParameters fiber{};     // of each, without tilt
};

// Bundles placed at random, in units of the fiber's radius, for sections between round and eight times as wide as high:
// as many of the fibers as find room. Where a section is lower than a fiber is thick, they are those of one as high.
class BundleSections {
 public:
  static constexpr double kMostFlat = 8;

  BundleSections(int fiber_count, double radius_ratio);

  // Bundle number `draw` of sections that are about `flatness` >= 1 times as wide (x) as high. Those of a flatness are
  // placed when first asked for; any number of threads may ask at a time.
  const CircleGrid& section(double flatness, int draw) const;
  int draws() const { return draws_; }  // of each flatness; more where few fibers make bundles unlike each other
  double radius_ratio() const { return radius_ratio_; }

 private:
  static constexpr int kLevels = 25;  // of flatness

  struct Level {
    std::once_flag once;
    std::vector<CircleGrid> draws;
  };

  int fiber_count_, draws_;
  double radius_ratio_;
  mutable std::array<Level, kLevels> levels_;
};

// The bundles of so many such fibers, which the program keeps for all who ask.
std::shared_ptr<const BundleSections> bundle_sections(int fiber_count, double radius_ratio);

// The model of the fibers with the bundles that they make.
class BundleModel {
 public:
  explicit BundleModel(const BundleParameters& parameters)
      : fiber_(in_scalar<float>(parameters.fiber)),
        sections_(bundle_sections(parameters.fiber_count, parameters.radius_ratio)) {}

  // The lobes of one fiber at offset h from unit direction wo (local frame).
  CurveLobes<float> lobes_at(float h, const Vec3<float>& wo) const { return fiber_.lobes_at(h, wo); }
  const BundleSections& sections() const { return *sections_; }

 private:
  FiberModel<float> fiber_;
  std::shared_ptr<const BundleSections> sections_;
};

}  // namespace renderer
