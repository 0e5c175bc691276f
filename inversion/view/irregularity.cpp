#include "inversion/view/irregularity.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>

namespace inversion {
namespace {

using Eigen::Array3d;

constexpr double kSeen = 0.9;     // where on a thread light comes back from: in diameters above the face
constexpr double kCell_px = 3;    // across the turns, at least
constexpr double kCell_mm = 6;    // along them
constexpr int kFewestPixels = 6;  // of a cell
constexpr std::size_t kFewestViews = 4, kFewestCells = 24;
constexpr double kResolved_px = 3;        // to a turn: its pattern is seen
constexpr int kWindowTurns = 3;           // whose phase is told
constexpr std::size_t kParts = 8;         // of the sheet, left out in turn for the errors
constexpr double kLeastDarkening = 0.02;  // of the most absorbing channel: less tells nothing of absorption
// Shades of turns that are drawn to see how much is told of them: of any thread the same, in no more than this range.
constexpr std::uint64_t kShadesSeed = 20261201;
constexpr double kLeastShade = 0.1, kMostShade = 0.5;
constexpr double kLeastTold = 0.1;  // of them: less tells nothing

// What is told by both halves of the views, each by itself, at a place of the thread.
struct Told {
  double along_mm;  // from the first turn's middle, along the thread
  int turn, cell;
  std::array<double, 2> halves;
};

struct Grid {
  int turns_per_cell = 1, across = 0, along = 0;
  double low_y = 0, low_z = 0, cell_z = 0;

  int cells() const { return across * along; }
  // The cell of a place on the sheet, or -1.
  int at(double y, double z) const {
    const int i = static_cast<int>(std::floor((z - low_z) / cell_z)), j = static_cast<int>((y - low_y) / kCell_mm);
    return i >= 0 && i < across && y >= low_y && j < along ? i * along + j : -1;
  }
  double y(int cell) const { return low_y + (cell % along + 0.5) * kCell_mm; }
  double z(int cell) const { return low_z + (cell / along + 0.5) * cell_z; }
};

// The place on the sheet that a pixel shows.
std::optional<Eigen::Vector2d> on_sheet(const View& view, const WrappedSpool& spool, int column, int row) {
  const renderer::CameraRay ray = renderer::ray_through(view.camera, column, row);
  if (std::abs(ray.direction.x()) < 1e-6) return std::nullopt;
  const double t = (kSeen * spool.thread_diameter_mm - ray.origin.x()) / ray.direction.x();
  const Eigen::Vector3d at = ray.origin + t * ray.direction;
  return Eigen::Vector2d(at.y(), at.z());
}

// values less the quadratic in (y, z) nearest to them; those that are not finite stay so and do not count.
void flatten(std::vector<double>& values, const Grid& grid) {
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  const auto row = [&](int cell) {
    const double y = grid.y(cell) / 10, z = grid.z(cell) / 10;
    return Eigen::Matrix<double, 6, 1>{1, y, z, y * y, y * z, z * z};
  };
  for (int cell = 0; cell < grid.cells(); ++cell)
    if (const double value = values[static_cast<std::size_t>(cell)]; std::isfinite(value))
      normal += row(cell) * row(cell).transpose(), right += value * row(cell);
  const Eigen::Matrix<double, 6, 1> solved = normal.ldlt().solve(right);
  for (int cell = 0; cell < grid.cells(); ++cell) values[static_cast<std::size_t>(cell)] -= row(cell).dot(solved);
}

// Means over every other view of what is finite; not a number where a half has none.
std::array<std::vector<double>, 2> halves_of(const std::vector<std::vector<double>>& views) {
  std::array<std::vector<double>, 2> halves;
  for (std::size_t half = 0; half < 2; ++half)
    for (std::size_t cell = 0; cell < views.front().size(); ++cell) {
      double sum = 0;
      int count = 0;
      for (std::size_t i = half; i < views.size(); i += 2)
        if (std::isfinite(views[i][cell])) sum += views[i][cell], ++count;
      halves[half].push_back(count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN());
    }
  return halves;
}

// A random wave along a thread: variance 1, correlation exp(-(d / length)^2) at the distance d.
class Wave {
 public:
  Wave(double length_mm, std::mt19937_64& random) {
    std::normal_distribution<double> frequency(0, std::numbers::sqrt2 / length_mm);
    std::uniform_real_distribution<double> phase(0, 2 * std::numbers::pi);
    for (Cosine& one : cosines_) one = {frequency(random), phase(random)};
  }
  double at(double along_mm) const {
    double sum = 0;
    for (const Cosine& one : cosines_) sum += std::cos(one.frequency * along_mm + one.phase);
    return sum * std::sqrt(2.0 / static_cast<double>(cosines_.size()));
  }

 private:
  struct Cosine {
    double frequency, phase;
  };
  std::array<Cosine, 60> cosines_;
};

// What cells of a sheet keep of a thread's variance, and by how much the root of that differs from thread to thread, as
// a share.
struct Kept {
  double share = 1, spread = 0;
};

// The square root of the covariance of the halves over what is kept, and its error: by leaving out parts of the sheet
// in turn (jackknife), but no less than threads differ; nothing where too few places are told.
std::optional<Deviation> deviation_of(const std::vector<Told>& told, const Kept& kept) {
  if (told.size() < 2 * kParts) return std::nullopt;
  const auto covariance = [&](std::size_t left_out) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < told.size(); ++i)
      if (i * kParts / told.size() != left_out) sum += told[i].halves[0] * told[i].halves[1], ++count;
    return sum / count / kept.share;
  };
  const double all = covariance(kParts);
  double squares = 0;
  for (std::size_t part = 0; part < kParts; ++part) squares += std::pow(covariance(part) - all, 2);
  const double sigma = std::sqrt(squares * (kParts - 1) / kParts), value = std::sqrt(std::max(0.0, all));
  // Of the root: linear where it is well above 0, and that of the covariance's own root elsewhere.
  const double of_root = std::min(sigma / (2 * std::max(value, 1e-9)), std::sqrt(sigma));
  return Deviation{.value = value, .sigma = std::max(of_root, kept.spread * value)};
}

// The length at which v exp(-(d / length)^2) is nearest to the covariance at all distances d along the thread.
double correlation_length(const std::vector<Told>& told, double turn_mm) {
  constexpr int kTurnsApart = 8;
  constexpr double kBin_mm = 6;
  std::vector<double> sums, counts;
  const auto add = [&](double distance_mm, double product) {
    const auto bin = static_cast<std::size_t>(std::lround(distance_mm / kBin_mm));
    if (bin >= sums.size()) sums.resize(bin + 1, 0), counts.resize(bin + 1, 0);
    sums[bin] += product, ++counts[bin];
  };
  for (const Told& a : told)
    for (const Told& b : told)
      if (std::abs(a.turn - b.turn) <= kTurnsApart) add(std::abs(a.along_mm - b.along_mm), a.halves[0] * b.halves[1]);
  double best = 0, least = std::numeric_limits<double>::max();
  for (double length = kBin_mm; length < 20 * turn_mm; length *= 1.05) {
    double both = 0, model2 = 0, found2 = 0;
    for (std::size_t bin = 0; bin < sums.size(); ++bin) {
      if (counts[bin] == 0) continue;
      const double found = sums[bin] / counts[bin],
                   model = std::exp(-std::pow(static_cast<double>(bin) * kBin_mm / length, 2));
      both += counts[bin] * found * model, model2 += counts[bin] * model * model, found2 += counts[bin] * found * found;
    }
    const double misfit = found2 - std::max(0.0, both) * both / model2;
    if (misfit < least) least = misfit, best = length;
  }
  return best;
}

class Sheet {
 public:
  Sheet(const WrappedSpool& spool, const std::vector<View>& views, const std::vector<std::size_t>& seen)
      : spool_(spool) {
    for (const std::size_t i : seen) views_.push_back(&views[i]);
    double least_px = std::numeric_limits<double>::max();
    for (const View* view : views_) least_px = std::min(least_px, spool.thread_diameter_mm * px_per_mm(*view));
    turn_px_ = least_px;
    grid_.turns_per_cell = std::max(1, static_cast<int>(std::ceil(kCell_px / least_px)));
    grid_.across = spool.turns / grid_.turns_per_cell;
    grid_.cell_z = grid_.turns_per_cell * spool.thread_diameter_mm;
    grid_.low_z = -0.5 * spool.turns * spool.thread_diameter_mm;
    grid_.along = static_cast<int>(spool.frame_width_mm / kCell_mm);
    grid_.low_y = -0.5 * grid_.along * kCell_mm;
  }

  bool turns_are_seen() const { return turn_px_ >= kResolved_px; }

  // The logarithm of each cell's brightness in a picture of this view over its even twin's, R, G and B, flattened.
  std::array<std::vector<double>, 3> brightness(const View& view, const cv::Mat3f& picture,
                                                const cv::Mat3f& even_twin) const {
    const auto cells = static_cast<std::size_t>(grid_.cells());
    std::vector<Array3d> photographed(cells, Array3d::Zero()), even = photographed;
    std::vector<int> counts(cells, 0);
    for (int row = 0; row < view.mask.rows; ++row)
      for (int column = 0; column < view.mask.cols; ++column) {
        if (view.mask(row, column) == 0) continue;
        const auto place = on_sheet(view, spool_, column, row);
        const int cell = place ? grid_.at(place->x(), place->y()) : -1;
        if (cell < 0) continue;
        const cv::Vec3f &a = picture(row, column), &b = even_twin(row, column);
        photographed[static_cast<std::size_t>(cell)] += Array3d(a[0], a[1], a[2]);
        even[static_cast<std::size_t>(cell)] += Array3d(b[0], b[1], b[2]);
        ++counts[static_cast<std::size_t>(cell)];
      }
    std::array<std::vector<double>, 3> ratios;
    for (int c = 0; c < 3; ++c) {
      for (std::size_t cell = 0; cell < cells; ++cell)
        ratios[static_cast<std::size_t>(c)].push_back(counts[cell] >= kFewestPixels && even[cell][c] > 0
                                                          ? std::log(photographed[cell][c] / even[cell][c])
                                                          : std::numeric_limits<double>::quiet_NaN());
      flatten(ratios[static_cast<std::size_t>(c)], grid_);
    }
    return ratios;
  }

  std::vector<Told> told(const std::vector<std::vector<double>>& of_views) const {
    const std::array<std::vector<double>, 2> halves = halves_of(of_views);
    std::vector<Told> all;
    for (int cell = 0; cell < grid_.cells(); ++cell) {
      const auto i = static_cast<std::size_t>(cell);
      if (!std::isfinite(halves[0][i]) || !std::isfinite(halves[1][i])) continue;
      const int turn = cell / grid_.along * grid_.turns_per_cell;
      all.push_back({turn * turn_length_mm(spool_) + grid_.y(cell), turn, cell, {halves[0][i], halves[1][i]}});
    }
    return all;
  }

  // What these cells show of a value of each place of the thread, flattened; no numbers elsewhere. `at`: by turn and mm
  // along it.
  template <class At>
  std::vector<double> shown(const std::vector<Told>& told, const At& at) const {
    std::vector<double> cells(static_cast<std::size_t>(grid_.cells()), std::numeric_limits<double>::quiet_NaN());
    for (const Told& one : told) {
      double sum = 0;
      for (int turn = one.turn; turn < one.turn + grid_.turns_per_cell; ++turn) sum += at(turn, grid_.y(one.cell));
      cells[static_cast<std::size_t>(one.cell)] = sum / grid_.turns_per_cell;
    }
    flatten(cells, grid_);
    return cells;
  }

  // Of threads that stay alike over this length, by random ones.
  Kept kept(const std::vector<Told>& told, double length_mm) const {
    constexpr int kThreads = 64;
    std::mt19937_64 random(kShadesSeed);
    double sum = 0, roots = 0;
    for (int i = 0; i < kThreads; ++i) {
      const Wave wave(length_mm, random);
      const std::vector<double> cells =
          shown(told, [&](int turn, double y) { return wave.at(turn * turn_length_mm(spool_) + y); });
      double squares = 0;
      for (const Told& one : told) squares += std::pow(cells[static_cast<std::size_t>(one.cell)], 2);
      squares /= static_cast<double>(told.size());
      sum += squares / kThreads, roots += std::sqrt(squares) / kThreads;
    }
    return {.share = sum, .spread = std::sqrt(std::max(0.0, sum / (roots * roots) - 1))};
  }

  // By how much the turns of each window are shifted from even places in a view, in diameters; flattened. No numbers
  // where the view does not show them all.
  std::vector<double> shifts(const View& view) const {
    const auto windows = static_cast<std::size_t>(spool_.turns / kWindowTurns);
    std::vector<std::complex<double>> waves(windows, 0);
    std::vector<double> light(windows, 0), pixels(windows, 0);
    const auto each = [&](const auto& use) {
      for (int row = 0; row < view.mask.rows; ++row)
        for (int column = 0; column < view.mask.cols; ++column) {
          if (view.mask(row, column) == 0) continue;
          const auto place = on_sheet(view, spool_, column, row);
          if (!place) continue;
          const double turns = (place->y() - grid_.low_z) / spool_.thread_diameter_mm;
          const auto window = static_cast<std::size_t>(std::max(0.0, turns) / kWindowTurns);
          const cv::Vec3f& pixel = view.image(row, column);
          if (turns >= 0 && window < windows) use(window, turns, static_cast<double>(pixel[0] + pixel[1] + pixel[2]));
        }
    };
    each([&](std::size_t window, double, double value) { light[window] += value, ++pixels[window]; });
    each([&](std::size_t window, double turns, double value) {
      waves[window] += (value - light[window] / pixels[window]) * std::polar(1.0, -2 * std::numbers::pi * turns);
    });
    if (std::ranges::count(pixels, 0) > 0) return std::vector(windows, std::numeric_limits<double>::quiet_NaN());
    std::vector<double> shifts;
    double last = 0;
    for (const std::complex<double>& wave : waves) {
      const double phase = -std::arg(wave) / (2 * std::numbers::pi);
      shifts.push_back(last = phase + std::round(last - phase));
    }
    // Poses move and stretch all of the sheet alike.
    Eigen::MatrixXd powers(static_cast<Eigen::Index>(windows), 3);
    for (Eigen::Index i = 0; i < powers.rows(); ++i) {
      const double x = 2.0 * static_cast<double>(i) / static_cast<double>(powers.rows()) - 1;
      powers.row(i) << 1, x, x * x;
    }
    Eigen::Map<Eigen::VectorXd> all(shifts.data(), powers.rows());
    all -= powers * powers.colPivHouseholderQr().solve(all).eval();
    return shifts;
  }

  // The share of a diameter's variance that the mean stretch from window to window has, when turns this far apart
  // along the thread have this correlation: a window's shift is the mean of its turns', so that neighbours weigh their
  // turns by a triangle.
  double stretch_share(double length_mm) const {
    double sum = 0, weights = 0;
    const auto weight = [](int turn) { return turn < kWindowTurns ? turn + 0.5 : 2 * kWindowTurns - turn - 0.5; };
    for (int a = 0; a < 2 * kWindowTurns; ++a) {
      weights += weight(a);
      for (int b = 0; b < 2 * kWindowTurns; ++b) sum += weight(a) * weight(b) * correlation(a - b, length_mm);
    }
    return sum / (weights * weights);
  }

  std::optional<Deviation> diameter(double length_mm) const {
    std::vector<std::vector<double>> stretches;
    for (const View* view : views_) {
      const std::vector<double> shifted = shifts(*view);
      std::vector<double>& stretch = stretches.emplace_back();
      for (std::size_t i = 1; i < shifted.size(); ++i) stretch.push_back((shifted[i] - shifted[i - 1]) / kWindowTurns);
    }
    const std::array<std::vector<double>, 2> halves = halves_of(stretches);
    std::vector<Told> told;
    for (std::size_t i = 0; i < halves[0].size(); ++i)
      if (std::isfinite(halves[0][i]) && std::isfinite(halves[1][i]))
        told.push_back({0, 0, 0, {halves[0][i], halves[1][i]}});
    // A straight line has been taken from the stretches.
    const auto all = static_cast<double>(told.size());
    return deviation_of(told, {.share = stretch_share(length_mm) * (all - 2) / all});
  }

 private:
  double correlation(int turns_apart, double length_mm) const {
    if (turns_apart == 0) return 1;
    return std::exp(-std::pow(turns_apart * turn_length_mm(spool_) / std::max(length_mm, 1e-3), 2));
  }

  const WrappedSpool& spool_;
  std::vector<const View*> views_;
  Grid grid_;
  double turn_px_ = 0;
};

// The logarithm of each cell's absorption, by how R, G and B are darker.
std::vector<double> shades_of(const std::array<std::vector<double>, 3>& ratios, const Array3d& darkening) {
  std::vector<double> shades;
  for (std::size_t cell = 0; cell < ratios[0].size(); ++cell)
    shades.push_back(-(Array3d(ratios[0][cell], ratios[1][cell], ratios[2][cell]) * darkening).sum() /
                     darkening.square().sum());
  return shades;
}

// The mean of R, G and B of each cell.
std::vector<double> mean_of(const std::array<std::vector<double>, 3>& ratios) {
  std::vector<double> means;
  for (std::size_t cell = 0; cell < ratios[0].size(); ++cell)
    means.push_back((ratios[0][cell] + ratios[1][cell] + ratios[2][cell]) / 3);
  return means;
}

// Shades of the turns of a thread whose shade deviates by about this much.
std::vector<double> known_shades(const WrappedSpool& spool, double deviation, double length_mm) {
  std::mt19937_64 random(kShadesSeed);
  const Wave wave(length_mm, random);
  std::vector<double> shades;
  for (int turn = 0; turn < spool.turns; ++turn)
    shades.push_back(std::clamp(deviation, kLeastShade, kMostShade) * wave.at(turn * turn_length_mm(spool)));
  return shades;
}

// How much is told of shades by what is told of known ones, by their covariance.
double share_told(const std::vector<Told>& told, const std::vector<double>& known) {
  double both = 0, squares = 0;
  for (const Told& one : told) {
    const double shade = known[static_cast<std::size_t>(one.cell)];
    both += shade * (one.halves[0] + one.halves[1]) / 2, squares += shade * shade;
  }
  return both / squares;
}

}  // namespace

double turn_length_mm(const WrappedSpool& spool) {
  return 2 * (spool.frame_width_mm + spool.frame_depth_mm);
}

Irregularity measure_irregularity(const WrappedSpool& spool, const std::vector<View>& views, const FittedTwins& twins) {
  std::vector<std::size_t> seen;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (!views[i].transmission && !views[i].image.empty()) seen.push_back(i);
  Irregularity found;
  if (seen.size() < kFewestViews || spool.turns < 2 * kWindowTurns) return found;
  const Sheet sheet(spool, views, seen);
  const auto brightness_of = [&](const auto& picture_of) {
    std::vector<std::array<std::vector<double>, 3>> of_views;
    for (const std::size_t i : seen) of_views.push_back(sheet.brightness(views[i], picture_of(i), twins.even.at(i)));
    return of_views;
  };
  const auto tell = [&](const auto& ratios, const auto& value_of) {
    std::vector<std::vector<double>> of_views;
    for (const auto& one : ratios) of_views.push_back(value_of(one));
    return sheet.told(of_views);
  };
  const auto shade_of = [&](const auto& ratios) { return shades_of(ratios, twins.darkening); };
  const auto photographed = brightness_of([&](std::size_t i) { return views[i].image; });
  const std::vector<Told> told = tell(photographed, mean_of);
  if (told.size() < kFewestCells) return found;
  found.length_mm = correlation_length(told, turn_length_mm(spool));
  const Kept kept = sheet.kept(told, found.length_mm);
  found.brightness = deviation_of(told, kept);
  if (twins.darkening.maxCoeff() > kLeastDarkening) found.shade = deviation_of(tell(photographed, shade_of), kept);
  if (found.shade) {
    const std::vector<double> known = known_shades(spool, found.shade->value, found.length_mm);
    const double share =
        share_told(tell(brightness_of([&](std::size_t i) { return twins.shaded(i, known); }), shade_of),
                   sheet.shown(told, [&](int turn, double) { return known[static_cast<std::size_t>(turn)]; }));
    if (share < kLeastTold)
      found.shade.reset();
    else
      found.shade = {found.shade->value / share, found.shade->sigma / share};
  }
  if (sheet.turns_are_seen()) found.diameter = sheet.diameter(found.length_mm);
  return found;
}

}  // namespace inversion
