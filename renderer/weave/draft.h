// Draft: what the weaver prescribes for one repeat of a cloth; which yarn lies on top where, yarn sizes, sett,
// threads.
//
// Frame of the cloth, here and in patch.h: warp ends run along +y and stand side by side along +x, weft picks run
// along +x and follow one another along +y; +z is the face. Row 0 of the structure is the first pick, at the smallest
// y.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace renderer {

// One of the two systems of yarns.
struct YarnSystem {
  double diameter_mm = 0.5;
  double pitch_mm = 0.9;        // from one yarn of this system to the next
  std::vector<int> threads{0};  // yarn k is spun from thread threads[k % size], an index into the scene's threads

  double tex = 0.0;  // g per km of yarn; 0: unknown, then so is the cloth's mass

  // For the relaxation (relaxation.h); of forces only ratios change the shape.
  double bending_n_mm2 = 0.0;  // stiffness; 0: bending_of() takes that of a bundle of loose fibers
  double tension_n = 0.5;      // dead load on each yarn
  double flatness = 1.0;     // width / height of the section, an ellipse of the round yarn's area, wide in the plane
  double contraction = 0.0;  // above 0: instead of the load, a spring that wants this share less than the drawn path
};

// Bending stiffness: as given, or kBundleBending x diameter^2, 0.0125 N mm^2 for a yarn of 0.5 mm.
double bending_of(const YarnSystem& system);
inline constexpr double kBundleBending = 0.05;  // N

struct Draft {
  std::string name;
  std::vector<std::vector<bool>> warp_over;  // [pick][end]: true where the warp lies on top
  YarnSystem warp, weft;
  bool free_periods = false;  // relaxation: the cell takes the size at which it pulls at nothing; needs contraction
  double height_scale = 1.0;  // multiplies the heights of all centre lines; not 1: no longer a contact shape
};

// The common weaves; sizes, sett and threads are those of YarnSystem until the caller changes them.
Draft plain_draft();
Draft twill_draft(int over, int under);  // warp over `over` picks, under `under`, the diagonal rising to the right
Draft satin_draft(int ends, int step);   // warp-faced; `step` is coprime to `ends`, neither 1 nor ends - 1
Draft basket_draft(int yarns);           // plain weave of groups of `yarns` ends and picks

// Yarns in one patch: the least common multiple of the structure's repeat and the order of the threads.
int ends_in_patch(const Draft& draft);
int picks_in_patch(const Draft& draft);

// What keeps this draft from being woven, as one line, or nothing: empty or ragged structure, a yarn that never
// interlaces, yarns that lie loose on the others, sizes that are not positive, neighbouring yarns that overlap
// (pitch < diameter), a patch of more than kMostCrossings crossings.
// A sett in which round yarns jam is woven; its overlap is measured (YarnPatch::least_gap_mm).
std::optional<std::string> check_draft(const Draft& draft);

inline constexpr int kPointsPerCrossing = 8;  // of a yarn's curve, from one crossing to the next
inline constexpr int kMostCrossings = 4096;
inline constexpr int kMostThreads = 4096;
inline constexpr double kMostContraction = 0.3, kMostFlatness = 4;

}  // namespace renderer
