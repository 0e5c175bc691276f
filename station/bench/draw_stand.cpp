#include "station/bench/draw_stand.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "calibration/geometry/target_stand.h"
#include "station/documents/degree.h"

namespace station {
namespace {

using Eigen::Vector2d;

constexpr double kPlate_mm = 5;          // room for the plate's thickness
constexpr double kLip_mm = 2;            // of the plate's face that the lip covers: less than the tags leave free
constexpr double kWall_mm = 6;           // of the cheek around the plate
constexpr double kSupported = 0.75;      // part of the plate's back that lies on the cheek
constexpr double kShortestBase_mm = 38;  // behind the middle
constexpr double kBarLength_mm = 56, kBarHeight_mm = 12;

void path(cairo_t* pen, const std::vector<Vector2d>& corners, const Vector2d& origin) {
  cairo_new_path(pen);  // a text leaves one behind
  for (const Vector2d& corner : corners) cairo_line_to(pen, origin.x() + corner.x(), origin.y() - corner.y());
  cairo_close_path(pen);
  cairo_stroke(pen);
}

std::string with_mm(const char* text, double mm) {
  char out[120];
  std::snprintf(out, sizeof out, text, mm);
  return out;
}

// A dimension line with its length above it.
void dimension(cairo_t* pen, const Vector2d& from, const Vector2d& to) {
  cairo_new_path(pen);
  cairo_move_to(pen, from.x(), from.y());
  cairo_line_to(pen, to.x(), to.y());
  for (const Vector2d& end : {from, to}) {
    cairo_move_to(pen, end.x() - 1, end.y() + 1);
    cairo_line_to(pen, end.x() + 1, end.y() - 1);
  }
  cairo_stroke(pen);
  const Vector2d middle = (from + to) / 2;
  const bool upright = std::abs(to.x() - from.x()) < 1e-9;
  draw_text(pen, middle.x() + (upright ? 1.5 : -6), middle.y() - 1, 3, with_mm("%.1f", (to - from).norm()));
}

}  // namespace

std::vector<Vector2d> cheek_outline(const RigFile& rig, int stand) {
  const double lean = calibration::kStandLeans_rad.at(static_cast<std::size_t>(stand - 1)),
               panel = rig.spectralon.plate_mm;
  const Vector2d up(-std::sin(lean), std::cos(lean)),
      out(std::cos(lean), std::sin(lean));  // along the plate, off its face
  const Vector2d edge(calibration::ledge_mm(lean, panel), calibration::kLedgeHeight_mm);  // of the face, at its foot
  const Vector2d corner = edge - kPlate_mm * out, top = corner + kSupported * panel * up;
  const Vector2d lip = edge + out + kLip_mm * up, front = lip + kWall_mm * out,
                 foot = front - (kLip_mm + kWall_mm) * up;
  const Vector2d behind = top - kWall_mm * out;
  const double back = std::min(-kShortestBase_mm, behind.x());
  return {{std::max(foot.x(), front.x()), 0}, foot, front, lip, edge + out, corner, top, behind, {back, 0}};
}

void draw_stand(cairo_t* pen, const RigFile& rig, int stand, Paper paper) {
  const std::vector<Vector2d> cheek = cheek_outline(rig, stand);
  double left = 0, right = 0, height = 0;
  for (const Vector2d& corner : cheek) {
    left = std::min(left, corner.x());
    right = std::max(right, corner.x());
    height = std::max(height, corner.y());
  }
  const double page_width = page_mm(paper).x();
  double below = kPageMargin_mm + 16;
  for (int cheek_number = 0; cheek_number < 2; ++cheek_number) {
    const Vector2d origin((page_width - left - right) / 2, below + height);
    below += height + 18;
    cairo_set_line_width(pen, 0.2);
    path(pen, cheek, origin);
    cairo_set_line_width(pen, 0.1);
    cairo_new_path(pen);
    for (const double end : {-1.5, 3.0}) cairo_line_to(pen, origin.x(), origin.y() - end);  // the stand's middle
    cairo_stroke(pen);
    dimension(pen, {origin.x() + left, origin.y() + 8}, {origin.x() + right, origin.y() + 8});
    dimension(pen, {origin.x() + right + 6, origin.y()}, {origin.x() + right + 6, origin.y() - height});
  }
  for (int bar = 0; bar < 2; ++bar) {
    const double x = page_width / 2 - 70 + 76 * bar;
    cairo_set_line_width(pen, 0.2);
    cairo_rectangle(pen, x, below, kBarLength_mm, kBarHeight_mm);
    cairo_stroke(pen);
    cairo_set_line_width(pen, 0.1);
    dimension(pen, {x, below + kBarHeight_mm + 6}, {x + kBarLength_mm, below + kBarHeight_mm + 6});
    dimension(pen, {x + kBarLength_mm + 4, below + kBarHeight_mm}, {x + kBarLength_mm + 4, below});
  }
  const double lean_deg = calibration::kStandLeans_rad.at(static_cast<std::size_t>(stand - 1)) / kDegree;
  draw_text(pen, kPageMargin_mm, kPageMargin_mm + 5, 4.5,
            "Stand " + std::to_string(stand) + with_mm(": leans the target back by %.0f degrees", lean_deg));
  double line = below + kBarHeight_mm + 20;
  for (const std::string& sentence :
       {std::string(
            "Millimetres. Cut two cheeks and two bars from 4 mm plywood or acrylic; a printer or a laser cutter"),
        std::string(
            "takes the SVG file as it is. Glue the bars between the cheeks, at their foot, one in front, one at the"),
        "rear edge. Write the number " + std::to_string(stand) + " on it and paint it matt black.",
        std::string("The short line at the foot is the stand's middle: it belongs over the platform's axis, to 3 cm."),
        with_mm("The face of the target stands on the ledge %.1f mm before the middle,",
                calibration::ledge_mm(lean_deg * kDegree, rig.spectralon.plate_mm)) +
            with_mm(" %.1f mm above the platform.", calibration::kLedgeHeight_mm),
        std::string(
            "An angle or a length that is a little off does no harm: every picture measures how the target stands.")}) {
    draw_text(pen, kPageMargin_mm, line, 3.4, sentence);
    line += 6;
  }
}

}  // namespace station
