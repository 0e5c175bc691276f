// Ready garments as meshes whose uv is the flat pattern in millimetres, for designers who have no mesh of their own
// yet. They are deterministic; z is up.
//
// A hanging cloth hardly stretches: rings and rows keep the length that they have in the pattern, and fold where there
// is less room for them. Folds are laid regularly and then fall into what gravity makes of them, by position-based
// dynamics (renderer/scene/hanging_sheet.h), without passing through themselves.
#pragma once

#include <functional>
#include <variant>

#include "renderer/scene/uv_mesh.h"

namespace renderer {

// A skirt cut as a sector of a ring, sewn along one straight seam, hung from the waist. It falls into folds, because
// the rings of the pattern grow faster than the hips that it hangs round. The axis is z, the lowest point of the hem at
// z = 0, the face outwards.
struct SkirtShape {
  double waist_radius_mm = 110, length_mm = 600;
  double flare_deg = 300;  // angle of the sector; 360 is a full circle skirt
  int folds = 11;
  double hem_mm = 25;  // turned up behind the lower edge
};

// A rectangle hung by its upper edge in pleats that open towards the hem: the falling end of a sari. It lies about the
// plane y = 0, the face towards -y, the lowest point of the hem at z = 0.
struct PleatedShape {
  double width_mm = 900, height_mm = 1100;
  int pleats = 9;
  double gathered = 0.55;  // width as hung over width, at the upper edge
  double hem_mm = 25;      // turned up behind the lower edge
};

// A square that hangs over a ball, a little off its middle; its lowest corner is at z = 0.
struct DrapeShape {
  double side_mm = 900;
  double ball_radius_mm = 220;
};

// A sari's whole length, pleated across and pinned over a shoulder: a bar along x that slopes to the right. In front
// (towards -y) hangs the face; the lowest point is at z = 0.
struct SariShape {
  double length_mm = 6000, width_mm = 1150;
  double front_mm = 2700;  // of the length, in front of the shoulder
  int pleats = 10;
  double gathered = 0.6;  // width over the shoulder over width
  double shoulder_radius_mm = 100, slope_deg = 3;
  double hem_mm = 8;  // turned up behind the end in front
};

using GarmentShape = std::variant<SkirtShape, PleatedShape, DrapeShape, SariShape>;

// The mesh of a garment. `progress` is called now and then with the finished part; returning false stops the work.
// Errors: std::runtime_error with one line for a skirt that is narrower than its pattern lets it be, or when stopped by
// `progress`.
UvMesh garment_mesh(const GarmentShape& shape, const std::function<bool(double)>& progress = {});

}  // namespace renderer
