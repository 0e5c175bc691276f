#include "renderer/scene/garment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "renderer/scattering/degree.h"
#include "renderer/scene/grid_triangles.h"
#include "renderer/weave/periodic_spline.h"

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

constexpr double kClearance_mm = 1.5;  // of cloth from what it lies on

// What a cloth lies on or hangs round: a ball at the origin, or a body round the z axis that widens from a waist at z =
// 0 downwards.
struct Ball {
  double radius_mm;
  // The place outside that is nearest to `at`.
  Vector3d outside(const Vector3d& at) const {
    const double least_mm = radius_mm + kClearance_mm;
    return at.squaredNorm() < least_mm * least_mm ? Vector3d(least_mm * at.normalized()) : at;
  }
};
struct Hips {
  double waist_mm, wider, down_mm;  // radius there; by how much of the depth it grows, and how far down
  Vector3d outside(const Vector3d& at) const {
    const double least_mm = waist_mm + wider * std::clamp(-at.z(), 0.0, down_mm), away_mm = at.head<2>().norm();
    if (!(away_mm < least_mm)) return at;
    const double scale = least_mm / std::max(away_mm, 1e-9);
    return {scale * at.x(), scale * at.y(), at.z()};
  }
};
struct Air {
  Vector3d outside(const Vector3d& at) const { return at; }
};

// Cloth on its way to rest, by position-based dynamics [Macklin 2016]; z is up. Points lie in rows; a closed sheet's
// last column is followed by its first.
class HangingSheet {
 public:
  using Pattern = std::function<Vector2d(int column, int row)>;  // mm; alike from column to column

  struct Size {
    int columns, rows;  // of points
    bool closed = false;
  };
  // How much it gives way to bending over two and over five cells: compliance of a unit mass, s^2.
  struct Bending {
    double near_s2, far_s2;
  };

  HangingSheet(const Size& size, const Bending& bending, const Pattern& pattern, std::vector<Vector3d> places)
      : size_(size), places_(std::move(places)) {
    add_links(pattern, bending);
  }

  void pin_row(int row) {
    for (int column = 0; column < size_.columns; ++column) pinned_.push_back(index(column, row));
  }

  template <class Body>
  void settle(int steps, int sweeps, const Body& body, const std::function<void(int steps_done)>& go_on) {
    constexpr double kGravity = -9810, kKept = 0.98;  // of the speed, after each step
    std::vector<Vector3d> speeds(places_.size(), Vector3d::Zero());
    for (int step = 0; step < steps; ++step) {
      go_on(step);
      const std::vector<Vector3d> before = places_;
      for (std::size_t i = 0; i < places_.size(); ++i)
        places_[i] += kStep_s * (kKept * speeds[i] + Vector3d(0, 0, kGravity * kStep_s));
      for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (const Link& link : links_) pull(link);
        for (std::size_t i = 0; i < places_.size(); ++i) keep_outside(body, before[i], places_[i]);
        for (const std::uint32_t i : pinned_) places_[i] = before[i];
      }
      for (std::size_t i = 0; i < places_.size(); ++i) speeds[i] = (places_[i] - before[i]) / kStep_s;
    }
  }

  const std::vector<Vector3d>& places() const { return places_; }

  // A smooth surface through about the same places, `finer` times as fine: a uniform cubic B-spline.
  std::vector<Vector3d> refined(int finer) const {
    const int columns = size_.closed ? size_.columns * finer : (size_.columns - 1) * finer + 1,
              rows = (size_.rows - 1) * finer + 1;
    std::vector<Vector3d> fine;
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        const Eigen::Vector4d u = spline_weights(static_cast<double>(column % finer) / finer),
                              v = spline_weights(static_cast<double>(row % finer) / finer);
        Vector3d at = Vector3d::Zero();
        for (int j = 0; j < 4; ++j)
          for (int i = 0; i < 4; ++i) at += u[i] * v[j] * control(column / finer + i - 1, row / finer + j - 1);
        fine.push_back(at);
      }
    return fine;
  }

 private:
  static constexpr double kStep_s = 1 / 240.0;
  static constexpr double kFriction = 0.6;  // of a slide that is held back, each sweep
  struct Link {
    std::uint32_t a, b;
    double length_mm, yielding;  // the share of its stretch that each end takes
  };

  std::uint32_t index(int column, int row) const { return static_cast<std::uint32_t>(row * size_.columns + column); }

  // A place, or beyond an open border its mirror image.
  Vector3d control(int column, int row) const {
    if (size_.closed) column = (column + size_.columns) % size_.columns;
    const auto beyond = [](int i, int count) { return i < 0 ? 1 : (i >= count ? count - 2 : -1); };
    if (const int inner = beyond(row, size_.rows); inner >= 0)
      return 2 * control(column, std::clamp(row, 0, size_.rows - 1)) - control(column, inner);
    if (const int inner = beyond(column, size_.columns); inner >= 0)
      return 2 * control(std::clamp(column, 0, size_.columns - 1), row) - control(inner, row);
    return places_[index(column, row)];
  }

  void add_links(const Pattern& pattern, const Bending& bending) {
    constexpr double kThread = 0, kShear = 2e-6;  // compliance of a unit mass, s^2
    struct Kind {
      int right, up;
      double compliance_s2;
    };
    // Links that follow one another share no point, so that a processor works on several at once.
    for (const Kind& kind : {Kind{1, 0, kThread},
                             {0, 1, kThread},
                             {1, 1, kShear},
                             {-1, 1, kShear},
                             {2, 0, bending.near_s2},
                             {0, 2, bending.near_s2},
                             {5, 0, bending.far_s2},
                             {0, 5, bending.far_s2}})
      for (const int half : {0, 1})
        for (int row = 0; row + kind.up < size_.rows; ++row)
          for (int column = 0; column < size_.columns; ++column) {
            int to = column + kind.right;
            if (size_.closed) to = (to + size_.columns) % size_.columns;
            if (to < 0 || to >= size_.columns) continue;
            if ((kind.up > 0 ? row / kind.up : column / kind.right) % 2 != half) continue;
            const double length_mm = (pattern(column + kind.right, row + kind.up) - pattern(column, row)).norm();
            links_.push_back({index(column, row), index(to, row + kind.up), length_mm,
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

  template <class Body>
  static void keep_outside(const Body& body, const Vector3d& before, Vector3d& at) {
    const Vector3d out = body.outside(at);
    if (out == at) return;
    const Vector3d outwards = (out - at).normalized(), slid = out - before;
    at = out - kFriction * (slid - slid.dot(outwards) * outwards);
  }

  Size size_;
  std::vector<Vector3d> places_;
  std::vector<std::uint32_t> pinned_{};
  std::vector<Link> links_{};
};

// With its lowest point at z = 0.
UvMesh lifted(UvMesh mesh) {
  double lowest = mesh.vertices.front().z();
  for (const Vector3d& place : mesh.vertices) lowest = std::min(lowest, place.z());
  for (Vector3d& vertex : mesh.vertices) vertex.z() -= lowest;
  return mesh;
}

// The places of a square grid with cells of half the size: new points lie between the old ones.
std::vector<Vector3d> between(const std::vector<Vector3d>& places, int side) {
  const auto at = [&](int column, int row) { return places[static_cast<std::size_t>(row * (side + 1) + column)]; };
  std::vector<Vector3d> fine;
  for (int row = 0; row <= 2 * side; ++row)
    for (int column = 0; column <= 2 * side; ++column)
      fine.emplace_back((at(column / 2, row / 2) + at((column + 1) / 2, row / 2) + at(column / 2, (row + 1) / 2) +
                         at((column + 1) / 2, (row + 1) / 2)) /
                        4);
  return fine;
}

constexpr int kFine = 4096;  // points of a line whose length is measured

// Rows of a hanging cloth from the upper edge down, as they are begun with.
std::vector<Vector3d> places_of(const std::vector<std::vector<Vector2d>>& rows, double step_mm, std::size_t columns) {
  const std::vector<double> heights = heights_of(rows, step_mm);
  std::vector<Vector3d> places;
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (std::size_t column = 0; column < columns; ++column)
      places.emplace_back(rows[row][column].x(), rows[row][column].y(), heights[row]);
  return places;
}

// The mesh of rows of points from the upper edge down, so that triangles turn towards the face. A closed sheet's first
// column is repeated as its last, which has another place in the pattern.
template <class Uv>
UvMesh mesh_of(const std::vector<Vector3d>& places, int columns, int rows, bool closed, const Uv& uv) {
  const int across = closed ? columns : columns - 1;
  UvMesh mesh{.triangles = grid_triangles(across, rows - 1)};
  for (int row = rows - 1; row >= 0; --row)
    for (int column = 0; column <= across; ++column) {
      mesh.vertices.push_back(places[static_cast<std::size_t>(row * columns + column % columns)]);
      mesh.uv.push_back(uv(column, row));
    }
  return lifted(std::move(mesh));
}

struct Maker {
  const std::function<bool(double)>& progress;

  void go_on(double finished) const {
    if (progress && !progress(finished)) throw std::runtime_error("the draping was stopped on request; start it again");
  }

  // Folds are begun as regular ones, and fall by their weight into what they are.
  static constexpr int kFiner = 3, kSteps = 160, kSweeps = 12;
  static constexpr HangingSheet::Bending kSoft{2e-4, 2e-3};

  UvMesh operator()(const SkirtShape& s) const {
    constexpr int kAcross = 240, kDown = 60;
    const double sector_rad = s.flare_deg * kDegree, inner_mm = 2 * std::numbers::pi * s.waist_radius_mm / sector_rad;
    const double step_mm = s.length_mm / kDown;
    std::vector<std::vector<Vector2d>> rings;
    for (int row = 0; row <= kDown; ++row) {
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
        ring.fold.emplace_back(std::cos(wave) * (1 + 0.4 * std::sin(angle + 0.7) + 0.2 * std::sin(3 * angle)) *
                               outwards);
      }
      rings.push_back(by_length(folded_to(ring_mm, radius_mm, ring), kAcross));
    }
    const auto pattern = [&](double column, double row) {
      const double angle = sector_rad * column / kAcross, radius = inner_mm + row * step_mm;
      return Vector2d(radius * std::sin(angle), -radius * std::cos(angle));
    };
    HangingSheet cloth({kAcross, kDown + 1, true}, kSoft, pattern, places_of(rings, step_mm, kAcross));
    cloth.pin_row(0);
    // Hips are narrower than the cloth round them.
    const Hips hips{.waist_mm = s.waist_radius_mm - 2 * kClearance_mm,
                    .wider = std::min(0.3, 0.5 * sector_rad / (2 * std::numbers::pi)),
                    .down_mm = 0.3 * s.length_mm};
    cloth.settle(kSteps, kSweeps, hips, [&](int step) { go_on(static_cast<double>(step) / kSteps); });
    return mesh_of(cloth.refined(kFiner), kAcross * kFiner, kDown * kFiner + 1, true, [&](int column, int row) {
      return pattern(static_cast<double>(column) / kFiner, static_cast<double>(row) / kFiner);
    });
  }

  UvMesh operator()(const PleatedShape& s) const {
    constexpr int kAcross = 200, kDown = 80;
    const double step_mm = s.height_mm / kDown;
    std::vector<std::vector<Vector2d>> rows;
    for (int row = 0; row <= kDown; ++row) {
      const double part = static_cast<double>(row) / kDown;
      const double hung_mm = s.width_mm * (s.gathered + 0.5 * (0.9 - s.gathered) * part);
      FoldedLine hung;
      for (int i = 0; i <= kFine; ++i) {
        const double x = static_cast<double>(i) / kFine;
        const double wave = 2 * std::numbers::pi * (s.pleats * x + 0.35 * part * std::sin(5 * x + 1));
        hung.base.emplace_back(hung_mm * (x - 0.5) + 0.12 * s.width_mm * part * part, 0);
        hung.fold.emplace_back(0, (1 + 0.5 * part * std::sin(7 * x + 2)) * std::sin(wave + 0.3 * std::sin(wave)));
      }
      rows.push_back(by_length(folded_to(s.width_mm, s.width_mm / s.pleats, hung), kAcross));
    }
    const auto pattern = [&](double column, double row) {
      return Vector2d(s.width_mm * column / kAcross, s.height_mm - row * step_mm);
    };
    HangingSheet cloth({kAcross + 1, kDown + 1}, kSoft, pattern, places_of(rows, step_mm, kAcross + 1));
    cloth.pin_row(0);
    cloth.settle(kSteps, kSweeps, Air{}, [&](int step) { go_on(static_cast<double>(step) / kSteps); });
    return mesh_of(cloth.refined(kFiner), kAcross * kFiner + 1, kDown * kFiner + 1, false, [&](int column, int row) {
      return pattern(static_cast<double>(column) / kFiner, static_cast<double>(row) / kFiner);
    });
  }

  UvMesh operator()(const DrapeShape& s) const;
};

// The cloth is relaxed from coarse to fine grids: parts that are far apart settle on the coarse one.
UvMesh Maker::operator()(const DrapeShape& s) const {
  struct Grid {
    int steps, cost;  // of a step
  };
  constexpr std::array<Grid, 3> kGrids{Grid{700, 1}, {250, 4}, {80, 16}};
  constexpr int kDrapeSweeps = 20;
  constexpr HangingSheet::Bending kStiff{1e-4, 1e-4};
  double all = 0, done = 0;
  for (const Grid& grid : kGrids) all += grid.steps * grid.cost;
  int side = 32;
  // The cloth lies a little turned and off the middle, as nobody lays a cloth exactly.
  std::vector<Vector3d> places;
  for (int row = 0; row <= side; ++row)
    for (int column = 0; column <= side; ++column) {
      const Vector2d at = s.side_mm / side * Vector2d(column, row) - Vector2d::Constant(s.side_mm / 2);
      const Vector2d laid = Eigen::Rotation2Dd(0.3) * at + Vector2d(0.02, 0.01) * s.side_mm;
      places.emplace_back(laid.x(), laid.y(), s.ball_radius_mm + 2 * kClearance_mm);
    }
  for (std::size_t i = 0; i < kGrids.size(); ++i) {
    const auto& [steps, cost] = kGrids[i];
    if (i > 0) places = between(places, side), side *= 2;
    const double cell_mm = s.side_mm / side;
    HangingSheet cloth(
        {side + 1, side + 1}, kStiff, [&](int column, int row) { return Vector2d(cell_mm * column, cell_mm * row); },
        std::move(places));
    cloth.settle(steps, kDrapeSweeps, Ball{s.ball_radius_mm}, [&](int step) { go_on((done + step * cost) / all); });
    places = cloth.places();
    done += steps * cost;
  }
  UvMesh made{.vertices = std::move(places), .triangles = grid_triangles(side, side)};
  for (int row = 0; row <= side; ++row)
    for (int column = 0; column <= side; ++column)
      made.uv.emplace_back(s.side_mm / side * column, s.side_mm / side * row);
  return lifted(std::move(made));
}

}  // namespace

UvMesh garment_mesh(const GarmentShape& shape, const std::function<bool(double)>& progress) {
  if (const auto* skirt = std::get_if<SkirtShape>(&shape); skirt && !(skirt->flare_deg >= 60))
    throw std::runtime_error("a skirt of " + std::to_string(skirt->flare_deg) +
                             " degrees is narrower at the hem than a leg needs; give flare_deg from 60 to 360");
  return std::visit(Maker{progress}, shape);
}

}  // namespace renderer
