// The patch that is rendered, from a draft: yarns at rest, and as far as the draft asks for it, what makes them less
// ideal than round, equal ones.
//
// Slubs are there while the yarns come to rest: contact knows the thickness of each place, so that crowns rise and
// neighbours give way where yarns are thick. (To thicken the yarns of an even patch afterwards would press them into
// each other by the sum of both deviations.) Stiffness and load are those of the mean yarn all along. Flattening is one
// number per yarn: the ray tracer's elliptical yarns are round ones stretched as a whole (patch_curves.h), and steps
// between differently stretched pieces would show.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "renderer/weave/relaxation.h"

namespace renderer {

// The patch of a draft. An unrelaxed draft keeps the analytic shapes, and its report is empty. Errors:
// std::runtime_error, one line: those of check_draft() and check_at_rest(); plies thicker than their yarn.
RelaxedPatch woven_patch(const Draft& draft, const RelaxationOptions& options = {});

// The patch with its plies instead of each yarn; what was measured stays that of the yarns. A flat yarn's plies are
// pressed as it is. Each ply is a yarn of the thread, thinner than its yarn: it scatters and absorbs as the thread does
// whose spool was digitized, at each crossing of light with it.
YarnPatch with_plies(const YarnPatch& patch, const Plies& plies);

// The round strands of one yarn, which keep their places in its section all along it, as untwisted fibers do.
struct Strands {
  double radius_mm = 0;
  // In mm, in the yarn's section: across the yarn in the cloth's plane, and along the third axis of a frame that is
  // right-handed along the yarn (up for the weft, down for the warp).
  std::vector<Eigen::Vector2d> places{};
};
// The patch with its strands instead of each yarn, `of_yarns` in the order of its yarns; what was measured stays that
// of the yarns. Strands are round in flat yarns too. Errors: std::invalid_argument when the counts differ;
// std::runtime_error when a strand is thicker than its yarn.
YarnPatch with_strands(const YarnPatch& patch, const std::vector<Strands>& of_yarns);

// Several periods of a patch as one: `across` of them side by side along x, `along` along y, each yarn as long as all
// of them. The cloth is the same; its yarns can then be made unlike each other.
YarnPatch repeated(const YarnPatch& patch, int across, int along);

// The radius of a ply: as given, or as large as lets the plies touch each other inside the yarn.
double ply_radius_mm(const Plies& plies, double yarn_radius_mm);

}  // namespace renderer
