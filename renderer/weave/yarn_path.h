// The analytic path of a yarn in its own plane: Peirce's geometry of round yarns, rounded where the cloth is open.
//
// A yarn lies at +height where it is on top and at -height where it is below, flat along floats. Between a crossing
// on top and one below it turns in an arc, runs straight, and turns back. In tight cloth the arcs lie on the crossing
// yarns' sections (circles of radius d = contact distance = sum of both radii round their centre lines): the shortest
// path that does not enter them, the tension-dominated limit (Peirce 1937; there D = 2 d and h is twice our height).
// In open cloth that path would bend sharply on the crossing yarn and no stiffness allows it; there the arcs take
// kLeastArcShare of the path, which gives the crimp 0.6 (h/p)^2 of clamped beams of small slope. No arc is tighter
// than contact, so neither shape enters the crossing yarns.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "renderer/weave/draft.h"

namespace renderer {

// The heights of the crowns over the mid-plane; warp + weft = contact distance, so that yarns touch where they cross.
struct CrownHeights {
  double warp_mm = 0.0, weft_mm = 0.0;
};

// The crown heights by Peirce's crimp interchange h1 / h2 = (B2 p2^3) / (B1 p1^3) (p2 = weft pitch, along the warp)
// with the yarns' bending stiffness (bending_of); equal for square cloth. Where that split would press yarns into each
// other, it is moved to the nearest one that does not; where no split is free (the sett jams), to the middle.
CrownHeights split_heights(const YarnSystem& warp, const YarnSystem& weft);

// Half a wave: from the crown at 0 down to the middle of the way to the next crossing, where the path's height is 0.
struct HalfWave {
  double crown_mm = 0.0;     // height at the crown
  double radius_mm = 1.0;    // of the arc that starts, level, at the crown
  double angle_rad = 0.0;    // of the arc: the weave angle
  double straight_mm = 0.0;  // from the end of the arc to the middle

  double length_mm() const { return radius_mm * angle_rad + straight_mm; }
  Eigen::Vector2d at(double arc_length_mm) const;  // (distance from the crown, height)
};

// Peirce's half-wave; `pitch_mm` is the way to the next crossing. When round yarns jam, the arc is as wide as the
// pitch allows (no straight part, radius below the contact distance) and cuts into the crossing yarns.
HalfWave taut_half_wave(double pitch_mm, double crown_mm, double crossing_crown_mm);

// The half-wave that is woven: the taut one or, where its arc takes less than kLeastArcShare of it, the one whose arc
// takes that share.
HalfWave half_wave(double pitch_mm, double crown_mm, double crossing_crown_mm);

// The path of one period as (along, height) at n = `points_per_crossing` (even) equal steps of arc length from one
// crossing to the next, starting half a pitch before the first crossing (along = 0); crossing i is point n i + n / 2.
std::vector<Eigen::Vector2d> yarn_path(const std::vector<bool>& on_top, double pitch_mm, const HalfWave& wave,
                                       int points_per_crossing = kPointsPerCrossing);

// The least share of the path that arcs take. With the arc's share a, the crimp of a shallow half-wave is (1 - 2 a / 3)
// / (2 (1 - a / 2)^2) (h/p)^2, which is 0.6 (h/p)^2 at this a.
inline constexpr double kLeastArcShare = 0.53752;

}  // namespace renderer
