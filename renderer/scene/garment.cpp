#include "renderer/scene/garment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "renderer/scattering/degree.h"
#include "renderer/scene/grid_triangles.h"

namespace renderer {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Points at equal steps of length along a finely drawn line, both ends included.
std::vector<Vector2d> by_length(const std::vector<Vector2d>& line, int steps) {
  std::vector<double> along{0};
  for (std::size_t i = 1; i < line.size(); ++i) along.push_back(along.back() + (line[i] - line[i - 1]).norm());
  std::vector<Vector2d> points;
  std::size_t i = 1;
  for (int step = 0; step <= steps; ++step) {
    const double at = along.back() * step / steps;
    while (i + 1 < line.size() && along[i] < at) ++i;
    const double part = (at - along[i - 1]) / std::max(along[i] - along[i - 1], 1e-12);
    points.push_back(line[i - 1] + std::clamp(part, 0.0, 1.0) * (line[i] - line[i - 1]));
  }
  return points;
}

// A line that folds: each point lies at base + amplitude x fold.
struct FoldedLine {
  std::vector<Vector2d> base, fold;

  std::vector<Vector2d> at(double amplitude) const {
    std::vector<Vector2d> line;
    for (std::size_t i = 0; i < base.size(); ++i) line.emplace_back(base[i] + amplitude * fold[i]);
    return line;
  }
  double length(double amplitude) const {
    double sum = 0;
    for (std::size_t i = 1; i < base.size(); ++i)
      sum += (base[i] - base[i - 1] + amplitude * (fold[i] - fold[i - 1])).norm();
    return sum;
  }
};

// The line at the smallest amplitude >= 0 at which it is `wanted` long.
std::vector<Vector2d> folded_to(double wanted, double most, const FoldedLine& line) {
  double low = 0, high = most;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (line.length(middle) < wanted ? low : high) = middle;
  }
  return line.at(high);
}

// Rows of points that hang below one another, `step_mm` of cloth apart on average.
std::vector<double> heights_of(const std::vector<std::vector<Vector2d>>& rows, double step_mm) {
  std::vector<double> heights{0};
  for (std::size_t row = 1; row < rows.size(); ++row) {
    double sideways2 = 0;
    for (std::size_t i = 0; i < rows[row].size(); ++i)
      sideways2 += (rows[row][i] - rows[row - 1][i]).squaredNorm() / static_cast<double>(rows[row].size());
    heights.push_back(heights.back() - std::sqrt(std::max(0.04 * step_mm * step_mm, step_mm * step_mm - sideways2)));
  }
  return heights;
}

// The mesh of the rows, from the lowest upwards, so that triangles turn towards the face; the lowest row is at z = 0.
template <class Uv>
UvMesh hanging_mesh(const std::vector<std::vector<Vector2d>>& rows, double step_mm, const Uv& uv) {
  const std::vector<double> heights = heights_of(rows, step_mm);
  const auto across = static_cast<int>(rows.front().size()) - 1, down = static_cast<int>(rows.size()) - 1;
  UvMesh mesh{.triangles = grid_triangles(across, down)};
  for (int row = down; row >= 0; --row)
    for (int column = 0; column <= across; ++column) {
      const auto r = static_cast<std::size_t>(row);
      const Vector2d& at = rows[r][static_cast<std::size_t>(column)];
      mesh.vertices.emplace_back(at.x(), at.y(), heights[r] - heights.back());
      mesh.uv.push_back(uv(column, row));
    }
  return mesh;
}

constexpr int kFine = 4096;  // points of a line whose length is measured

struct Maker {
  const std::function<bool(double)>& progress;

  void go_on(double finished) const {
    if (progress && !progress(finished)) throw std::runtime_error("the draping was stopped on request; start it again");
  }

  UvMesh operator()(const SkirtShape& s) const {
    constexpr int kAcross = 720, kDown = 180;
    const double sector_rad = s.flare_deg * kDegree, inner_mm = 2 * std::numbers::pi * s.waist_radius_mm / sector_rad;
    const double step_mm = s.length_mm / kDown;
    std::vector<std::vector<Vector2d>> rings;
    for (int row = 0; row <= kDown; ++row) {
      go_on(static_cast<double>(row) / (kDown + 1));
      const double ring_mm = sector_rad * (inner_mm + row * step_mm);  // length in the pattern
      const double even_mm = ring_mm / (2 * std::numbers::pi), part = static_cast<double>(row) / kDown;
      // A ring gets wider by a third of what it could; the rest goes into folds.
      const double radius_mm = s.waist_radius_mm + 0.33 * (even_mm - s.waist_radius_mm);
      FoldedLine ring;
      for (int i = 0; i <= kFine; ++i) {
        const double angle = 2 * std::numbers::pi * (i % kFine) / kFine;
        const double wave = s.folds * angle + 0.9 * std::sin(2 * angle) + 0.35 * part * std::sin(3 * angle + 1);
        const Vector2d outwards(std::cos(angle), std::sin(angle));
        ring.base.emplace_back(radius_mm * outwards);
        ring.fold.emplace_back(std::cos(wave) * (1 + 0.2 * std::sin(angle + 0.7)) * outwards);
      }
      rings.push_back(by_length(folded_to(ring_mm, radius_mm, ring), kAcross));
    }
    return hanging_mesh(rings, step_mm, [&](int column, int row) {
      const double angle = sector_rad * column / kAcross, radius = inner_mm + row * step_mm;
      return Vector2d(radius * std::sin(angle), -radius * std::cos(angle));
    });
  }

  UvMesh operator()(const PleatedShape& s) const {
    constexpr int kAcross = 600, kDown = 160;
    const double step_mm = s.height_mm / kDown;
    std::vector<std::vector<Vector2d>> rows;
    for (int row = 0; row <= kDown; ++row) {
      go_on(static_cast<double>(row) / (kDown + 1));
      const double part = static_cast<double>(row) / kDown;
      const double hung_mm = s.width_mm * (s.gathered + 0.5 * (0.9 - s.gathered) * part);
      FoldedLine hung;
      for (int i = 0; i <= kFine; ++i) {
        const double x = static_cast<double>(i) / kFine;
        const double wave = 2 * std::numbers::pi * (s.pleats * x + 0.35 * part * std::sin(5 * x + 1));
        hung.base.emplace_back(hung_mm * (x - 0.5) + 0.12 * s.width_mm * part * part, 0);
        hung.fold.emplace_back(0, std::sin(wave + 0.3 * std::sin(wave)));
      }
      rows.push_back(by_length(folded_to(s.width_mm, s.width_mm / s.pleats, hung), kAcross));
    }
    return hanging_mesh(rows, step_mm, [&](int column, int row) {
      return Vector2d(s.width_mm * column / kAcross, s.height_mm - row * step_mm);
    });
  }

  UvMesh operator()(const DrapeShape& s) const;
};

// A square grid of cloth on its way to rest over a ball at the origin; z is up.
class HangingGrid {
 public:
  HangingGrid(const DrapeShape& shape, int side) : shape_(shape), side_(side), cell_mm_(shape.side_mm / side) {
    // The cloth lies a little turned and off the middle, as nobody lays a cloth exactly.
    for (int row = 0; row <= side; ++row)
      for (int column = 0; column <= side; ++column) {
        const Vector2d at = cell_mm_ * Vector2d(column, row) - Vector2d::Constant(shape.side_mm / 2);
        const Vector2d laid = Eigen::Rotation2Dd(0.3) * at + Vector2d(0.02, 0.01) * shape.side_mm;
        places_.emplace_back(laid.x(), laid.y(), shape.ball_radius_mm + 2 * kClearance_mm);
      }
    add_links();
  }

  // The same cloth with cells of half the size: new points lie between the old ones.
  HangingGrid refined() const {
    HangingGrid fine(shape_, 2 * side_);
    for (int row = 0; row <= fine.side_; ++row)
      for (int column = 0; column <= fine.side_; ++column)
        fine.places_[fine.index(column, row)] =
            (places_[index(column / 2, row / 2)] + places_[index((column + 1) / 2, row / 2)] +
             places_[index(column / 2, (row + 1) / 2)] + places_[index((column + 1) / 2, (row + 1) / 2)]) /
            4;
    return fine;
  }

  void settle(int steps, const std::function<void(int steps_done)>& go_on) {
    constexpr double kGravity = -9810, kKept = 0.98;  // of the speed, after each step
    constexpr int kSweeps = 20;
    std::vector<Vector3d> speeds(places_.size(), Vector3d::Zero());
    for (int step = 0; step < steps; ++step) {
      go_on(step);
      const std::vector<Vector3d> before = places_;
      for (std::size_t i = 0; i < places_.size(); ++i)
        places_[i] += kStep_s * (kKept * speeds[i] + Vector3d(0, 0, kGravity * kStep_s));
      for (int sweep = 0; sweep < kSweeps; ++sweep) {
        for (const Link& link : links_) pull(link);
        for (std::size_t i = 0; i < places_.size(); ++i) keep_outside(before[i], places_[i]);
      }
      for (std::size_t i = 0; i < places_.size(); ++i) speeds[i] = (places_[i] - before[i]) / kStep_s;
    }
  }

  UvMesh mesh() const {
    UvMesh made{.vertices = places_, .triangles = grid_triangles(side_, side_)};
    for (int row = 0; row <= side_; ++row)
      for (int column = 0; column <= side_; ++column) made.uv.emplace_back(cell_mm_ * column, cell_mm_ * row);
    double lowest = places_.front().z();
    for (const Vector3d& place : places_) lowest = std::min(lowest, place.z());
    for (Vector3d& vertex : made.vertices) vertex.z() -= lowest;
    return made;
  }

 private:
  static constexpr double kStep_s = 1 / 240.0;
  static constexpr double kClearance_mm = 1.5, kFriction = 0.6;  // of a slide that is held back, each sweep
  struct Link {
    std::uint32_t a, b;
    double length_mm, yielding;  // the share of its stretch that each end takes
  };

  std::uint32_t index(int column, int row) const { return static_cast<std::uint32_t>(row * (side_ + 1) + column); }

  void add_links() {
    constexpr double kThread = 0, kShear = 2e-6, kBending = 1e-4;  // compliance of a unit mass, s^2
    struct Kind {
      int right, up;
      double compliance_s2;
    };
    // Links that follow one another share no point, so that a processor works on several at once.
    for (const Kind& kind : {Kind{1, 0, kThread},
                             {0, 1, kThread},
                             {1, 1, kShear},
                             {-1, 1, kShear},
                             {2, 0, kBending},
                             {0, 2, kBending},
                             {5, 0, kBending},
                             {0, 5, kBending}})
      for (const int half : {0, 1})
        for (int row = 0; row <= side_; ++row)
          for (int column = 0; column <= side_; ++column) {
            const int to_column = column + kind.right, to_row = row + kind.up;
            if (to_column < 0 || to_column > side_ || to_row > side_) continue;
            if ((kind.up > 0 ? row / kind.up : column / kind.right) % 2 != half) continue;
            links_.push_back({index(column, row), index(to_column, to_row), cell_mm_ * std::hypot(kind.right, kind.up),
                              1 / (2 + kind.compliance_s2 / (kStep_s * kStep_s))});
          }
  }

  void pull(const Link& link) {
    const Vector3d between = places_[link.b] - places_[link.a];
    const double length = std::max(between.norm(), 1e-9);
    const double share = (1 - link.length_mm / length) * link.yielding;
    places_[link.a] += share * between;
    places_[link.b] -= share * between;
  }

  void keep_outside(const Vector3d& before, Vector3d& at) const {
    const double least_mm = shape_.ball_radius_mm + kClearance_mm;
    if (!(at.squaredNorm() < least_mm * least_mm)) return;
    const Vector3d outwards = at.normalized();
    at = least_mm * outwards;
    const Vector3d slid = at - before;
    at -= kFriction * (slid - slid.dot(outwards) * outwards);
  }

  DrapeShape shape_;
  int side_;
  double cell_mm_;
  std::vector<Vector3d> places_{};
  std::vector<Link> links_{};
};

// The cloth is relaxed from coarse to fine grids: parts that are far apart settle on the coarse one.
UvMesh Maker::operator()(const DrapeShape& s) const {
  struct Grid {
    int steps, cost;  // of a step
  };
  constexpr std::array<Grid, 3> kGrids{Grid{700, 1}, {250, 4}, {80, 16}};
  double all = 0, done = 0;
  for (const Grid& grid : kGrids) all += grid.steps * grid.cost;
  HangingGrid cloth(s, 32);
  for (std::size_t i = 0; i < kGrids.size(); ++i) {
    const auto& [steps, cost] = kGrids[i];
    if (i > 0) cloth = cloth.refined();
    cloth.settle(steps, [&](int step) { go_on((done + step * cost) / all); });
    done += steps * cost;
  }
  return cloth.mesh();
}

}  // namespace

UvMesh garment_mesh(const GarmentShape& shape, const std::function<bool(double)>& progress) {
  if (const auto* skirt = std::get_if<SkirtShape>(&shape); skirt && !(skirt->flare_deg >= 60))
    throw std::runtime_error("a skirt of " + std::to_string(skirt->flare_deg) +
                             " degrees is narrower at the hem than a leg needs; give flare_deg from 60 to 360");
  return std::visit(Maker{progress}, shape);
}

}  // namespace renderer
