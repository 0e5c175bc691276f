// Whole programs on every board, from their beginning to their end: the platform is homed, and its devices are checked.
// (A capture is in home_here_test.cpp.)
#include <gtest/gtest.h>

#include <cmath>

#include "tests/station/commands/lab.h"

namespace station_test {
namespace {

struct EveryBoard : testing::TestWithParam<Board> {
  Lab lab{GetParam(), kLeftNearDeg};
};

INSTANTIATE_TEST_SUITE_P(OnAPty, EveryBoard,
                         testing::Values(Board::grbl_with_switch, Board::grbl_here, Board::documented_with_switch,
                                         Board::documented_here, Board::zaber),
                         [](const auto& board) {
                           std::string name = name_of(board.param);
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

TEST_P(EveryBoard, IsHomed) {
  EXPECT_EQ(lab.run({"home", "--rig", lab.rig_file()}), 0);
  EXPECT_NEAR(std::remainder(lab.angle_deg(), 360), 0, 0.03);
}

TEST_P(EveryBoard, PassesACheck) {
  EXPECT_EQ(lab.run({"check", "--rig", lab.rig_file()}), 0);
  EXPECT_NEAR(std::remainder(lab.angle_deg(), 360), 0, 0.03);
}

}  // namespace
}  // namespace station_test
