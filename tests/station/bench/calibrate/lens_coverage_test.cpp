// What a calibration's lens pictures are said to have shown of the board.
#include "station/bench/calibrate/lens_coverage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/geometry/target_stand.h"
#include "station/bench/calibrate/calibration_plan.h"
#include "station/bench/calibrate/lamps.h"
#include "tests/calibration/geometry/synthetic_views.h"
#include "tests/places.h"

namespace station {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

struct Coverage : testing::Test {
  RigFile rig = read_rig(std::string(DATA_DIR) + "/rigs/simulated.json");
  cv::Size size{rig.simulation->truth.lens.width_px, rig.simulation->truth.lens.height_px};
  calibration::Lens lens = engraved_lens(rig, size);
  LensCoverage covered{rig};
  std::mt19937 random{1128};

  void photograph(const Eigen::Isometry3d& camera_from_board, double noise_px = 0.1) {
    covered.add(calibration::synthetic::observe(lens, rig.board, camera_from_board, noise_px, random), size);
  }
  // As the plan has it: of the steps that are always taken, or of all.
  void photograph_plan(bool all, double noise_px) {
    for (const CalibrationStep& step : make_calibration_plan(rig))
      if (step.role == CalibrationRole::lens && (all || !step.if_needed))
        photograph(rig.world_from_camera_by_tape.inverse() *
                       calibration::turned(step.platform_angle_rad, step.arrangement.pose),
                   noise_px);
  }
  // Of a white frame, half as large as the pictures.
  int light_at(double across, double down) const {
    cv::Mat3b frame(size / 2, cv::Vec3b(200, 200, 200));
    covered.shade_unseen(frame);
    return frame(static_cast<int>(down * frame.rows), static_cast<int>(across * frame.cols))[0];
  }
};

TEST_F(Coverage, BeforeTheFirstPictureNothingIsSaidOrDarkened) {
  EXPECT_THAT(covered.sentence(), IsEmpty());
  EXPECT_EQ(light_at(0.5, 0.5), 200);
  covered.add({}, size);  // the board was not seen
  EXPECT_EQ(covered.pictures(), 0);
}

TEST_F(Coverage, WhereTheBoardWasSeenTheFrameStaysLight) {
  photograph(calibration::synthetic::facing(1500, 0, 0, 0));
  EXPECT_EQ(light_at(0.5, 0.5), 200);
  EXPECT_LT(light_at(0.02, 0.02), 120);
  EXPECT_GT(covered.share(), 0);
  EXPECT_LT(covered.share(), 0.5);
}

TEST_F(Coverage, EachLeanIsAskedForUntilItWasSeen) {
  const auto far = [&](double yaw, double pitch) { return calibration::synthetic::facing(900, yaw, pitch, 0); };
  photograph(far(0, 0));
  for (const char* lean : {"turned to the left", "turned to the right", "tilted back", "tilted forward"})
    EXPECT_THAT(covered.sentence(), HasSubstr(lean));
  photograph(far(-0.4, 0));  // about its own upward axis: its face to the camera's left
  EXPECT_THAT(covered.sentence(), Not(HasSubstr("turned to the left")));
  EXPECT_THAT(covered.sentence(), HasSubstr("turned to the right"));
  photograph(far(0.4, 0));
  photograph(far(0, -0.4));  // its face up
  EXPECT_THAT(covered.sentence(), Not(HasSubstr("tilted back")));
  EXPECT_THAT(covered.sentence(), HasSubstr("tilted forward"));
  photograph(far(0, 0.4));
  EXPECT_THAT(covered.sentence(), Not(HasSubstr("not yet")));
}

TEST_F(Coverage, TheWholePlanShowsMostOfThePicture) {
  photograph_plan(true, 0.1);
  std::cout << covered.pictures() << " pictures. " << covered.sentence() << "\n";
  EXPECT_GT(covered.share(), 0.8);
}

TEST_F(Coverage, ThreeStandsOfGoodPicturesMakeTheLensKnown) {
  EXPECT_FALSE(covered.lens_is_known()) << "nothing was seen";
  photograph_plan(false, 0.04);
  EXPECT_TRUE(covered.lens_is_known());
  std::cout << covered.pictures() << " pictures. " << covered.sentence() << "\n";
  EXPECT_THAT(covered.sentence(), HasSubstr(" px, and 0.03 are enough."));
  EXPECT_THAT(covered.sentence(), Not(HasSubstr("not yet")));
}

TEST_F(Coverage, AfterPoorPicturesMoreAreWanted) {
  photograph_plan(false, 0.3);
  EXPECT_FALSE(covered.lens_is_known());
  EXPECT_THAT(covered.sentence(), HasSubstr("The lens is known to 0."));
}

}  // namespace
}  // namespace station
