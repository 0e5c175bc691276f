// When a calibration was made, by its pictures.
#include "station/bench/calibrate/calibration_pictures.h"

#include <gtest/gtest.h>

namespace station {
namespace {

CalibrationPicture taken(CalibrationRole role, const std::string& day) {
  CalibrationPicture picture;
  picture.role = role;
  picture.utc = "2026-11-" + day + "T10:00:00.000Z";
  return picture;
}

TEST(CalibrationsDate, IsThatOfThePartThatIsTheOldest) {
  EXPECT_EQ(oldest_part_utc({}), "");
  std::vector<CalibrationPicture> pictures{taken(CalibrationRole::turning, "02"), taken(CalibrationRole::lens, "02"),
                                           taken(CalibrationRole::front_light, "02"),
                                           taken(CalibrationRole::response, "02")};
  EXPECT_EQ(oldest_part_utc(pictures), taken(CalibrationRole::lens, "02").utc);
  // The light again, weeks later.
  pictures[2] = taken(CalibrationRole::front_light, "27");
  pictures.push_back(taken(CalibrationRole::back_light, "28"));
  EXPECT_EQ(oldest_part_utc(pictures), taken(CalibrationRole::lens, "02").utc);
  // And at last the others.
  for (CalibrationPicture& picture : pictures)
    if (part_of(picture.role) != "light") picture.utc = "2026-11-29T10:00:00.000Z";
  EXPECT_EQ(oldest_part_utc(pictures), taken(CalibrationRole::back_light, "28").utc);
}

}  // namespace
}  // namespace station
