#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "renderer/weave/crossings.h"
#include "renderer/weave/patch_measures.h"
#include "renderer/weave/yarn_path.h"
#include "tests/renderer/weave/relaxed_cloths.h"

namespace renderer {
namespace {

using Eigen::Vector3d;

double crown_to_trough(const YarnPatch& patch, const Yarn& yarn) {
  const PeriodicSpline line = center_line(patch, yarn);
  double low = 0, high = 0;
  for (std::size_t k = 0; k < 32 * line.control_points.size(); ++k) {
    const double z = spline_value(line, static_cast<double>(k) / 32).z();
    low = std::min(low, z);
    high = std::max(high, z);
  }
  return high - low;
}

// Crimp of Peirce's square cloth of pitch p and sum of diameters D.
double peirce_crimp(double pitch, double D) {
  return 2 * taut_half_wave(pitch, D / 4, D / 4).length_mm() / pitch - 1;
}

// The tension-dominated limit: T r^2 / B = 25. Peirce's geometry is planar: yarns turn on circles, one at a time. In
// space both yarns of a tight crossing wrap each other, press on each other's flanks, and lift each other's crowns by
// up to 1.3 % (p / D = 0.9; the same with four times the control points, a fiftieth of the overlap and ten times the
// tension). With that h1 + h2 as his D the crimp at p / D <= 1 lies up to 4 % below his; with D = d1 + d2 it lies
// below by 0.7 %: the two yarns find a shorter way together than he gives them.
TEST(RelaxationTest, CrimpUnderTensionIsThatOfPeircesTable) {
  std::printf("p/D    crimp %%   Peirce %%  with D = h1 + h2  difference %%  with D = d1 + d2  difference %%\n");
  const double table[][2]{{0.9, 18.71}, {1.0, 14.35}, {1.25, 8.648}, {1.5, 5.848}, {2.0, 3.212}, {3.0, 1.405}};
  for (const auto& [pitch, percent] : table) {
    const RelaxedPatch cloth = relax(plain_cloth(pitch, pitch, 5), {.points_per_crossing = 24, .overlap_goal = 0.002});
    expect_at_rest(cloth);
    const double D = crown_to_trough(cloth.patch, cloth.patch.yarns.front()) +
                     crown_to_trough(cloth.patch, cloth.patch.yarns.back());
    const double crimp = cloth.patch.crimp_warp, measured = crimp / peirce_crimp(pitch, D) - 1,
                 nominal = 100 * crimp / percent - 1;
    std::printf("%.2f   %7.3f   %7.3f   %.4f            %+.2f           1                %+.2f\n", pitch, 100 * crimp,
                percent, D, 100 * measured, 100 * nominal);
    if (pitch > 1) {
      EXPECT_LT(measured, 0.02) << pitch;
      EXPECT_GT(measured, -0.005) << pitch;
    }
    EXPECT_LT(std::abs(nominal), 0.02) << pitch;
    // No yarn is shorter than the shortest way round the sections that it crosses, where they are (overlap counted).
    const double overlap = cloth.report.overlap * 0.25, contact = 0.5 - overlap,
                 other = crown_to_trough(cloth.patch, cloth.patch.yarns.back()) / 2;
    const HalfWave shortest = taut_half_wave(pitch, contact - other, other);
    EXPECT_GT(crimp, 2 * shortest.length_mm() / pitch - 1) << pitch;
  }
}

// Peirce's yarns wrap one another as if the other were rigid: each arc presses on one point of the yarn below, its
// crown, and a limp yarn that is pressed at one point kinks there. So two limp yarns find the shorter way above, and
// Peirce's path is in balance where the other yarn is stiff. With a weft of straight rods his formula holds at any
// angle of wrapping: h1 = D, p = D / sin(theta), c = (theta + cot(theta)) sin(theta) - 1; at p / D = 1.1 the warp wraps
// by 65 degrees.
TEST(RelaxationTest, CrimpOverStiffWeftIsThatOfPeirceAtAnyWrapping) {
  for (const double pitch : {1.1, 1.25, 1.5, 2.0, 3.0}) {
    Draft draft = plain_cloth(pitch, pitch, 5);
    draft.weft.bending_n_mm2 = 1e4;
    const RelaxedPatch cloth = relax(draft, {.points_per_crossing = 24, .overlap_goal = 0.002});
    expect_at_rest(cloth);
    const double D = crown_to_trough(cloth.patch, cloth.patch.yarns.front()) +
                     crown_to_trough(cloth.patch, cloth.patch.yarns.back());
    const double angle = std::asin(D / pitch), expected = (angle + 1 / std::tan(angle)) * std::sin(angle) - 1;
    std::printf("p/D %.2f: D = h1 + h2 = %.4f, crimp %.3f %%, Peirce %.3f %%, difference %+.2f %%\n", pitch, D,
                100 * cloth.patch.crimp_warp, 100 * expected, 100 * (cloth.patch.crimp_warp / expected - 1));
    EXPECT_LT(cloth.patch.crimp_warp / expected, 1.02) << pitch;
    EXPECT_GT(cloth.patch.crimp_warp / expected, 0.995) << pitch;
  }
}

TEST(RelaxationTest, CrimpWithoutTensionIsThatOfClampedBeams) {
  for (const double pitch : {10.0, 20.0}) {
    const RelaxedPatch cloth = relax(plain_cloth(pitch, pitch, 1e-7));
    expect_at_rest(cloth);
    const double h = crown_to_trough(cloth.patch, cloth.patch.yarns.front());
    const double expected = 0.6 * h * h / (pitch * pitch);
    std::printf("p/D %2.0f: crimp %.5f %%, 0.6 (h/p)^2 = %.5f %%\n", pitch, 100 * cloth.patch.crimp_warp,
                100 * expected);
    EXPECT_NEAR(cloth.patch.crimp_warp / expected, 1, 0.02);
  }
}

TEST(RelaxationTest, CrimpIsInterchangedAsTheStiffnessesAndPitchesOfTheBeamsSay) {
  const struct {
    double warp_pitch, weft_pitch, stiffer_weft;
  } cases[]{{10, 12, 1}, {10, 10, 2}, {12, 10, 1.5}, {14, 10, 0.7}};
  for (const auto& c : cases) {
    Draft draft = plain_cloth(c.warp_pitch, c.weft_pitch, 1e-7);
    draft.weft.bending_n_mm2 = c.stiffer_weft * bending_of(draft.warp);
    const RelaxedPatch cloth = relax(draft);
    expect_at_rest(cloth);
    const double ratio = crown_to_trough(cloth.patch, cloth.patch.yarns.front()) /
                         crown_to_trough(cloth.patch, cloth.patch.yarns.back());
    const double expected = c.stiffer_weft * std::pow(c.weft_pitch / c.warp_pitch, 3);
    std::printf("p1 %.0f p2 %.0f B2/B1 %.1f: h1/h2 = %.4f, B2 p2^3 / (B1 p1^3) = %.4f\n", c.warp_pitch, c.weft_pitch,
                c.stiffer_weft, ratio, expected);
    EXPECT_NEAR(ratio / expected, 1, 0.03);
  }
}

TEST(RelaxationTest, ClothThatIsTighterThanPeircesJamIsReportedAsJammed) {
  for (const double pitch :
       {0.80, 0.84, 0.86, 0.865, 0.867, 0.87, 0.88, 0.90, 0.95}) {  // square cloth jams at sqrt(3) / 2
    const RelaxedPatch cloth = relax(plain_cloth(pitch, pitch, 0.5));
    std::printf("p/D %.3f: overlap %.2f %% of the radius, gap at the crowns %.2f %%%s\n", pitch,
                100 * cloth.report.overlap, 100 * cloth.report.crown_gap, cloth.report.jammed ? ", jammed" : "");
    EXPECT_EQ(cloth.report.jammed, pitch < 0.866) << pitch;
    EXPECT_TRUE(cloth.report.as_drafted);
  }
}

// Where floats begin and end both yarns are inclined, and yarns that touch there are further apart in height than their
// contact distance, in a 2/2 twill by 3.3 %. Between tangents 1.5 % are left at any sett, because the yarns are curved.
TEST(RelaxationTest, AnOpenTwillIsNotTakenForJammed) {
  for (const double pitch : {0.65, 0.8, 1.0}) {
    Draft draft = twill_draft(2, 2);
    draft.warp.pitch_mm = pitch;
    draft.weft.pitch_mm = 1.2;
    const RelaxedPatch cloth = relax(draft);
    const Crossing crossing = crossings_of(cloth.patch).front();
    std::printf("warp pitch %.2f mm: gap %.2f %%, in height %.2f %%\n", pitch, 100 * cloth.report.crown_gap,
                100 * (std::abs(crossing.warp_z_mm - crossing.weft_z_mm) / 0.5 - 1));
    EXPECT_FALSE(cloth.report.jammed);
    EXPECT_LT(cloth.report.crown_gap, kJammedCrownGap / 2);
  }
}

TEST(RelaxationTest, SquareClothIsSymmetric) {
  for (const double pitch : {0.9, 1.2, 3.0}) {
    const RelaxedPatch cloth = relax(plain_cloth(pitch, pitch, 0.5));
    const double h1 = crown_to_trough(cloth.patch, cloth.patch.yarns.front()),
                 h2 = crown_to_trough(cloth.patch, cloth.patch.yarns.back());
    std::printf("p/D %.1f: h1 %.6f h2 %.6f\n", pitch, h1, h2);
    EXPECT_NEAR(h1 / h2, 1, 0.005);
  }
}

// With more control points of cubic splines, curvature converges at second order and energies converge faster. Contact
// has one stiffness and, by the choice of numbers, the same 96 samples per crossing.
TEST(RelaxationTest, EnergyAndCrimpConvergeAtSecondOrderOrBetterInTheControlPoints) {
  const auto at = [](int points) {
    return relax(plain_cloth(1.25, 1.25, 0.5), {.points_per_crossing = points, .overlap_goal = 0, .most_stages = 3});
  };
  const RelaxedPatch finest = at(48);
  double first_error = 0, first_crimp = 0, last_error = 0, last_crimp = 0;
  for (const int points : {4, 8, 16}) {
    const RelaxedPatch cloth = at(points);
    last_error = std::abs(cloth.report.energy_n_mm / finest.report.energy_n_mm - 1);
    last_crimp = std::abs(cloth.patch.crimp_warp / finest.patch.crimp_warp - 1);
    if (points == 4) {
      first_error = last_error;
      first_crimp = last_crimp;
    }
    std::printf("%2d points per crossing: energy off by %.2e, crimp by %.2e\n", points, last_error, last_crimp);
  }
  std::printf("order over two halvings: energy %.2f, crimp %.2f\n", std::log2(first_error / last_error) / 2,
              std::log2(first_crimp / last_crimp) / 2);
  EXPECT_GT(std::log2(first_error / last_error) / 2, 2);
  EXPECT_GT(std::log2(first_crimp / last_crimp) / 2, 2);
}

// At rest only the gradient that is left, summed over a yarn's points, stands against the yarn's contacts. Along the
// yarn, where points stay where they are drawn, the half turns of these weaves make the balance; the next test has a
// weave without them.
TEST(RelaxationTest, ContactForcesOnEachYarnBalance) {
  std::vector<Draft> drafts = ready_weaves(4);
  for (const Draft& draft : uneven_drafts()) drafts.push_back(draft);
  for (const Draft& draft : drafts) {
    const RelaxedPatch cloth = relax(draft);
    const double most = cloth.report.contact_forces_n.cwiseAbs().maxCoeff() / cloth.report.force_scale_n;
    std::printf("%-10s largest sum of contact forces on a yarn: %.1e of the pull on it\n", draft.name.c_str(), most);
    EXPECT_LT(most, 1e-6) << draft.name;
  }
}

// A yarn that slides has an energy that depends a little on points and samples of contact; this pushes it along, and
// the cloth as a whole sideways, the less the more points there are. Up and down nothing is left.
TEST(RelaxationTest, ContactForcesAlongTheYarnsOfAnIrregularWeaveVanishWithMorePoints) {
  Draft draft = plain_cloth(0.9, 0.9, 0.5);
  draft.warp_over.clear();
  for (const char* pick : {"XX.X..", "X..XX.", ".X.X.X", "..XXX.", "X.X..X", ".XX.XX"})
    draft.warp_over.push_back(
        {pick[0] == 'X', pick[1] == 'X', pick[2] == 'X', pick[3] == 'X', pick[4] == 'X', pick[5] == 'X'});
  double in_plane[2];
  for (const int fine : {0, 1}) {
    const RelaxedPatch cloth = relax(draft, {.points_per_crossing = fine ? 24 : 8});
    expect_at_rest(cloth);
    const Eigen::Matrix3Xd forces = cloth.report.contact_forces_n / cloth.report.force_scale_n;
    in_plane[fine] = forces.topRows<2>().cwiseAbs().maxCoeff();
    const double up = forces.row(2).cwiseAbs().maxCoeff();
    std::printf("%2d points: largest sum of contact forces %.1e in the plane, %.1e up, of the pull on a yarn\n",
                fine ? 24 : 8, in_plane[fine], up);
    EXPECT_LT(up, 1e-6);
  }
  EXPECT_LT(in_plane[1], in_plane[0] / 9);  // second order or better
}

TEST(RelaxationTest, TheSameDraftGivesTheSamePatchToTheLastBit) {
  for (const Draft& draft : uneven_drafts()) {
    const YarnPatch a = relax(draft).patch, b = relax(draft).patch;
    for (std::size_t i = 0; i < a.yarns.size(); ++i) EXPECT_EQ(a.yarns[i].control_points, b.yarns[i].control_points);
  }
}

TEST(RelaxationTest, HeightScaleIsAppliedAfterTheYarnsCameToRest) {
  Draft draft = plain_cloth(0.9, 0.9, 0.5);
  const YarnPatch natural = relax(draft).patch;
  draft.height_scale = 0.7;
  const YarnPatch low = relax(draft).patch;
  EXPECT_EQ(low.height_scale, 0.7);
  for (std::size_t i = 0; i < natural.yarns.size(); ++i)
    for (std::size_t k = 0; k < natural.yarns[i].control_points.size(); ++k)
      EXPECT_LT((low.yarns[i].control_points[k] - natural.yarns[i].control_points[k].cwiseProduct(Vector3d(1, 1, 0.7)))
                    .norm(),
                1e-12);
}

TEST(RelaxationTest, AYarnOnTheWrongSideOfACrossingIsNoticed) {
  const Draft draft = plain_cloth(0.9, 0.9, 0.5);
  YarnPatch patch = relax(draft).patch;
  EXPECT_TRUE(is_as_drafted(patch, draft));
  for (Vector3d& point : patch.yarns[0].control_points) point.z() = -point.z();
  EXPECT_FALSE(is_as_drafted(patch, draft));
}

// Yarns are as long as Peirce's at p / D = 1.25 and may choose the size of their cell: it is square again, without a
// force.
TEST(RelaxationTest, ACellOfFreePeriodsTakesTheSizeThatItsYarnsFill) {
  Draft draft = plain_cloth(1.25, 1.25, 0);
  draft.warp.contraction = draft.weft.contraction = 0.02;

  draft.free_periods = true;
  const RelaxedPatch cloth = relax(draft);
  expect_at_rest(cloth);
  const double length = (1 + peirce_crimp(1.25, 1)) * 2.5;
  std::printf("periods %.5f %.5f mm from 2.5 mm, crimp %.4f, cell force %.1e %.1e N, overlap %.2f %%\n",
              cloth.patch.period_x_mm, cloth.patch.period_y_mm, cloth.patch.crimp_warp, cloth.report.cell_force_n.x(),
              cloth.report.cell_force_n.y(), 100 * cloth.report.overlap);
  EXPECT_NEAR(cloth.patch.period_x_mm / cloth.patch.period_y_mm, 1, 1e-3);
  EXPECT_LT(cloth.patch.period_x_mm, 2.5);
  EXPECT_LT(cloth.patch.period_x_mm * (1 + cloth.patch.crimp_weft), length);  // 2 % shorter, but for the stretch
  EXPECT_LE(cloth.report.overlap, kMostOverlap);
}

TEST(RelaxationTest, EveryReadyWeaveComesToRestAsDraftedWithLittleOverlap) {
  for (const Draft& draft : ready_weaves(6)) expect_woven(draft);
}

TEST(RelaxationTest, TheWorkIsAskedAtEachLookAtTheEnergyAndStopsWhenToldTo) {
  const Draft draft = plain_cloth(1.25, 1.25, 0.5);
  int calls = 0;
  const RelaxedPatch whole = relax(draft, {.progress = [&](const RelaxationReport& so_far) {
                                     EXPECT_LE(so_far.newton_steps, ++calls);
                                     return true;
                                   }});
  EXPECT_GE(calls, whole.report.newton_steps + whole.report.factorizations);
  const int until_stop = calls / 2;
  int asked = 0;
  EXPECT_THROW(relax(draft, {.progress = [&](const RelaxationReport&) { return ++asked < until_stop; }}),
               std::runtime_error);
  EXPECT_EQ(asked, until_stop);
  EXPECT_EQ(relax(draft).report.newton_steps, whole.report.newton_steps);
}

}  // namespace
}  // namespace renderer
