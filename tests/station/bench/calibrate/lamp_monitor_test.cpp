#include "station/bench/calibrate/lamp_monitor.h"

#include <gtest/gtest.h>

namespace station {
namespace {

using Picture = std::map<int, double>;

TEST(LampMonitor, OutputsAreToldByTheTagsInTheOpen) {
  // Seven tags have brightness 1 to 7; the lamp fades by 0.3 % a picture; each picture hides or shades one or two of
  // them.
  std::vector<Picture> pictures;
  std::vector<double> truth;
  for (int i = 0; i < 9; ++i) {
    const double output = 1 - 0.003 * i;
    truth.push_back(output);
    Picture picture;
    for (int tag = 0; tag < 7; ++tag) picture[400 + tag] = (tag + 1) * output;
    picture[400 + i % 7] *= i % 2 ? 7.0 : 0.02;         // behind the white panel, or in its shadow
    picture[400 + (i + 2) % 7] *= i % 3 ? 1.0 : 0.985;  // at the shadow's edge
    pictures.push_back(picture);
  }
  const auto outputs = lamp_outputs(pictures);
  ASSERT_EQ(outputs.size(), pictures.size());
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    ASSERT_TRUE(outputs[i].has_value()) << i;
    // a shaded tag shifts its own typical brightness by a part of 1.5 %
    EXPECT_NEAR(*outputs[i] / *outputs[4], truth[i] / truth[4], 0.002) << i;
  }
}

TEST(LampMonitor, APictureWithoutThreeTagsThatAgreeTellsNothing) {
  std::vector<Picture> pictures(5, Picture{{400, 1.0}, {401, 2.0}, {402, 3.0}});
  pictures[1][400] = 0.98;
  pictures[2].erase(401);
  pictures[3] = {};
  const auto outputs = lamp_outputs(pictures);
  EXPECT_TRUE(outputs[0].has_value());
  EXPECT_FALSE(outputs[1].has_value());
  EXPECT_FALSE(outputs[2].has_value());
  EXPECT_FALSE(outputs[3].has_value());
}

TEST(LampMonitor, ATagsRadianceIsTheMeanWithinItAndASaturatedTagIsLeftOut) {
  calibration::Developed picture{.radiance = cv::Mat3f(60, 80, cv::Vec3f(0.1F, 0.1F, 0.1F)),
                                 .saturated = cv::Mat1b(60, 80, uchar{0})};
  picture.radiance(cv::Rect(10, 10, 20, 20)).setTo(cv::Scalar(0.5, 0.25, 0.25));
  const auto square = [](double x, double y) {
    return std::array<Eigen::Vector2d, 4>{Eigen::Vector2d(x, y + 19), {x + 19, y + 19}, {x + 19, y}, {x, y}};
  };
  const calibration::StillTags tags{{400, square(10, 10)}, {401, square(50, 30)}};
  EXPECT_NEAR(tag_radiances(picture, tags).at(400), 1.0, 1e-6);
  EXPECT_NEAR(tag_radiances(picture, tags).at(401), 0.3, 1e-6);
  picture.saturated(15, 15) = 255;
  EXPECT_FALSE(tag_radiances(picture, tags).contains(400));
}

}  // namespace
}  // namespace station
