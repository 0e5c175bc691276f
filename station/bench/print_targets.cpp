#include "station/bench/print_targets.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "calibration/geometry/target_stand.h"
#include "calibration/geometry/targets.h"
#include "station/bench/draw_stand.h"
#include "station/documents/board_file.h"
#include "station/documents/degree.h"
#include "station/documents/reader.h"

namespace station {
namespace {

constexpr double kBarHeight_mm = 26.0;  // of the strip at the bottom: control bar and text

// The drawing in the plane spanned by `right` and `up`: x, y, towards the viewer.
std::vector<calibration::Tag> drawn(const calibration::TagLayout& print, double control_bar_mm,
                                    const Eigen::Vector3d& right, const Eigen::Vector3d& up) {
  Eigen::Isometry3d sheet_from_object = Eigen::Isometry3d::Identity();
  sheet_from_object.linear().row(0) = right;
  sheet_from_object.linear().row(1) = up;
  sheet_from_object.linear().row(2) = right.cross(up);
  constexpr double kBar = calibration::kControlBar_mm;
  std::vector<calibration::Tag> tags = calibration::scaled(print, kBar * kBar / control_bar_mm).tags;
  for (calibration::Tag& tag : tags) tag.object_from_tag = sheet_from_object * tag.object_from_tag;
  return tags;
}

struct Box {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = Eigen::Vector2d::Constant(-1e9);

  void take(const Eigen::Vector2d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
};

Box extent(const TargetSheet& sheet) {
  Box box;
  for (calibration::Tag tag : sheet.tags) {
    tag.size_mm *= 1.5;  // white around it
    for (const Eigen::Vector3d& corner : calibration::corners_in_object(tag)) box.take(corner.head<2>());
  }
  for (const double radius : sheet.circles_mm)
    for (const double sign : {-1.0, 1.0}) box.take(Eigen::Vector2d::Constant(sign * radius));
  for (const double edge : sheet.squares_mm)
    for (const double sign : {-0.5, 0.5}) box.take(Eigen::Vector2d::Constant(sign * edge));
  return box;
}

// From here on cairo's unit is the millimetre on the page, y downwards.

void draw_tag(cairo_t* pen, const calibration::Tag& tag, const Eigen::Vector2d& origin) {
  const cv::Mat1b bitmap = calibration::tag_bitmap(tag.id);
  const double cell = tag.size_mm / 8.0;
  const Eigen::Vector2d centre(origin.x() + tag.object_from_tag.translation().x(),
                               origin.y() - tag.object_from_tag.translation().y());
  const Eigen::Vector3d right = tag.object_from_tag.linear().col(0);
  cairo_save(pen);
  cairo_translate(pen, centre.x(), centre.y());
  cairo_rotate(pen, -std::atan2(right.y(), right.x()));
  // Ink as one path, so that no hairlines remain between neighbouring cells.
  for (int row = 0; row < bitmap.rows; ++row)
    for (int column = 0; column < bitmap.cols; ++column)
      if (bitmap(row, column) == 0) cairo_rectangle(pen, (column - 5) * cell, (row - 5) * cell, cell, cell);
  cairo_set_source_rgb(pen, 0, 0, 0);
  cairo_fill(pen);
  cairo_restore(pen);
}

void draw_control_bar(cairo_t* pen, const Eigen::Vector2d& page, const TargetSheet& sheet) {
  const double left = kPageMargin_mm, y = page.y() - kPageMargin_mm;
  cairo_rectangle(pen, left, y - 2.0, calibration::kControlBar_mm, 2.0);
  cairo_fill(pen);
  cairo_set_line_width(pen, 0.2);
  for (int tick = 0; tick <= 10; ++tick) {
    cairo_move_to(pen, left + 10.0 * tick, y - 2.0);
    cairo_line_to(pen, left + 10.0 * tick, y - (tick % 5 == 0 ? 5.0 : 3.5));
  }
  cairo_stroke(pen);
  draw_text(pen, left, y - 17.0, 3.6, sheet.title);
  draw_text(pen, left, y - 12.5, 2.8, sheet.advice);
  draw_text(pen, left, y - 8.0, 2.8,
            "Print without scaling. Measure this bar (drawn: 100 mm) and enter it as control_bar_mm.");
}

void draw(cairo_t* pen, const TargetSheet& sheet, Paper paper) {
  const Eigen::Vector2d page = page_mm(paper), origin = origin_on_page_mm(sheet, paper);
  cairo_set_line_width(pen, 0.1);
  for (const double radius : sheet.circles_mm) {
    cairo_new_sub_path(pen);
    cairo_arc(pen, origin.x(), origin.y(), radius, 0.0, 2.0 * std::numbers::pi);
  }
  for (const double edge : sheet.squares_mm)
    cairo_rectangle(pen, origin.x() - edge / 2, origin.y() - edge / 2, edge, edge);
  cairo_stroke(pen);
  for (const calibration::Tag& tag : sheet.tags) draw_tag(pen, tag, origin);
  draw_control_bar(pen, page, sheet);
}

// Numbers for people and for programs: id, edge, centre x, y on the sheet, direction of the tag's right edge.
nlohmann::json sheet_json(const TargetSheet& sheet) {
  nlohmann::json tags = nlohmann::json::array();
  for (const calibration::Tag& tag : sheet.tags) {
    const Eigen::Vector3d centre = tag.object_from_tag.translation(), right = tag.object_from_tag.linear().col(0);
    const auto tidy = [](double number) { return std::round(number * 1e6) / 1e6 + 0.0; };
    for (const double number : {static_cast<double>(tag.id), tidy(tag.size_mm), tidy(centre.x()), tidy(centre.y()),
                                tidy(std::atan2(right.y(), right.x()) / kDegree)})
      tags.push_back(number);
  }
  return {{"file", sheet.file}, {"tags", tags}};
}

nlohmann::json geometry_json(const RigFile& rig, const std::vector<TargetSheet>& sheets) {
  nlohmann::json list = nlohmann::json::array();
  for (const TargetSheet& sheet : sheets) list.push_back(sheet_json(sheet));
  return {{"format", "threadstation/board"},
          {"version", 1},
          {"name", "board of rig \"" + rig.name + "\""},
          {"pattern", "tags"},
          {"rows", rig.board_grid.rows},
          {"columns", rig.board_grid.columns},
          {"tag_mm", rig.board_grid.tag_mm},
          {"pitch_mm", rig.board_grid.pitch_mm},
          {"first_id", rig.board_grid.first_id},
          {"thickness_mm", rig.board_thickness_mm},
          {"control_bar_mm", calibration::kControlBar_mm},
          {"sheets", list}};
}

}  // namespace

Eigen::Vector2d origin_on_page_mm(const TargetSheet& sheet, Paper paper) {
  const Eigen::Vector2d page = page_mm(paper);
  const Box box = extent(sheet);
  const Eigen::Vector2d size = box.high - box.low, middle = 0.5 * (box.high + box.low);
  const Eigen::Vector2d free(page.x() - 2 * kPageMargin_mm, page.y() - 2 * kPageMargin_mm - kBarHeight_mm);
  if ((size.array() > free.array()).any())
    throw std::runtime_error(sheet.title + " needs " + std::to_string(std::lround(size.x())) + " x " +
                             std::to_string(std::lround(size.y())) + " mm, the paper has " +
                             std::to_string(std::lround(free.x())) + " x " + std::to_string(std::lround(free.y())) +
                             " mm free; make it smaller in the rig file");
  return {page.x() / 2 - middle.x(), kPageMargin_mm + free.y() / 2 + middle.y()};
}

std::vector<TargetSheet> target_sheets(const RigFile& rig) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  const double bar = rig.control_bar_mm;
  std::vector<TargetSheet> sheets;
  sheets.push_back({.file = "board",
                    .title = "Board for lens and platform",
                    .advice = "Glue it flat on glass or aluminium composite; leave 10 mm white around the tags.",
                    .tags = drawn(rig.board, bar, x, y)});
  sheets.push_back({.file = "platform_ring",
                    .title = "Ring on the platform",
                    .advice = "Cut along the circles, glue it on the platform about its axis.",
                    .tags = drawn(rig.platform_ring, bar, x, y)});
  double inner = 1e9, outer = 0.0;
  for (const calibration::Tag& tag : sheets.back().tags) {
    const double radius = tag.object_from_tag.translation().norm(), half = 0.625 * tag.size_mm;
    inner = std::min(inner, radius - half);
    outer = std::max(outer, std::hypot(radius + half, half));
  }
  sheets.back().circles_mm = {inner, outer};
  sheets.push_back(
      {.file = "table",
       .title = "Tags on the table",
       .advice =
           "Tape it behind the platform, top away from the camera; blacken the middle, it lies behind the threads.",
       .tags = drawn(rig.table_tags, bar, y, -x)});
  sheets.push_back({.file = "spectralon",
                    .title = "Surround of the Spectralon target",
                    .advice = "Cut along both squares; glue it on the matt black plate around the white square.",
                    .tags = drawn(rig.spectralon.tags, bar, x, y),
                    .squares_mm = {rig.spectralon.white_mm, rig.spectralon.plate_mm}});
  if (rig.colour_chart)
    sheets.push_back(
        {.file = "colour_chart",
         .title = "Surround of the colour chart",
         .advice =
             "Cut along the square; glue it on the matt black plate, the chart in its middle, brown at the top left.",
         .tags = drawn(rig.colour_chart->tags, bar, x, y),
         .squares_mm = {rig.colour_chart->plate_mm}});
  sheets.push_back({.file = "holder",
                    .title = "Tags on the spool holder",
                    .advice = "Cut out the tags with their white borders; glue them on the frame in these places.",
                    .tags = drawn(rig.holder_tags, bar, y, z)});
  sheets.push_back({.file = "lamp",
                    .title = "Tags on the lamp holder",
                    .advice = "Glue it around the lamp, the middle on its bright face.",
                    .tags = drawn(rig.lamp_tags, bar, x, y),
                    .circles_mm = {rig.lamp_radius_mm}});
  return sheets;
}

std::vector<std::filesystem::path> print_targets(const RigFile& rig, Paper paper, const std::filesystem::path& folder) {
  const std::vector<TargetSheet> sheets = target_sheets(rig);
  for (const TargetSheet& sheet : sheets) origin_on_page_mm(sheet, paper);  // all of them fit, or nothing is written
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code)
    throw std::runtime_error("cannot make " + folder.string() + ": " + code.message() + "; choose a writable folder");
  std::vector<std::filesystem::path> files;
  for (const TargetSheet& sheet : sheets) {
    const DrawPage page = [&](cairo_t* pen) { draw(pen, sheet, paper); };
    files.push_back(folder / (sheet.file + ".pdf"));
    write_page_pdf(files.back(), paper, page);
    files.push_back(folder / (sheet.file + ".png"));
    write_page_png(files.back(), paper, page);
  }
  for (int stand = 1; stand <= static_cast<int>(calibration::kStandLeans_rad.size()); ++stand) {
    const DrawPage page = [&](cairo_t* pen) { draw_stand(pen, rig, stand, paper); };
    files.push_back(folder / ("stand_" + std::to_string(stand) + ".pdf"));
    write_page_pdf(files.back(), paper, page);
    files.push_back(folder / ("stand_" + std::to_string(stand) + ".svg"));
    write_page_svg(files.back(), paper, page);
  }
  files.push_back(folder / "board.json");
  write_json_file(files.back(), geometry_json(rig, sheets));
  return files;
}

}  // namespace station
