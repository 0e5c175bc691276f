// The contact of yarns: all points of two yarns that come closer than their sections are thick push each other apart.
//
//   E = K / (8 D) double integral of D^2 f(d / D) over the arcs of both yarns,   f(q) = (1/q - q)^2 for q < 1, else 0
//
// with d the distance of the two points and D the sum of both radii; for shallow overlaps the integrand with its factor
// is K / (2 D) (D - d)^2. The integrals are sums over samples, `spacing` D apart or closer. Periodic images count; a
// yarn does not touch itself. For flattened sections (half width a, half height b) d is measured with x and y shrunk so
// that contact begins in z at the sum of both b; in the plane between crossing yarns, across each of them, at the sum
// of its own a and the other's b; and between yarns side by side at the sum of both a. Where thickness varies along a
// yarn, each sample has the section of its place.
//
// Source: Kaldor et al. 2008. A single integral over samples and closest points was tried and refused: where yarns wrap
// each other, a yarn's crown is the centre of the other's arc, so that the closest point may be anywhere on that arc,
// and the energy has a kink at just the shape that is sought.
#pragma once

#include "renderer/weave/weave_model.h"

namespace renderer {

// The list of pairs of samples that may touch, found by a spatial hash and kept until points have moved by half of what
// the search reached beyond contact.
class ContactList {
 public:
  explicit ContactList(double spacing = 0.03) : spacing_(spacing) {}

  // Finds the pairs anew where that is needed; must be called before the others, with the same points.
  void update(const WeaveModel& model, const Eigen::Matrix3Xd& points);
  // Adds the energy of contact and its derivatives to `sum`.
  void add(const WeaveModel& model, const Eigen::Matrix3Xd& points, WeaveDerivatives& sum) const;

  // The deepest overlap, mm; and for each yarn the sum of the contact forces on it and the sum of their magnitudes, N.
  double deepest_overlap(const WeaveModel& model, const Eigen::Matrix3Xd& points) const;
  std::pair<Eigen::Matrix3Xd, Eigen::VectorXd> forces(const WeaveModel& model, const Eigen::Matrix3Xd& points) const;

 private:
  struct Section {
    bool warp;
    double half_width, half_height;  // mm
  };
  struct Sample {
    int yarn = 0, segment = 0;
    Eigen::Vector4d weights;  // of the segment's control points
    double length_mm = 0;
    Section section;

    bool same_segment(const Sample& other) const { return yarn == other.yarn && segment == other.segment; }
  };
  struct Pair {
    int a = 0, b = 0;                                // samples; the yarn of a comes before that of b
    Eigen::Vector2i cell = Eigen::Vector2i::Zero();  // image of b
  };
  struct Metric;
  struct Touch;
  struct Segment;
  struct Neighbour;
  struct Grid;

  void make_samples(const WeaveModel& model);
  Eigen::Matrix3Xd positions(const WeaveModel& model, const Eigen::Matrix3Xd& points) const;
  std::vector<Segment> segments_of(const Eigen::Matrix3Xd& at) const;
  void search(const WeaveModel& model, const Eigen::Matrix3Xd& points);
  template <typename Visit>
  void for_each_touch(const WeaveModel& model, const Eigen::Matrix3Xd& points, Visit&& visit) const;
  std::array<PointRef, 4> refs_of(const WeaveModel& model, int sample,
                                  const Eigen::Vector2i& cell = Eigen::Vector2i::Zero()) const;
  void hand_to_controls(const WeaveModel& model, const Eigen::Matrix3Xd& pull, const std::vector<Eigen::Matrix3d>& own,
                        WeaveDerivatives& sum) const;

  double spacing_, skin_mm_ = 0;
  std::vector<Sample> samples_;
  std::vector<Pair> pairs_;  // sorted by segment of a, segment of b and image
  Eigen::Matrix3Xd searched_at_;
  Eigen::Vector2d searched_period_mm_ = Eigen::Vector2d::Zero();
};

}  // namespace renderer
