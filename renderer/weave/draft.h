// A draft: what the weaver prescribes for one repeat of a cloth, which is which yarn lies on top where, yarn sizes,
// sett and threads.
//
// Frame of the cloth, here and in patch.h: warp ends run along +y and stand side by side along +x, weft picks run along
// +x and follow one another along +y; +z is the face. Row 0 of the structure is the first pick, at the smallest y.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace renderer {

// One of the two systems of yarns.
struct YarnSystem {
  double diameter_mm = 0.5;
  double pitch_mm = 0.9;        // from one yarn of this system to the next
  std::vector<int> threads{0};  // yarn k is spun from thread threads[k % size], an index into the scene's threads

  double tex = 0.0;  // g per km of yarn; 0: unknown, and the cloth's mass with it

  // For the relaxation (relaxation.h). Only the ratios of forces change the shape.
  double bending_n_mm2 = 0.0;  // stiffness; 0: that of a bundle of loose fibers (bending_of())
  double tension_n = 0.5;      // dead load on each yarn
  double flatness = 1.0;       // width / height of the section, an ellipse of the round yarn's area, wide in the plane
  double contraction = 0.0;  // above 0: instead of the load a spring, by this share shorter at rest than the drawn path
};

// The bending stiffness of a system's yarns: as given, or kBundleBending x diameter^2, 0.0125 N mm^2 for 0.5 mm.
double bending_of(const YarnSystem& system);
inline constexpr double kBundleBending = 0.05;  // N

// How yarns differ from each other. Deviations are normal, cut at twice their scale.
struct Unevenness {
  double radius = 0;  // scale of the deviations of yarns' radii, as a share of the radius
  double pitch = 0;   // scale of their shifts from the even sett, as a share of the free room between yarns
  int shades = 1;     // thread t becomes one of the threads t shades .. t shades + shades - 1
  std::uint64_t seed = 1;
};

// How yarns differ along themselves (unevenness.h).
struct Slubs {
  double radius = 0;     // standard deviation of the radius along a yarn, as a share of the radius
  double twist = 0;      // standard deviation of the turns of its plies per mm, as a share of their mean
  double length_mm = 5;  // distance along the yarn at which the correlation of either has fallen to 1 / e
  double shade_mm = 0;   // mean length of the pieces of a yarn that have one shade; 0: each yarn has one shade
};

// How yarns are made of plies twisted round their centre line.
struct Plies {
  int count = 1;
  double turns_per_mm = 0.5;  // rounded to whole turns in a period, so that the patch repeats
  double radius_mm = 0;       // of a ply; 0: as large as lets the plies touch each other inside the yarn
};

struct Draft {
  std::string name;
  std::vector<std::vector<bool>> warp_over;  // [pick][end]: true where the warp lies on top
  YarnSystem warp, weft;
  bool free_periods = false;  // in relaxation the cell takes the size at which nothing pulls at it; needs contraction
  double height_scale = 1.0;  // multiplies the heights of all centre lines; other than 1, yarns no longer just touch
  bool relaxed = true;        // false: yarns keep the shapes of initial_patch(), for figures too large to be relaxed

  // What makes yarns less ideal than round, equal ones; woven_patch() uses it, relax() does not. The modulus: a yarn
  // under a load of q per length becomes lower by the factor 1 + q / (modulus x diameter), and as much wider: an
  // ellipse of the same area, at most as wide as the sett lets it be. 0: sections keep their system's flatness.
  double transverse_modulus_n_mm2 = 0.0;
  Unevenness unevenness{};
  Slubs slubs{};
  Plies plies{};
};

// The common weaves. Sizes, sett and threads are those of YarnSystem until the caller changes them.
Draft plain_draft();
Draft twill_draft(int over, int under);  // warp over `over` picks, under `under`, the diagonal rising to the right
Draft satin_draft(int ends, int step);   // warp-faced; `step` is coprime to `ends`, neither 1 nor ends - 1
Draft basket_draft(int yarns);           // plain weave of groups of `yarns` ends and picks

// The number of yarns in one patch: the least common multiple of the structure's repeat and the order of the threads.
int ends_in_patch(const Draft& draft);
int picks_in_patch(const Draft& draft);

// What keeps this draft from being woven, as one line, or nothing: an empty or ragged structure, a yarn that never
// interlaces, yarns that lie loose on the others, sizes that are not positive, neighbouring yarns that overlap (pitch <
// diameter), a patch of more than kMostCrossings crossings (kMostUnrelaxedCrossings where yarns are not relaxed), or
// unrelaxed yarns with settings that only relaxation can follow. A sett in which round yarns jam is woven; its overlap
// is measured (YarnPatch::least_gap_mm).
std::optional<std::string> check_draft(const Draft& draft);

inline constexpr int kPointsPerCrossing = 8;  // of a yarn's curve, from one crossing to the next
inline constexpr int kMostCrossings = 4096, kMostUnrelaxedCrossings = 1 << 18;
inline constexpr int kMostThreads = 4096;
inline constexpr double kMostContraction = 0.3, kMostFlatness = 4;
inline constexpr double kMostUnevenness = 0.2;
inline constexpr int kMostShades = 64, kMostPlies = 12;
inline constexpr double kMostTurnsPerMm = 20, kMostModulus = 1e9;
inline constexpr double kLeastSlub = 0.01, kMostSlub = 1e4;  // mm

}  // namespace renderer
