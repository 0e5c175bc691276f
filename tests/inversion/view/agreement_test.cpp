#include "inversion/view/agreement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace inversion {
namespace {

// A picture of 8 x 4 pixels: the left half of one colour, the right of another; diffuser of radiance 2.
View two_halves(const cv::Vec3f& left, const cv::Vec3f& right) {
  View view;
  view.light.position = {10, 0, 0};
  view.light.intensity = Eigen::Vector3d::Constant(2 * std::numbers::pi * 100);
  view.mask = cv::Mat1b(4, 8, std::uint8_t{255});
  view.image = cv::Mat3f(4, 8, left);
  view.image.colRange(4, 8).setTo(cv::Scalar(right[0], right[1], right[2]));
  return view;
}

cv::Mat3f scaled(const cv::Mat3f& picture, double factor) {
  cv::Mat3f result;
  picture.convertTo(result, CV_32F, factor);
  return result;
}

cv::Mat3f raised(const cv::Mat3f& picture, const cv::Vec3f& by) {
  cv::Mat3f result;
  cv::add(picture, cv::Scalar(by[0], by[1], by[2]), result);
  return result;
}

TEST(AgreementTest, APictureAgreesWithItself) {
  const View view = two_halves({1, 2, 3}, {4, 5, 6});
  const ViewAgreement same = agreement(view, view.image, 4);
  EXPECT_EQ(same.relative_rmse(), 0);
  EXPECT_EQ(same.relative_bias, 0);
}

TEST(AgreementTest, ErrorsAreRootMeanSquaresOverTheMeanOfThePhotograph) {
  const View view = two_halves({2, 4, 6}, {8, 8, 8});
  cv::Mat3f rendered = raised(view.image, {1, 1, 1});
  rendered.colRange(4, 8).setTo(cv::Scalar(5, 8, 8));  // red 3 too dark
  const ViewAgreement found = agreement(view, rendered, 4);
  // Squares 1 and 9 / 3 over two halves, in units of the diffuser's 2; means 4 and 8.
  EXPECT_NEAR(found.mean_square, (1.0 + 3.0) / 2 / 4, 1e-12);
  EXPECT_NEAR(found.mean_reference, 6.0 / 2, 1e-12);
  EXPECT_NEAR(found.relative_rmse(), std::sqrt(2.0) / 6, 1e-12);
  EXPECT_NEAR(found.relative_bias, (1.0 - 1.0) / 2 / 6, 1e-12);
}

TEST(AgreementTest, RenderedBrighterByATenthIsABiasOfATenth) {
  const View view = two_halves({1, 2, 3}, {4, 5, 6});
  const ViewAgreement found = agreement(view, scaled(view.image, 1.1), 3);
  EXPECT_NEAR(found.relative_bias, 0.1, 1e-6);  // pictures are floats
}

TEST(AgreementTest, BlocksCountByTheirMaskedPixels) {
  View view = two_halves({3, 3, 3}, {6, 6, 6});
  view.mask.setTo(0);
  view.mask(0, 0) = view.mask(1, 1) = view.mask(2, 2) = 255;  // three on the left
  view.mask(3, 7) = 255;                                      // one on the right
  cv::Mat3f rendered = view.image.clone();
  rendered.colRange(4, 8).setTo(cv::Scalar(8, 8, 8));
  const ViewAgreement found = agreement(view, rendered, 4);
  EXPECT_NEAR(found.mean_square, 0.25 * 4 / 4, 1e-12);
  EXPECT_NEAR(found.mean_reference, (0.75 * 3 + 0.25 * 6) / 2, 1e-12);
}

TEST(AgreementTest, WhatAveragesOutInsideABlockOrLiesOutsideTheMaskIsNoError) {
  View view = two_halves({3, 3, 3}, {6, 6, 6});
  cv::Mat3f rendered = view.image.clone();
  rendered(0, 0) += cv::Vec3f(1, 1, 1);
  rendered(3, 3) -= cv::Vec3f(1, 1, 1);
  view.mask(1, 6) = 0;
  rendered(1, 6) = {100, 100, 100};
  EXPECT_NEAR(agreement(view, rendered, 4).relative_rmse(), 0, 1e-12);
  EXPECT_GT(agreement(view, rendered, 2).relative_rmse(), 0.01);
}

TEST(AgreementTest, TheLampsIntensityDoesNotMatter) {
  View view = two_halves({3, 4, 5}, {6, 7, 9});
  const cv::Mat3f rendered = raised(view.image, {0.5F, 0.25F, 0});
  const double before = agreement(view, rendered, 4).relative_rmse();
  view.light.intensity *= 8;
  view.image = scaled(view.image, 8);
  EXPECT_NEAR(agreement(view, scaled(rendered, 8), 4).relative_rmse(), before, 1e-12);
}

TEST(AgreementTest, OverallErrorOfEqualViewsIsTheirs) {
  const View view = two_halves({3, 3, 3}, {6, 6, 6});
  const ViewAgreement one = agreement(view, raised(view.image, {1, 0, 2}), 4);
  EXPECT_NEAR(overall_relative_rmse({one, one, one}), one.relative_rmse(), 1e-12);
}

TEST(AgreementTest, EveryViewCountsAlikeInTheOverallError) {
  const ViewAgreement dark{.mean_square = 0.01, .mean_reference = 0.1},
      bright{.mean_square = 0.07, .mean_reference = 0.7};
  EXPECT_NEAR(overall_relative_rmse({dark, bright}), 0.2 / 0.4, 1e-12);
}

}  // namespace
}  // namespace inversion
