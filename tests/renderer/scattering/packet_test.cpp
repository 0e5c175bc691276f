#include "renderer/scattering/packet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace renderer {
namespace {

template <class Width>
class PacketTest : public testing::Test {};
using Widths =
    testing::Types<std::integral_constant<int, 4>, std::integral_constant<int, 8>, std::integral_constant<int, 16>>;
TYPED_TEST_SUITE(PacketTest, Widths);

// Calls judge(x, y) for packets of random numbers between low and high.
template <int n, class Judge>
void randomly(float low, float high, const Judge& judge) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<float> uniform(low, high);
  for (int i = 0; i < 100000 / n; ++i) {
    std::array<float, static_cast<std::size_t>(n)> x{}, y{};
    for (float& number : x) number = uniform(engine);
    for (float& number : y) number = uniform(engine);
    judge(Packet<n>::load(x.data()), Packet<n>::load(y.data()));
  }
}

template <int n>
double at(const Packet<n>& packet, int lane) {
  return static_cast<double>(packet[lane]);
}

TYPED_TEST(PacketTest, FunctionsAreAsExactAsTheirHeaderSays) {
  constexpr int n = TypeParam::value;
  randomly<n>(-86.0f, 86.0f, [](const auto& x, const auto&) {
    const auto y = exp(x);
    for (int i = 0; i < n; ++i) EXPECT_NEAR(at(y, i) / std::exp(at(x, i)), 1, 1e-7);
  });
  randomly<n>(-1.0f, 1.0f, [](const auto& x, const auto& y) {
    const auto angle = asin(x), azimuth = atan2(y, x), down = floor(30.0f * x), root = sqrt(abs(y));
    for (int i = 0; i < n; ++i) {
      EXPECT_NEAR(at(angle, i), std::asin(at(x, i)), 2e-7);
      EXPECT_NEAR(at(azimuth, i), std::atan2(at(y, i), at(x, i)), 3e-7);
      EXPECT_EQ(down[i], std::floor(30.0f * x[i]));
      EXPECT_EQ(root[i], std::sqrt(std::abs(y[i])));
    }
  });
}

TYPED_TEST(PacketTest, FunctionsKeepTheirEnds) {
  using P = Packet<TypeParam::value>;
  const int last = TypeParam::value - 1;
  EXPECT_EQ(exp(P(0.0f))[last], 1.0f);
  EXPECT_EQ(exp(P(-1e4f))[last], 0.0f);
  EXPECT_EQ(exp(P(-HUGE_VALF))[last], 0.0f);
  EXPECT_EQ(asin(P(0.0f))[last], 0.0f);
  EXPECT_EQ(asin(P(1.0f))[last], std::asin(1.0f));
  EXPECT_EQ(asin(P(-1.0f))[last], std::asin(-1.0f));
  EXPECT_EQ(atan2(P(0.0f), P(0.0f))[last], 0.0f);
  EXPECT_EQ(atan2(P(0.0f), P(-1.0f))[last], std::atan2(0.0f, -1.0f));
  EXPECT_EQ(atan2(P(-1.0f), P(0.0f))[last], std::atan2(-1.0f, 0.0f));
  EXPECT_EQ(floor(P(-2.0f))[last], -2.0f);
  EXPECT_EQ(floor(P(-0.5f))[last], -1.0f);
}

TYPED_TEST(PacketTest, ComparisonsChooseLaneByLane) {
  constexpr int n = TypeParam::value;
  randomly<n>(-1.0f, 1.0f, [](const auto& x, const auto& y) {
    const auto lower = select(x < y, x, y), higher = max(x, y), least = min(x, y);
    for (int i = 0; i < n; ++i) {
      EXPECT_EQ(lower[i], std::min(x[i], y[i]));
      EXPECT_EQ(least[i], std::min(x[i], y[i]));
      EXPECT_EQ(higher[i], std::max(x[i], y[i]));
    }
  });
}

TYPED_TEST(PacketTest, NumbersAreReadAndWrittenInOrder) {
  constexpr int n = TypeParam::value;
  randomly<n>(-1.0f, 1.0f, [](const auto& x, const auto&) {
    std::array<float, static_cast<std::size_t>(n)> numbers{};
    x.store(numbers.data());
    auto same = Packet<n>(0.0f);
    for (int i = 0; i < n; ++i) {
      EXPECT_EQ(numbers[static_cast<std::size_t>(i)], x[i]);
      same.set(i, x[i]);
    }
    for (int i = 0; i < n; ++i) EXPECT_EQ(same[i], x[i]);
  });
}

}  // namespace
}  // namespace renderer
