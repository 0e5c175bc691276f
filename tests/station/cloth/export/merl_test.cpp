// The table of a cloth's BRDF as readers of the MERL database look it up.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "renderer/trace/cloth_reflectance.h"
#include "renderer/weave/woven_patch.h"
#include "station/cloth/draft_of_one_thread.h"
#include "station/documents/degree.h"
#include "station/documents/draft_file.h"
#include "station/documents/reader.h"
#include "station/documents/thread_file.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

using station::kDegree;

namespace fs = std::filesystem;
using Eigen::Array3d;
using Eigen::Vector3d;

// By the rules of the database's own reader: halfway vector, difference vector, whole numbers by truncation.
struct MerlTable {
  std::vector<std::int32_t> sizes = std::vector<std::int32_t>(3);
  std::vector<double> values;

  explicit MerlTable(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    in.read(reinterpret_cast<char*>(sizes.data()), 12);
    values.resize(3UL * 90 * 90 * 180);
    in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(double)));
    EXPECT_TRUE(in.good());
    EXPECT_EQ(in.peek(), EOF);
  }
  Array3d look_up(const Vector3d& in, const Vector3d& out) const {
    const Vector3d half = (in + out).normalized();
    const double theta_half = std::acos(half.z()), fi_half = std::atan2(half.y(), half.x());
    const Vector3d difference =
        Eigen::AngleAxisd(-theta_half, Vector3d::UnitY()) * (Eigen::AngleAxisd(-fi_half, Vector3d::UnitZ()) * in);
    double fi_difference = std::atan2(difference.y(), difference.x());
    if (fi_difference < 0) fi_difference += std::numbers::pi;
    const auto index = [](double share, int count) { return std::clamp(static_cast<int>(share), 0, count - 1); };
    const int h = index(std::sqrt(theta_half / (std::numbers::pi / 2) * 90 * 90), 90),
              d = index(std::acos(std::min(1.0, difference.z())) / (std::numbers::pi / 2) * 90, 90),
              phi = index(fi_difference / std::numbers::pi * 180, 180);
    const auto at = static_cast<std::size_t>(phi + d * 180 + h * 180 * 90);
    constexpr std::size_t kPlane = 90 * 90 * 180;
    return {values[at] / 1500, values[at + kPlane] * 1.15 / 1500, values[at + 2 * kPlane] * 1.66 / 1500};
  }
};

Vector3d direction(double theta_deg, double phi_deg) {
  const double t = theta_deg * kDegree, p = phi_deg * kDegree;
  return {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
}

Array3d mean_over_turns(const renderer::ClothReflectance& cloth, const Vector3d& a, const Vector3d& b) {
  constexpr int kPlaces = 1 << 15;
  renderer::Sampler sampler(9, 9);
  Array3d sum = Array3d::Zero();
  for (int s = 0; s < kPlaces; ++s) {
    sampler.start_sample(static_cast<std::uint32_t>(s));
    const Eigen::AngleAxisd turn(2 * std::numbers::pi * static_cast<double>(sampler.next_1d()), Vector3d::UnitZ());
    sum += s % 2 == 0 ? cloth.sample(turn * a, turn * b, sampler) : cloth.sample(turn * b, turn * a, sampler);
  }
  return sum / kPlaces;
}

TEST(MerlExport, ReadersFindTheClothsReflectance) {
  const fs::path thread_file = fs::path(DATA_DIR) / "threads" / "silk_gold.json",
                 draft = fs::path(DATA_DIR) / "drafts" / "plain.json";
  TemporaryFolder folder;
  const fs::path out = folder / "exported";
  const ProgramResult result = run_threadstation({"export", "thread", thread_file.string(), "--out", out.string(),
                                                  "--only", "merl", "--draft", draft.string(), "--json"});
  ASSERT_EQ(result.status, 0) << result.error;
  const nlohmann::json stated = nlohmann::json::parse(result.out).at("cloth");
  std::printf("stated: %s\n", stated.dump().c_str());
  EXPECT_LT(stated.at("noise").get<double>(), 0.05);
  const MerlTable table(out / "cloth.binary");
  EXPECT_EQ(table.sizes, (std::vector<std::int32_t>{90, 90, 180}));
  const station::ThreadFile thread = station::read_thread(thread_file);
  const renderer::YarnPatch patch =
      renderer::woven_patch(station::draft_of_one_thread(station::read_draft(draft), thread.diameter_mm)).patch;
  const renderer::ClothReflectance cloth(patch, {thread.parameters});
  double error = 0, whole = 0;
  for (const double theta_i : {5.0, 25.0, 45.0, 65.0})
    for (const double theta_o : {10.0, 35.0, 60.0})
      for (const double phi : {0.0, 60.0, 130.0, 180.0}) {
        const Vector3d wi = direction(theta_i, 20), wo = direction(theta_o, 20 + phi);
        const Array3d expected = mean_over_turns(cloth, wi, wo), found = table.look_up(wi, wo);
        error += (found - expected).square().sum(), whole += expected.square().sum();
        EXPECT_LT((found - expected).abs().maxCoeff(), 0.2 * expected.maxCoeff())
            << theta_i << " " << theta_o << " " << phi << ": " << found.transpose() << ", " << expected.transpose();
      }
  std::printf("48 pairs of directions: %.2f %% from direct measurements\n", 100 * std::sqrt(error / whole));
  EXPECT_LT(std::sqrt(error / whole), 0.05);  // noise of both, cells, and the mean over neighbours
  EXPECT_LT(table.look_up(direction(89.9, 0), direction(89.9, 180)).maxCoeff(), 0);  // below the horizon
}

}  // namespace
}  // namespace station_test
