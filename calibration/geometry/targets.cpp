#include "calibration/geometry/targets.h"

#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

namespace calibration {
namespace {

constexpr double kWithBorder = 10.0 / 8.0;  // the black square is eight cells wide, the white border around it one

Tag make_tag(int id, double size_mm, const Eigen::Vector3d& centre, const Eigen::Vector3d& right,
             const Eigen::Vector3d& up) {
  Tag tag{.id = id, .size_mm = size_mm};
  tag.object_from_tag.linear().col(0) = right;
  tag.object_from_tag.linear().col(1) = up;
  tag.object_from_tag.linear().col(2) = right.cross(up);
  tag.object_from_tag.translation() = centre;
  return tag;
}

}  // namespace

TagLayout make_corner_tags(const std::string& name, double tag_mm, double offset_mm, int first_id,
                           const Eigen::Vector3d& right, const Eigen::Vector3d& up) {
  TagLayout layout{.name = name, .tags = {}};
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d centre = (i % 2 ? offset_mm : -offset_mm) * right + (i < 2 ? offset_mm : -offset_mm) * up;
    layout.tags.push_back(make_tag(first_id + i, tag_mm, centre, right, up));
  }
  return layout;
}

TagLayout make_platform_ring(int count, double radius_mm, double tag_mm, int first_id) {
  const double half = 0.5 * kWithBorder * tag_mm;
  // Neighbours touch at the corners of their inner edges.
  if (count < 3 || !(tag_mm > 0.0) || !((radius_mm - half) * std::tan(std::numbers::pi / count) >= half)) {
    throw std::runtime_error("platform ring: " + std::to_string(count) + " tags of " + std::to_string(tag_mm) +
                             " mm do not fit side by side on a radius of " + std::to_string(radius_mm) +
                             " mm: take at least 3, and fewer or smaller ones");
  }
  TagLayout layout{.name = "platform ring", .tags = {}};
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    const Eigen::Vector3d outwards(std::cos(angle), std::sin(angle), 0.0);
    const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(outwards);
    layout.tags.push_back(make_tag(first_id + i, tag_mm, radius_mm * outwards, right, -outwards));
  }
  return layout;
}

TagLayout make_table_sheet(const std::vector<Eigen::Vector2d>& centres_mm, double tag_mm, int first_id) {
  TagLayout layout{.name = "table", .tags = {}};
  for (const Eigen::Vector2d& centre : centres_mm) {
    for (const Tag& other : layout.tags) {
      const Eigen::Vector2d apart = other.object_from_tag.translation().head<2>() - centre;
      if (apart.cwiseAbs().maxCoeff() < kWithBorder * tag_mm) {
        throw std::runtime_error("table tags: the " + std::to_string(tag_mm) +
                                 " mm tags overlap with their white borders: put their centres further apart");
      }
    }
    layout.tags.push_back(make_tag(first_id + static_cast<int>(layout.tags.size()), tag_mm,
                                   {centre.x(), centre.y(), 0.0}, Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitX()));
  }
  return layout;
}

TagLayout scaled(TagLayout layout, double control_bar_mm) {
  const double scale = control_bar_mm / kControlBar_mm;
  for (Tag& tag : layout.tags) {
    tag.size_mm *= scale;
    tag.object_from_tag.translation() *= scale;
  }
  return layout;
}

std::string shared_ids(const std::vector<TagLayout>& layouts) {
  std::map<int, std::string> owners;
  for (const TagLayout& layout : layouts) {
    for (const Tag& tag : layout.tags) {
      const auto [owner, added] = owners.emplace(tag.id, layout.name);
      if (!added) return "tag " + std::to_string(tag.id) + " is on " + owner->second + " and on " + layout.name;
    }
  }
  return "";
}

}  // namespace calibration
