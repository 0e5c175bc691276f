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
#include "renderer/scene/hanging_sheet.h"
#include "renderer/scene/hem.h"

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

// What a cloth lies on or hangs round: a ball at the origin, a body round the z axis that widens from a waist at z = 0
// downwards, or a shoulder.
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
// A bar round a line through the origin, level from front to back.
struct Shoulder {
  double radius_mm;
  Vector3d along;  // unit vector in the plane y = 0
  Vector3d outside(const Vector3d& at) const {
    const double least_mm = radius_mm + kClearance_mm;
    const Vector3d on_line = at.dot(along) * along, away = at - on_line;
    return away.squaredNorm() < least_mm * least_mm ? Vector3d(on_line + least_mm * away.normalized()) : at;
  }
};
struct Air {
  Vector3d outside(const Vector3d& at) const { return at; }
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

// The mesh of rows of cloth with its hem, so that triangles turn towards the face. A closed sheet's first column is
// repeated as its last, which has another place in the pattern. uv(column, row): the place in the pattern, whose rows
// are `row_mm` apart.
template <class Uv>
UvMesh mesh_of(const HungRows& cloth, double row_mm, double hem_mm, const Uv& uv) {
  const int across = cloth.closed ? cloth.columns : cloth.columns - 1;
  const Hem hem = hem_of(cloth, hem_mm);
  const auto turned_up = static_cast<int>(hem.below_mm.size());
  UvMesh mesh{.triangles = grid_triangles(across, cloth.rows + turned_up - 1)};
  const auto add_row = [&](const std::vector<Vector3d>& places, int row, double of_pattern) {
    for (int column = 0; column <= across; ++column) {
      mesh.vertices.push_back(places[static_cast<std::size_t>(row * cloth.columns + column % cloth.columns)]);
      mesh.uv.push_back(uv(column, of_pattern));
    }
  };
  for (int row = turned_up - 1; row >= 0; --row)
    add_row(hem.places, row, cloth.rows - 1 + hem.below_mm[static_cast<std::size_t>(row)] / row_mm);
  for (int row = cloth.rows - 1; row >= 0; --row) add_row(cloth.places, row, row);
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
    cloth.meet_itself(pattern);
    // Hips are narrower than the cloth round them.
    const Hips hips{.waist_mm = s.waist_radius_mm - 2 * kClearance_mm,
                    .wider = std::min(0.3, 0.5 * sector_rad / (2 * std::numbers::pi)),
                    .down_mm = 0.3 * s.length_mm};
    cloth.settle(kSteps, kSweeps, hips, [&](int step) { go_on(static_cast<double>(step) / kSteps); });
    return mesh_of({cloth.refined(kFiner), kAcross * kFiner, kDown * kFiner + 1, true}, step_mm / kFiner, s.hem_mm,
                   [&](int column, double row) { return pattern(static_cast<double>(column) / kFiner, row / kFiner); });
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
    cloth.meet_itself(pattern);
    cloth.settle(kSteps, kSweeps, Air{}, [&](int step) { go_on(static_cast<double>(step) / kSteps); });
    return mesh_of({cloth.refined(kFiner), kAcross * kFiner + 1, kDown * kFiner + 1}, step_mm / kFiner, s.hem_mm,
                   [&](int column, double row) { return pattern(static_cast<double>(column) / kFiner, row / kFiner); });
  }

  UvMesh operator()(const SariShape& s) const {
    constexpr int kAcross = 224, kDown = 300, kSariFiner = 2, kSariSteps = 240, kSariSweeps = 8, kSariSmoother = 2;
    const double step_mm = s.length_mm / kDown;
    const int crest = static_cast<int>(std::lround((s.length_mm - s.front_mm) / step_mm));  // rows from the hem behind
    // What is pinned to the shoulder keeps its pleats off it.
    const Shoulder shoulder{.radius_mm = 0.75 * s.shoulder_radius_mm,
                            .along = Vector3d(std::cos(s.slope_deg * kDegree), 0, -std::sin(s.slope_deg * kDegree))};
    const double round_mm = s.shoulder_radius_mm + kClearance_mm;
    std::vector<Vector3d> places;
    for (int row = 0; row <= kDown; ++row) {
      const double behind_mm = (crest - row) * step_mm, side = behind_mm < 0 ? -1 : 1;
      const double part = std::abs(behind_mm) / (step_mm * (behind_mm < 0 ? kDown - crest : crest));
      const double hung_mm = s.width_mm * (s.gathered + 0.5 * (0.9 - s.gathered) * part);
      FoldedLine hung;
      for (int i = 0; i <= kFine; ++i) {
        const double x = static_cast<double>(i) / kFine;
        const double wave =
            2 * std::numbers::pi * (s.pleats * x + 0.15 * std::sin(9 * x) + 0.4 * part * std::sin(5 * x + 1 + side));
        hung.base.emplace_back(hung_mm * (x - 0.5), 0);
        hung.fold.emplace_back(0, 1 - std::cos(wave + 0.3 * std::sin(wave)));
      }
      // Over the shoulder and straight down on both sides of it; folds stand off it, and their way over it is longer.
      const Vector3d up = Vector3d(-shoulder.along.z(), 0, shoulder.along.x());
      for (const Vector2d& at : by_length(folded_to(s.width_mm, s.width_mm / s.pleats, hung), kAcross)) {
        const double off_mm = round_mm + at.y(), quarter_mm = off_mm * std::numbers::pi / 2;
        const double over_rad = std::clamp(behind_mm, -quarter_mm, quarter_mm) / off_mm;
        const double down_mm = std::max(0.0, std::abs(behind_mm) - quarter_mm);
        places.emplace_back(at.x() * shoulder.along +
                            off_mm * (std::sin(over_rad) * Vector3d::UnitY() + std::cos(over_rad) * up) -
                            Vector3d(0, 0, down_mm));
      }
    }
    const auto pattern = [&](double column, double row) {
      return Vector2d(s.width_mm * column / kAcross, s.length_mm - row * step_mm);
    };
    HangingSheet cloth({kAcross + 1, kDown + 1}, kSoft, pattern, std::move(places));
    // Over the shoulder's top the pleats keep what they were laid in.
    const int kept = static_cast<int>(std::ceil(0.5 * std::numbers::pi * round_mm / step_mm));
    for (int row = crest - kept; row <= crest + kept; ++row) cloth.pin_row(row);
    cloth.hang_from_row(crest, pattern);
    cloth.keep_order(shoulder.along);
    cloth.settle(kSariSteps, kSariSweeps, shoulder, [&](int step) { go_on(static_cast<double>(step) / kSariSteps); });
    cloth.smooth(kSariSmoother);
    return mesh_of(
        {cloth.refined(kSariFiner), kAcross * kSariFiner + 1, kDown * kSariFiner + 1}, step_mm / kSariFiner, s.hem_mm,
        [&](int column, double row) { return pattern(static_cast<double>(column) / kSariFiner, row / kSariFiner); });
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
    const auto pattern = [&](double column, double row) { return Vector2d(cell_mm * column, cell_mm * row); };
    HangingSheet cloth({side + 1, side + 1}, kStiff, pattern, std::move(places));
    cloth.meet_itself(pattern);
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
  if (const auto* sari = std::get_if<SariShape>(&shape)) {
    const double over_mm = std::numbers::pi * sari->shoulder_radius_mm;
    if (!(sari->front_mm > over_mm && sari->length_mm - sari->front_mm > over_mm))
      throw std::runtime_error("a sari of " + std::to_string(std::lround(sari->length_mm)) + " mm, " +
                               std::to_string(std::lround(sari->front_mm)) +
                               " mm of it in front, does not hang down on both sides of the shoulder; give front_mm " +
                               "more than " + std::to_string(std::lround(over_mm)) +
                               " and as much less than length_mm");
  }
  if (const auto* skirt = std::get_if<SkirtShape>(&shape); skirt && !(skirt->flare_deg >= 60))
    throw std::runtime_error("a skirt of " + std::to_string(skirt->flare_deg) +
                             " degrees is narrower at the hem than a leg needs; give flare_deg from 60 to 360");
  return std::visit(Maker{progress}, shape);
}

}  // namespace renderer
