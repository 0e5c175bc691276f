#include "calibration/geometry/lattice.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>
#include <stdexcept>

#include "calibration/geometry/correspondences.h"
#include "calibration/sensor/median.h"

namespace calibration {
namespace {

constexpr double kTolerance = 1e-6;  // part of a spacing; allows for rounding, not for the printer

bool whole(double number) {
  return std::abs(number - std::round(number)) < kTolerance * std::max(1.0, std::abs(number));
}

bool fits(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& origin, double spacing_mm) {
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
    const Eigen::Vector3d steps = (point - origin) / spacing_mm;
    return whole(steps.x()) && whole(steps.y()) && std::abs(steps.z()) < kTolerance;
  });
}

LatticeCorner corner_at(const TagLattice& tags, const Corner& corner) {
  const Eigen::Vector3d steps = tags.lattice_from_board * corner.point / tags.lattice.spacing_mm;
  return {static_cast<int>(std::lround(steps.x())), static_cast<int>(std::lround(steps.y())), corner.pixel};
}

// "tags 3, 7"; empty for none.
std::string tags_text(const std::vector<int>& ids) {
  std::string text;
  for (const int id : ids) text += (text.empty() ? "tags " : ", ") + std::to_string(id);
  return text;
}

}  // namespace

TagLattice lattice_of(const TagLayout& board) {
  std::vector<Eigen::Vector3d> points;
  for (const Tag& tag : board.tags)
    for (const Eigen::Vector3d& corner : corners_in_object(tag)) points.push_back(corner);
  if (points.empty()) throw std::runtime_error("board \"" + board.name + "\" has no tags");
  Eigen::Vector3d low = points.front(), high = low;
  for (const Eigen::Vector3d& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  for (int parts = 1; parts <= 20; ++parts) {
    const double spacing_mm = board.tags.front().size_mm / parts;
    if (!fits(points, low, spacing_mm)) continue;
    TagLattice tags;
    const Eigen::Vector3d steps = (high - low) / spacing_mm;
    tags.lattice = {.columns = static_cast<int>(std::lround(steps.x())) + 1,
                    .rows = static_cast<int>(std::lround(steps.y())) + 1,
                    .spacing_mm = spacing_mm};
    tags.lattice_from_board = Eigen::Translation3d(-low);
    return tags;
  }
  throw std::runtime_error("board \"" + board.name +
                           "\": its corners do not lie on one lattice; use a flat board of upright tags whose gap is "
                           "half a tag (threadstation target prints one)");
}

BoardPicture on_lattice(const TagLattice& tags, const TagLayout& board, const TagObservation& seen) {
  BoardPicture picture;
  for (const Corner& corner : match_corners(board, seen)) picture.push_back(corner_at(tags, corner));
  return picture;
}

std::optional<BoardCheck> check_board(const BoardPicture& picture) {
  if (picture.size() < 8) return std::nullopt;
  std::vector<cv::Point2d> nodes, pixels;
  for (const LatticeCorner& corner : picture) {
    nodes.emplace_back(corner.column, corner.row);
    pixels.emplace_back(corner.pixel.x(), corner.pixel.y());
  }
  // The map goes from pictures to the lattice, so that distances from nodes are in spacings at any size of the board.
  cv::Mat1b inside;
  constexpr double kSpacing = 1.0;
  const cv::Mat1d map = cv::findHomography(pixels, nodes, cv::RANSAC, kSpacing, inside, 2000, 0.9999);
  if (map.empty() || cv::countNonZero(inside) * 2 < static_cast<int>(picture.size())) return std::nullopt;
  BoardCheck check;
  for (int i = 0; i < inside.rows; ++i) check.displaced.push_back(inside(i) == 0);
  // Pixel rows count downwards and lattice rows upwards, so the map of a board seen from the front reverses
  // orientation.
  Eigen::Matrix3d lattice_from_pixel;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) lattice_from_pixel(row, column) = map(row, column);
  const double depth = lattice_from_pixel.row(2).dot(picture.front().pixel.homogeneous());
  check.mirrored = lattice_from_pixel.determinant() * depth > 0.0;
  return check;
}

std::string displaced_tags(const TagLattice& tags, const TagLayout& board, const std::vector<BoardPicture>& pictures) {
  std::map<std::pair<int, int>, int> tag_at;  // lattice node -> id
  for (const Tag& tag : board.tags)
    for (const Eigen::Vector3d& point : corners_in_object(tag)) {
      const LatticeCorner node = corner_at(tags, {point, {}});
      tag_at[{node.column, node.row}] = tag.id;
    }
  std::map<int, int> seen, displaced;  // numbers of pictures, by tag
  for (const BoardPicture& picture : pictures) {
    const std::optional<BoardCheck> check = check_board(picture);
    if (!check) continue;
    std::map<int, int> corners_displaced;
    for (std::size_t c = 0; c < picture.size(); ++c)
      corners_displaced[tag_at.at({picture[c].column, picture[c].row})] += check->displaced[c] ? 1 : 0;
    for (const auto& [id, corners] : corners_displaced) {
      ++seen[id];
      displaced[id] += corners >= 3 ? 1 : 0;  // a good tag may share one or two nodes with a displaced neighbour
    }
  }
  std::vector<int> found;
  for (const auto& [id, times] : displaced)
    if (times >= 2 && 2 * times > seen[id]) found.push_back(id);
  return tags_text(found);
}

std::string tags_beside(const TagLayout& board, const std::vector<TagObservation>& pictures) {
  std::map<int, std::vector<cv::Point2d>> places;  // of unknown tags' middles in the board's plane, mm
  for (const TagObservation& picture : pictures) {
    std::vector<cv::Point2d> pixels, plane;
    for (const Corner& corner : match_corners(board, picture)) {
      pixels.emplace_back(corner.pixel.x(), corner.pixel.y());
      plane.emplace_back(corner.point.x(), corner.point.y());
    }
    if (pixels.size() < 8) continue;
    const cv::Mat1d map = cv::findHomography(pixels, plane, cv::RANSAC, 0.1 * board.tags.front().size_mm);
    if (map.empty()) continue;
    for (const TagDetection& tag : picture) {
      if (std::ranges::any_of(board.tags, [&](const Tag& known) { return known.id == tag.id; })) continue;
      Eigen::Vector2d middle = Eigen::Vector2d::Zero();
      for (const Eigen::Vector2d& corner : tag.corners_px) middle += 0.25 * corner;
      std::vector<cv::Point2d> place;
      cv::perspectiveTransform(std::vector<cv::Point2d>{{middle.x(), middle.y()}}, place, map);
      places[tag.id].push_back(place.front());
    }
  }
  std::vector<int> found;
  for (const auto& [id, seen] : places) {
    std::vector<double> x, y;
    for (const cv::Point2d& place : seen) x.push_back(place.x), y.push_back(place.y);
    const cv::Point2d middle(median(x), median(y));
    const auto alike = std::ranges::count_if(
        seen, [&](const cv::Point2d& place) { return cv::norm(place - middle) < 0.25 * board.tags.front().size_mm; });
    if (alike >= 3 && 2 * alike > std::ssize(seen)) found.push_back(id);
  }
  return tags_text(found);
}

}  // namespace calibration
