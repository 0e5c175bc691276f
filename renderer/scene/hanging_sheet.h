// Cloth on its way to rest, by position-based dynamics [Macklin 2016, doi 10.1145/2994258.2994272]; z is up.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace renderer {

// Points lie in rows; a closed sheet's last column is followed by its first.
class HangingSheet {
 public:
  using Pattern = std::function<Eigen::Vector2d(int column, int row)>;  // mm; alike from column to column

  struct Size {
    int columns, rows;  // of points
    bool closed = false;
  };
  // How much it gives way to bending over two and over five cells: compliance of a unit mass, s^2.
  struct Bending {
    double near_s2, far_s2;
  };

  // `places`: columns x rows of them, row after row, mm.
  HangingSheet(const Size& size, const Bending& bending, const Pattern& pattern, std::vector<Eigen::Vector3d> places);

  void pin_row(int row);
  // Nothing gets further away from this row, within its column, than the pattern says (long-range attachments [Kim
  // 2012, doi 10.2312/SCA/SCA12/305-310]): long cloth would be stretched by its weight otherwise, because few sweeps do
  // not carry a pull that far. The row is pinned.
  void hang_from_row(int row, const Pattern& pattern);

  // Folds stay beside one another: the points of each row keep their order along this unit vector. It stands for what
  // cloth does to cloth where rows are pleated across it.
  void keep_order(const Eigen::Vector3d& along) { order_ = along; }

  // Cloth does not pass through itself: points that are no neighbours in the pattern stay .7 of a cell apart from
  // each other, found by spatial hashing [Teschner 2003, Vision, Modeling, Visualization].
  void meet_itself(const Pattern& pattern);

  // `body.outside(place)`: the nearest place outside of what the cloth lies on.
  template <class Body>
  void settle(int steps, int sweeps, const Body& body, const std::function<void(int steps_done)>& go_on) {
    constexpr double kGravity = -9810, kKept = 0.98;  // of the speed, after each step
    std::vector<Eigen::Vector3d> speeds(places_.size(), Eigen::Vector3d::Zero());
    for (int step = 0; step < steps; ++step) {
      go_on(step);
      const std::vector<Eigen::Vector3d> before = places_;
      for (std::size_t i = 0; i < places_.size(); ++i)
        places_[i] += kStep_s * (kKept * speeds[i] + Eigen::Vector3d(0, 0, kGravity * kStep_s));
      if (pattern_) find_near_points();
      for (int sweep = 0; sweep < sweeps; ++sweep) {
        pull_links();
        part_near_points();
        if (order_) part_folds();
        for (std::size_t i = 0; i < places_.size(); ++i) keep_outside(body, before[i], places_[i]);
        for (const std::uint32_t i : pinned_) places_[i] = before[i];
      }
      for (std::size_t i = 0; i < places_.size(); ++i) speeds[i] = (places_[i] - before[i]) / kStep_s;
    }
  }

  const std::vector<Eigen::Vector3d>& places() const { return places_; }

  // Takes creases out: each place goes half the way to the middle of those beside it, so many times.
  void smooth(int times);

  // A smooth surface through about the same places, `finer` times as fine: a uniform cubic B-spline.
  std::vector<Eigen::Vector3d> refined(int finer) const;

 private:
  static constexpr double kStep_s = 1 / 240.0;
  static constexpr double kFriction = 0.6;  // of a slide that is held back, each sweep
  struct Link {
    std::uint32_t a, b;
    double length_mm, yielding;  // the share of its stretch that each end takes
  };
  struct Leash {
    std::uint32_t point, pin;
    double most_mm;
  };

  struct NearPoints {
    std::uint32_t a, b;
    double least_mm;
  };

  std::uint32_t index(int column, int row) const { return static_cast<std::uint32_t>(row * size_.columns + column); }
  Eigen::Vector3d control(int column, int row) const;
  void add_links(const Pattern& pattern, const Bending& bending);
  void pull_links();
  void part_folds();
  bool are_neighbours(std::uint32_t a, std::uint32_t b, double within_mm) const;
  void find_near_points();
  void part_near_points();

  template <class Body>
  static void keep_outside(const Body& body, const Eigen::Vector3d& before, Eigen::Vector3d& at) {
    const Eigen::Vector3d out = body.outside(at);
    if (out == at) return;
    const Eigen::Vector3d outwards = (out - at).normalized(), slid = out - before;
    at = out - kFriction * (slid - slid.dot(outwards) * outwards);
  }

  Size size_;
  std::vector<Eigen::Vector3d> places_;
  std::vector<std::uint32_t> pinned_{};
  std::vector<Link> links_{};
  std::vector<Leash> leashes_{};
  std::optional<Eigen::Vector3d> order_{};
  Pattern pattern_{};               // where it meets itself
  std::vector<double> apart_mm_{};  // of each point: half of what others stay away
  std::vector<NearPoints> near_{};  // of this step
};

}  // namespace renderer
