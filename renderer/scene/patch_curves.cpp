#include "renderer/scene/patch_curves.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

namespace renderer {
namespace {

// Segments first .. last - 1 of a yarn, moved by `offset`, as one curve.
void add_segments(CurveSet& set, const Yarn& yarn, const PeriodicSpline& line, const Eigen::Vector3d& offset, int first,
                  int last) {
  const auto start = static_cast<std::uint32_t>(set.control_points.size());
  for (int k = first - 1; k < last + 2; ++k) {
    const Eigen::Vector3f p = (line.control_point(k) + offset).cast<float>();
    const double radius_mm = yarn.radius_mm * profile_point(yarn.thickness, k);
    set.control_points.push_back({p.x(), p.y(), p.z(), static_cast<float>(radius_mm)});
  }
  for (int k = first; k < last; ++k) set.segments.push_back(start + static_cast<std::uint32_t>(k - first));
}

// Does the surface of segment k reach the box [low, high] in x and y? True at least where it does.
bool reaches(const PeriodicSpline& line, double radius_mm, const Eigen::Vector3d& offset, int k,
             const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  Eigen::Vector2d least = (line.control_point(k - 1) + offset).head<2>(), most = least;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector2d p = (line.control_point(k + i) + offset).head<2>();
    least = least.cwiseMin(p);
    most = most.cwiseMax(p);
  }
  return (most.array() + radius_mm >= low.array()).all() && (least.array() - radius_mm <= high.array()).all();
}

// The runs of neighbouring segments from `first` to `end` - 1 that are wanted, each as one curve.
template <typename Wanted>
void add_runs(CurveSet& set, const Yarn& yarn, const PeriodicSpline& line, const Eigen::Vector3d& offset, int first,
              int end, Wanted&& wanted) {
  for (int k = first; k < end; ++k) {
    const int start = k;
    while (k < end && wanted(k)) ++k;
    if (k > start) add_segments(set, yarn, line, offset, start, k);
  }
}

// Farthest that the yarns' surfaces or control points stray from the cell, in x or y.
double stray_of(const YarnPatch& patch) {
  double stray = 0;
  const Eigen::Vector2d cell(patch.period_x_mm, patch.period_y_mm);
  for (const Yarn& yarn : patch.yarns) {
    const double radius = yarn.radius_mm * profile_bound(yarn.thickness);
    for (const Eigen::Vector3d& p : yarn.control_points)
      stray = std::max({stray, radius - p.head<2>().minCoeff(), radius + (p.head<2>() - cell).maxCoeff()});
  }
  return stray;
}

}  // namespace

std::vector<int> threads_of(const YarnPatch& patch) {
  std::set<int> threads;
  for (const Yarn& yarn : patch.yarns) {
    if (yarn.threads.empty()) threads.insert(yarn.thread);
    threads.insert(yarn.threads.begin(), yarn.threads.end());
  }
  return {threads.begin(), threads.end()};
}

void check_cloth(const YarnPatch& patch, std::size_t threads) {
  for (const int thread : threads_of(patch)) {
    if (thread >= 0 && static_cast<std::size_t>(thread) < threads) continue;
    throw std::runtime_error("cloth: the patch \"" + patch.name + "\" has a yarn of thread " + std::to_string(thread) +
                             ", but " + std::to_string(threads) +
                             " threads are given (counted from 0); add the thread or correct the draft");
  }
  double height = 0;
  for (const Yarn& yarn : patch.yarns)
    for (const Eigen::Vector3d& p : yarn.control_points)
      height = std::max(height, std::abs(p.z()) + yarn.radius_mm * profile_bound(yarn.thickness));
  const double reach = std::max(stray_of(patch), 2 * height) / std::min(patch.period_x_mm, patch.period_y_mm);
  if (!(reach <= kMostReach))
    throw std::runtime_error("cloth: yarns of the patch \"" + patch.name + "\" reach " + std::to_string(reach) +
                             " periods beyond their cell or its plane; correct its periods or control points");
}

std::vector<RoundYarns> round_yarns_of(const YarnPatch& patch) {
  std::map<std::pair<bool, double>, RoundYarns> parts;  // by system, flatness
  for (std::size_t i = 0; i < patch.yarns.size(); ++i) {
    const Yarn& yarn = patch.yarns[i];
    const bool round = yarn.flatness == 1;
    RoundYarns& part = parts[{round || yarn.warp, yarn.flatness}];
    if (part.patch.yarns.empty()) {
      part.patch = patch;
      part.patch.yarns.clear();
      part.stretch[yarn.warp ? 0 : 1] = yarn.flatness;
      part.patch.period_x_mm /= part.stretch.x();
      part.patch.period_y_mm /= part.stretch.y();
    }
    Yarn unstretched = yarn;
    unstretched.radius_mm = half_height(yarn);
    unstretched.flatness = 1;
    for (Eigen::Vector3d& point : unstretched.control_points) point = point.cwiseQuotient(part.stretch);
    part.patch.yarns.push_back(std::move(unstretched));
    part.numbers.push_back(static_cast<int>(i));
  }
  std::vector<RoundYarns> all;
  for (auto& [key, part] : parts) all.push_back(std::move(part));
  return all;
}

Tiles with_neighbours(const YarnPatch& patch, Tiles tiles, bool along_x) {
  const double stray = stray_of(patch);
  const auto widen = [&](int& first, int& count, double period_mm) {
    const int more = 1 + static_cast<int>(stray / period_mm);
    first -= more;
    count += 2 * more;
  };
  if (along_x) widen(tiles.first_x, tiles.x, patch.period_x_mm);
  widen(tiles.first_y, tiles.y, patch.period_y_mm);
  return tiles;
}

CurveSet curves_of(const YarnPatch& patch, const Tiles& tiles, int thread) {
  assert(tiles.x > 0 && tiles.y > 0);
  CurveSet set;
  for (const Yarn& yarn : patch.yarns) {
    const PeriodicSpline line = center_line(patch, yarn);
    const int count = static_cast<int>(line.control_points.size());
    const int first = (yarn.warp ? tiles.first_y : tiles.first_x) * count,
              end = first + (yarn.warp ? tiles.y : tiles.x) * count;
    const int across = yarn.warp ? tiles.first_x : tiles.first_y, last = across + (yarn.warp ? tiles.x : tiles.y);
    for (int tile = across; tile < last; ++tile) {
      const Eigen::Vector3d offset =
          yarn.warp ? Eigen::Vector3d(tile * patch.period_x_mm, 0, 0) : Eigen::Vector3d(0, tile * patch.period_y_mm, 0);
      add_runs(set, yarn, line, offset, first, end, [&](int k) { return thread_of_segment(yarn, k) == thread; });
    }
  }
  return set;
}

CurveSet cell_curves_of(const YarnPatch& patch, int thread, double margin_mm, std::vector<SegmentOrigin>* origins) {
  assert(margin_mm >= 0);
  CurveSet set;
  const Eigen::Vector2d low(-margin_mm, -margin_mm);
  const Eigen::Vector2d high(patch.period_x_mm + margin_mm, patch.period_y_mm + margin_mm);
  const double reach = margin_mm + stray_of(patch);
  const int images_x = 1 + static_cast<int>(reach / patch.period_x_mm),
            images_y = 1 + static_cast<int>(reach / patch.period_y_mm);
  for (std::size_t i = 0; i < patch.yarns.size(); ++i) {
    const Yarn& yarn = patch.yarns[i];
    const PeriodicSpline line = center_line(patch, yarn);
    const int across = yarn.warp ? images_x : images_y, along = yarn.warp ? images_y : images_x;
    const double radius = yarn.radius_mm * profile_bound(yarn.thickness);
    for (int image = -across; image <= across; ++image) {
      const Eigen::Vector3d offset = yarn.warp ? Eigen::Vector3d(image * patch.period_x_mm, 0, 0)
                                               : Eigen::Vector3d(0, image * patch.period_y_mm, 0);
      const int count = static_cast<int>(line.control_points.size());
      add_runs(set, yarn, line, offset, -along * count, (along + 1) * count, [&](int k) {
        return thread_of_segment(yarn, k) == thread && reaches(line, radius, offset, k, low, high);
      });
      if (origins) origins->resize(set.segments.size(), {static_cast<int>(i), image});
    }
  }
  return set;
}

}  // namespace renderer
