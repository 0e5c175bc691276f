#include "renderer/scattering/thread_batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/renderer/scattering/scattering_statistics.h"

namespace renderer {
namespace {

struct Place {
  double theta_o, h, theta_i, phi_i;
};

struct Batch {
  std::vector<float> h;
  std::array<std::vector<float>, 3> wo, wi, f_cos;
  std::vector<float> pdf;

  explicit Batch(const std::vector<Place>& places) {
    for (const Place& at : places) {
      const Vec3<double> o = viewing_direction(at.theta_o, at.h), i = direction(at.theta_i, at.phi_i);
      h.push_back(static_cast<float>(at.h));
      for (std::size_t c = 0; c < 3; ++c) {
        wo[c].push_back(static_cast<float>(o[static_cast<int>(c)]));
        wi[c].push_back(static_cast<float>(i[static_cast<int>(c)]));
      }
    }
    for (auto& channel : f_cos) channel.resize(places.size());
    pdf.resize(places.size());
  }

  void evaluate(const ThreadParameters& parameters) {
    evaluate_batch(ThreadModel<float>(in_scalar<float>(parameters)),
                   {.h = h, .wo = {wo[0], wo[1], wo[2]}, .wi = {wi[0], wi[1], wi[2]}},
                   {.f_cos = {f_cos[0], f_cos[1], f_cos[2]}, .pdf = pdf});
  }
};

std::vector<Place> grid() {
  std::vector<Place> places;
  for (double theta_o : {-1.484, -0.6, 0.0, 0.5, 1.484})  // 85 degrees
    for (double h : {-1.0, -0.7, 0.05, 0.8, 1.0})
      for (double off_cone : {-0.6, 0.0, 0.02, 0.3})
        for (double phi : {-3.0, -1.6, 0.3, 1.5, 2.0})
          places.push_back({theta_o, h, std::clamp(off_cone - theta_o, -1.55, 1.55), phi});
  return places;
}

ThreadParameters thread(double alpha, double beta) {
  return {.sigma_a = {0, 0.4, 3}, .alpha = {alpha, alpha, alpha}, .beta = {beta, beta, beta}, .r2b = 0.5};
}

Eigen::Array4d exact(const ThreadModel<double>& model, const Place& at, double turn = 0, double lift = 0) {
  const auto value =
      model.lobes_at(at.h, viewing_direction(at.theta_o, at.h)).evaluate(direction(at.theta_i + lift, at.phi_i + turn));
  return {value.f_cos[0], value.f_cos[1], value.f_cos[2], value.pdf};
}

TEST(ThreadBatchTest, AgreesWithDoublePrecisionAsFarAsFloatsKnowDirections) {
  for (double alpha : {0.02, 0.1, 0.4, 1.0}) {
    for (double beta : {0.02, 0.1, 0.4, 1.0}) {
      const ThreadParameters parameters = thread(alpha, beta);
      const ThreadModel<double> model(parameters);
      const std::vector<Place> places = grid();
      Batch batch(places);
      batch.evaluate(parameters);
      for (std::size_t k = 0; k < places.size(); ++k) {
        const Eigen::Array4d expected = exact(model, places[k]);
        // What a millionth of a radian changes, and a few roundings of each factor.
        constexpr double kAngle = 1e-6;
        const Eigen::Array4d turned = exact(model, places[k], kAngle).max(exact(model, places[k], -kAngle)),
                             lifted = exact(model, places[k], 0, kAngle).max(exact(model, places[k], 0, -kAngle));
        const Eigen::Array4d tolerance = (turned - expected) + (lifted - expected) + 2e-5 * expected + 1e-30;
        const Eigen::Array4d found =
            Eigen::Array4f(batch.f_cos[0][k], batch.f_cos[1][k], batch.f_cos[2][k], batch.pdf[k]).cast<double>();
        EXPECT_TRUE(((found - expected).abs() <= tolerance).all())
            << alpha << ' ' << beta << ' ' << k << ": " << found.transpose() << " and " << expected.transpose();
      }
    }
  }
}

TEST(ThreadBatchTest, AnyNumberOfPlacesIsEvaluatedEachAsOnItsOwn) {
  std::vector<Place> places = grid();
  Batch all(places);
  all.evaluate(thread(0.2, 0.3));
  for (std::size_t count = 0; count <= 2 * kPacketWidth + 1; ++count) {
    Batch some(std::vector<Place>(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(count)));
    some.evaluate(thread(0.2, 0.3));
    for (std::size_t k = 0; k < count; ++k) {
      EXPECT_EQ(some.pdf[k], all.pdf[k]) << k << " of " << count;
      for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(some.f_cos[c][k], all.f_cos[c][k]) << k << " of " << count;
    }
  }
}

TEST(ThreadBatchTest, IsFiniteAlongTheThreadAndWithoutLight) {
  Batch batch({{std::numbers::pi / 2, 1, -std::numbers::pi / 2, 0},
               {-std::numbers::pi / 2, -1, std::numbers::pi / 2, 0},
               {0, 1, 0, -std::numbers::pi},
               {1.5707, 0, -1.5707, 1}});
  batch.wo[0][0] = 1, batch.wo[1][0] = batch.wo[2][0] = 0;  // exactly along
  ThreadParameters black = thread(0.02, 0.02);
  black.sigma_a.setConstant(1000);
  black.r0a = black.r0b = black.r0c = 0;
  for (const ThreadParameters& parameters : {thread(0.02, 1), thread(1, 0.02), black}) {
    batch.evaluate(parameters);
    for (std::size_t k = 0; k < batch.h.size(); ++k) {
      EXPECT_TRUE(std::isfinite(batch.pdf[k]) && batch.pdf[k] >= 0) << k;
      for (std::size_t c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(batch.f_cos[c][k]) && batch.f_cos[c][k] >= 0) << k;
    }
  }
}

}  // namespace
}  // namespace renderer
