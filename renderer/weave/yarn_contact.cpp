#include "renderer/weave/yarn_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace renderer {
namespace {

using Block12 = Eigen::Matrix<double, 12, 12>;

constexpr double kSkin = 0.08;  // of the smallest contact distance

int floor_divide(int a, int b) {
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

double half_width(const ModelYarn& yarn) {
  return yarn.radius_mm * std::sqrt(yarn.flatness);
}
double half_height(const ModelYarn& yarn) {
  return yarn.radius_mm / std::sqrt(yarn.flatness);
}

double least_thickness(const ModelYarn& yarn) {
  return yarn.thickness.empty() ? 1 : *std::min_element(yarn.thickness.begin(), yarn.thickness.end());
}

}  // namespace

// How far apart two yarns are: the length of scale x difference, which is `contact` where they touch.
struct ContactList::Metric {
  Eigen::Vector3d scale;
  double contact;

  Metric(const Section& a, const Section& b) : scale(1, 1, 1), contact(a.half_height + b.half_height) {
    if (a.warp == b.warp) {
      scale[a.warp ? 0 : 1] = contact / (a.half_width + b.half_width);
    } else {
      const Section &warp = a.warp ? a : b, &weft = a.warp ? b : a;
      scale[0] = contact / (warp.half_width + weft.half_height);
      scale[1] = contact / (weft.half_width + warp.half_height);
    }
  }
};

struct ContactList::Touch {
  std::size_t pair;
  Eigen::Vector3d slope;  // of the distance, by the difference a - b
  Eigen::Vector3d scale;
  double distance, contact;
  double factor;  // energy = factor f(distance / contact)
};

// The samples of one segment of a yarn, and the sphere round them.
struct ContactList::Segment {
  int yarn, first, last;  // samples
  Eigen::Vector3d center;
  double radius = 0;
  Eigen::Vector2i square = Eigen::Vector2i::Zero();
  Eigen::Vector2i home = Eigen::Vector2i::Zero();  // periods that bring it into the cell
};

struct ContactList::Neighbour {
  int segment;
  Eigen::Vector2i cell;
};

// Squares over the cell, each at least `reach` wide, so that neighbouring squares hold all that is near. Where squares
// are few, their neighbours are periodic images of themselves.
struct ContactList::Grid {
  Eigen::Vector2d period;
  Eigen::Vector2i squares;
  std::vector<std::vector<int>> members;

  Grid(const Eigen::Vector2d& period_mm, double reach)
      : period(period_mm),
        squares((period_mm / reach).array().floor().min(512.0).max(1.0).cast<int>()),
        members(static_cast<std::size_t>(squares.prod())) {}
  std::vector<int>& at(int column, int row) { return members[static_cast<std::size_t>(row * squares.x() + column)]; }

  void put(int index, Segment& segment) {
    for (int axis = 0; axis < 2; ++axis) {
      const int square = static_cast<int>(std::floor(segment.center[axis] / period[axis] * squares[axis]));
      segment.home[axis] = -floor_divide(square, squares[axis]);
      segment.square[axis] = square + segment.home[axis] * squares[axis];
    }
    at(segment.square.x(), segment.square.y()).push_back(index);
  }

  // The segments of later yarns in the squares round that of `a`, in order.
  void find_neighbours(const Segment& a, const std::vector<Segment>& segments, std::vector<Neighbour>& neighbours) {
    neighbours.clear();
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Eigen::Vector2i square = a.square + Eigen::Vector2i(dx, dy);
        const Eigen::Vector2i turn(floor_divide(square.x(), squares.x()), floor_divide(square.y(), squares.y()));
        const Eigen::Vector2i inside = square - turn.cwiseProduct(squares);
        for (const int k : at(inside.x(), inside.y())) {
          const Segment& b = segments[static_cast<std::size_t>(k)];
          if (a.yarn < b.yarn) neighbours.push_back({k, b.home + turn - a.home});
        }
      }
    }
    std::sort(neighbours.begin(), neighbours.end(), [](const Neighbour& p, const Neighbour& q) {
      return std::tuple(p.segment, p.cell.x(), p.cell.y()) < std::tuple(q.segment, q.cell.x(), q.cell.y());
    });
  }
};

void ContactList::make_samples(const WeaveModel& model) {
  double thinnest = std::numeric_limits<double>::infinity();
  for (const ModelYarn& yarn : model.yarns)
    thinnest = std::min(thinnest, 2 * half_height(yarn) * least_thickness(yarn));
  skin_mm_ = kSkin * thinnest;
  for (std::size_t i = 0; i < model.yarns.size(); ++i) {
    const ModelYarn& yarn = model.yarns[i];
    const double segment_mm = yarn.length_mm / yarn.count;
    const int count = std::max(1, static_cast<int>(std::ceil(segment_mm / (spacing_ * thinnest))));
    for (int k = 0; k < yarn.count; ++k) {
      for (int m = 0; m < count; ++m) {
        const double u = (m + 0.5) / count, thick = profile_value(yarn.thickness, k + u);
        samples_.push_back({static_cast<int>(i), k, spline_weights(u), segment_mm / count,
                            Section{yarn.warp, half_width(yarn) * thick, half_height(yarn) * thick}});
      }
    }
  }
}

Eigen::Matrix3Xd ContactList::positions(const WeaveModel& model, const Eigen::Matrix3Xd& points) const {
  Eigen::Matrix3Xd at(3, static_cast<Eigen::Index>(samples_.size()));
  Eigen::Matrix<double, 3, 4> controls = Eigen::Matrix<double, 3, 4>::Zero();
  int yarn = -1, segment = -1;
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    const Sample& sample = samples_[s];
    if (sample.yarn != yarn || sample.segment != segment) {
      yarn = sample.yarn;
      segment = sample.segment;
      for (int i = 0; i < 4; ++i)
        controls.col(i) =
            position(model, points, point_ref(model.yarns[static_cast<std::size_t>(yarn)], segment - 1 + i));
    }
    at.col(static_cast<Eigen::Index>(s)) = controls * sample.weights;
  }
  return at;
}

void ContactList::update(const WeaveModel& model, const Eigen::Matrix3Xd& points) {
  if (samples_.empty()) make_samples(model);
  const bool same = searched_at_.cols() == points.cols() && searched_period_mm_ == model.period_mm &&
                    (points - searched_at_).colwise().norm().maxCoeff() < skin_mm_ / 2;
  if (!same) search(model, points);
}

std::vector<ContactList::Segment> ContactList::segments_of(const Eigen::Matrix3Xd& at) const {
  std::vector<Segment> segments;
  const auto samples = static_cast<int>(samples_.size());
  for (int first = 0, last = 0; first < samples; first = last) {
    const Sample& sample = samples_[static_cast<std::size_t>(first)];
    while (last < samples && samples_[static_cast<std::size_t>(last)].same_segment(sample)) ++last;
    Segment segment{sample.yarn, first, last, at.middleCols(first, last - first).rowwise().mean()};
    for (int s = first; s < last; ++s) segment.radius = std::max(segment.radius, (at.col(s) - segment.center).norm());
    segments.push_back(segment);
  }
  return segments;
}

// Finds the pairs: first segments that are near each other, by the spheres round their samples, then their samples.
void ContactList::search(const WeaveModel& model, const Eigen::Matrix3Xd& points) {
  searched_at_ = points;
  searched_period_mm_ = model.period_mm;
  pairs_.clear();
  const Eigen::Matrix3Xd at = positions(model, points);
  std::vector<Segment> segments = segments_of(at);
  double largest = 0, widest = 0;
  for (const Segment& segment : segments) largest = std::max(largest, segment.radius);
  for (const Sample& sample : samples_) widest = std::max(widest, 2 * sample.section.half_width);
  Grid grid(model.period_mm, widest + skin_mm_ + 2 * largest);
  for (std::size_t i = 0; i < segments.size(); ++i) grid.put(static_cast<int>(i), segments[i]);
  const auto add_pairs = [&](const Segment& a, const Segment& b, const Eigen::Vector2i& cell) {
    Eigen::Vector3d image = Eigen::Vector3d::Zero();
    image.head<2>() = model.period_mm.cwiseProduct(cell.cast<double>());
    if ((a.center - b.center - image).norm() > widest + skin_mm_ + a.radius + b.radius) return;
    for (int s = a.first; s < a.last; ++s) {
      const Eigen::Vector3d from = at.col(s) - image;
      const Section& section = samples_[static_cast<std::size_t>(s)].section;
      for (int t = b.first; t < b.last; ++t) {
        const Metric metric(section, samples_[static_cast<std::size_t>(t)].section);
        const double reach = metric.contact + skin_mm_;
        if (metric.scale.cwiseProduct(from - at.col(t)).squaredNorm() < reach * reach) pairs_.push_back({s, t, cell});
      }
    }
  };
  std::vector<Neighbour> neighbours;
  for (const Segment& a : segments) {
    grid.find_neighbours(a, segments, neighbours);
    for (const Neighbour& n : neighbours) add_pairs(a, segments[static_cast<std::size_t>(n.segment)], n.cell);
  }
}

template <typename Visit>
void ContactList::for_each_touch(const WeaveModel& model, const Eigen::Matrix3Xd& points, Visit&& visit) const {
  const Eigen::Matrix3Xd at = positions(model, points);
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Pair& pair = pairs_[i];
    const Sample &a = samples_[static_cast<std::size_t>(pair.a)], &b = samples_[static_cast<std::size_t>(pair.b)];
    const Metric metric(a.section, b.section);
    Eigen::Vector3d difference = at.col(pair.a) - at.col(pair.b);
    difference.head<2>() -= model.period_mm.cwiseProduct(pair.cell.cast<double>());
    const Eigen::Vector3d scaled = metric.scale.cwiseProduct(difference);
    const double squared = scaled.squaredNorm();
    if (squared >= metric.contact * metric.contact) continue;
    const double distance = std::sqrt(squared);
    visit(Touch{i, metric.scale.cwiseProduct(scaled) / distance, metric.scale, distance, metric.contact,
                model.contact_n_mm2 / 8 * metric.contact * a.length_mm * b.length_mm});
  }
}

std::array<PointRef, 4> ContactList::refs_of(const WeaveModel& model, int sample, const Eigen::Vector2i& cell) const {
  const Sample& of = samples_[static_cast<std::size_t>(sample)];
  std::array<PointRef, 4> refs;
  for (int i = 0; i < 4; ++i)
    refs[static_cast<std::size_t>(i)] =
        point_ref(model.yarns[static_cast<std::size_t>(of.yarn)], of.segment - 1 + i, cell);
  return refs;
}

void ContactList::add(const WeaveModel& model, const Eigen::Matrix3Xd& points, WeaveDerivatives& sum) const {
  Eigen::Matrix3Xd pull = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(samples_.size()));  // dE / d sample
  const bool curved = sum.curvature != Curvature::none;
  std::vector<Eigen::Matrix3d> own(curved ? samples_.size() : 0, Eigen::Matrix3d::Zero());
  Block12 across = Block12::Zero();  // of the segments of a and b, while pairs of the same segments follow each other
  const Pair* group = nullptr;
  const auto sample = [&](int index) -> const Sample& { return samples_[static_cast<std::size_t>(index)]; };
  const auto close_group = [&] {
    if (group) sum.add_cross_curvature<4>(refs_of(model, group->a), refs_of(model, group->b, group->cell), across);
    across.setZero();
  };
  const auto same_group = [&](const Pair& p, const Pair& q) {
    return sample(p.a).same_segment(sample(q.a)) && sample(p.b).same_segment(sample(q.b)) && p.cell == q.cell;
  };
  for_each_touch(model, points, [&](const Touch& touch) {
    const Pair& pair = pairs_[touch.pair];
    const double q = touch.distance / touch.contact, f = 1 / q - q, f1 = -1 / (q * q) - 1, f2 = 2 / (q * q * q);
    sum.energy += touch.factor * f * f;
    const double push = touch.factor * 2 * f * f1 / touch.contact;  // dE / d distance, negative
    pull.col(pair.a) += push * touch.slope;
    pull.col(pair.b) -= push * touch.slope;
    sum.period_gradient -= push * touch.slope.head<2>().cwiseProduct(pair.cell.cast<double>());
    if (!curved) return;
    const double stiffness = touch.factor * 2 * (f1 * f1 + f * f2) / (touch.contact * touch.contact);
    Eigen::Matrix3d second = stiffness * touch.slope * touch.slope.transpose();
    if (sum.curvature == Curvature::exact) {
      second -= push / touch.distance * touch.slope * touch.slope.transpose();
      second.diagonal() += push / touch.distance * touch.scale.cwiseAbs2();
    }
    own[static_cast<std::size_t>(pair.a)] += second;
    own[static_cast<std::size_t>(pair.b)] += second;
    if (!group || !same_group(*group, pair)) {
      close_group();
      group = &pair;
    }
    for (int p = 0; p < 4; ++p)
      for (int r = 0; r < 4; ++r)
        across.block<3, 3>(3 * p, 3 * r) -= sample(pair.a).weights[p] * sample(pair.b).weights[r] * second;
  });
  close_group();
  hand_to_controls(model, pull, own, sum);
}

// What was summed at samples is handed on to control points, segment by segment.
void ContactList::hand_to_controls(const WeaveModel& model, const Eigen::Matrix3Xd& pull,
                                   const std::vector<Eigen::Matrix3d>& own, WeaveDerivatives& sum) const {
  const bool curved = sum.curvature != Curvature::none;
  for (std::size_t first = 0, last = 0; first < samples_.size(); first = last) {
    Eigen::Matrix<double, 3, 4> slope = Eigen::Matrix<double, 3, 4>::Zero();
    Block12 second = Block12::Zero();
    for (; last < samples_.size() && samples_[last].same_segment(samples_[first]); ++last) {
      const Eigen::Vector4d& w = samples_[last].weights;
      slope += pull.col(static_cast<Eigen::Index>(last)) * w.transpose();
      if (!curved) continue;
      for (int p = 0; p < 4; ++p)
        for (int r = 0; r < 4; ++r) second.block<3, 3>(3 * p, 3 * r) += w[p] * w[r] * own[last];
    }
    const auto refs = refs_of(model, static_cast<int>(first));
    sum.add<4>(refs, slope);
    if (curved) sum.add_curvature<4>(refs, second);
  }
}

double ContactList::deepest_overlap(const WeaveModel& model, const Eigen::Matrix3Xd& points) const {
  double deepest = 0;
  for_each_touch(model, points,
                 [&](const Touch& touch) { deepest = std::max(deepest, touch.contact - touch.distance); });
  return deepest;
}

std::pair<Eigen::Matrix3Xd, Eigen::VectorXd> ContactList::forces(const WeaveModel& model,
                                                                 const Eigen::Matrix3Xd& points) const {
  const auto yarns = static_cast<Eigen::Index>(model.yarns.size());
  Eigen::Matrix3Xd sums = Eigen::Matrix3Xd::Zero(3, yarns);
  Eigen::VectorXd loads = Eigen::VectorXd::Zero(yarns);
  for_each_touch(model, points, [&](const Touch& touch) {
    const double q = touch.distance / touch.contact;
    const Eigen::Vector3d force = touch.factor * 2 * (1 / q - q) * (1 / (q * q) + 1) / touch.contact * touch.slope;
    const int a = samples_[static_cast<std::size_t>(pairs_[touch.pair].a)].yarn,
              b = samples_[static_cast<std::size_t>(pairs_[touch.pair].b)].yarn;
    sums.col(a) += force;
    sums.col(b) -= force;
    loads[a] += force.norm();
    loads[b] += force.norm();
  });
  return {sums, loads};
}

}  // namespace renderer
