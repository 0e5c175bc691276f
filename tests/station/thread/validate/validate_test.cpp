// The commands that judge the fits themselves, as a person types them, in few paths and samples.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "renderer/picture/image_file.h"
#include "renderer/weave/initial_patch.h"
#include "renderer/weave/woven_patch.h"
#include "station/documents/reader.h"
#include "station/documents/spool.h"
#include "station/thread/validate/validate_cloth.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kData = DATA_DIR;
const std::string kRig = kData + "/rigs/simulated.json", kThread = kData + "/threads/silk_blue.json";

void expect_one_line(const ProgramResult& result, const std::string& must_name) {
  EXPECT_EQ(result.status, 1) << result.error;
  EXPECT_EQ(result.error_lines(), 1) << result.error;
  EXPECT_NE(result.error.find(must_name), std::string::npos) << result.error;
}

ProgramResult recover(const std::string& rig, const std::string& thread) {
  return run_threadstation({"recover", "--rig", rig, "--spool", kData + "/spools/silk_blue.json", "--thread", thread,
                            "--draws", "2", "--paths", "32", "64", "--spp", "64", "--json"});
}

TEST(Recover, TheTruthIsTheThreadsAndExplainsItsOwnPictures) {
  const ProgramResult result = recover(kRig, kThread);
  ASSERT_EQ(result.status, 0) << result.error;
  const json recovered = json::parse(result.out);
  std::map<std::string, json> by_name;
  for (const json& quantity : recovered.at("quantities")) by_name[quantity.at("name")] = quantity;
  EXPECT_EQ(by_name.size(), 21U);  // absorption, two roughnesses, three strengths at four inclinations
  const json parameters = station::read_json_file(kThread).at("parameters");
  for (const char* group : {"sigma_a", "alpha", "beta"})
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(by_name.at(group + ("[" + std::to_string(i) + "]")).at("truth").get<double>(),
                  parameters.at(group)[i].get<double>(), 1e-9);
  // Nothing varies where absorption is at its bound, which is 0.
  const auto expect_deviation = [&](const std::string& name, const char* deviation, const char* of) {
    if (by_name.at(name).at(of).get<double>() <= 1e-6) return;
    EXPECT_GT(by_name.at(name).at(deviation).get<double>(), 0) << name << ", " << deviation;
  };
  for (const auto& [name, quantity] : by_name) {
    expect_deviation(name, "sigma", "fitted");
    expect_deviation(name, "spread", "mean");
    expect_deviation(name, "predicted", "mean");
  }
  const json& truth = recovered.at("loss_of_truth");
  EXPECT_GT(truth.at("mean").get<double>(), 0);
  EXPECT_LT(std::abs(truth.at("without_noise").get<double>()), 0.5 * truth.at("mean").get<double>());
  EXPECT_LT(recovered.at("loss_of_fit").at("mean").get<double>(), 10 * truth.at("mean").get<double>());
}

TEST(Recover, OfSeveralThreadsEachIsPrintedAndATableOfAll) {
  const ProgramResult result = run_threadstation({"recover", "--rig", kRig, "--spool", kData + "/spools/silk_blue.json",
                                                  "--thread", kThread, kData + "/threads/silk_red.json", "--draws", "2",
                                                  "--paths", "32", "64", "--spp", "8", "--quiet"});
  ASSERT_EQ(result.status, 0) << result.error;
  EXPECT_THAT(result.out, testing::HasSubstr("silk-like, red, 17 views"));
  const std::string table = result.out.substr(result.out.find("thread   "));
  EXPECT_EQ(std::ranges::count(table, '\n'), 3) << table;
}

TEST(Recover, BadInputGetsOneLine) {
  expect_one_line(recover(kData + "/rigs/grbl_sony_usb.json", kThread), "simulation");
  expect_one_line(recover(kRig, kData + "/threads/none.json"), "no such file");
}

class Validate : public ::testing::Test {
 protected:
  ProgramResult validate(const std::string& spool) {
    return run_threadstation({"validate", "--rig", kRig, "--spool", spool, "--out", folder_ / "out", "--folds", "0",
                              "--spp", "32", "--model", "thread", "--json"});
  }
  TemporaryFolder folder_;
};

TEST_F(Validate, PhotographsAreTakenOnceAndTwoDrawsOfTheFibersDiffer) {
  const std::string spool = kData + "/spools/packed_silk_red_20.json";
  const ProgramResult first = validate(spool);
  ASSERT_EQ(first.status, 0) << first.error;
  const json found = json::parse(first.out);
  ASSERT_EQ(found.at("spools").size(), 1U);
  const json& of_spool = found.at("spools")[0];
  EXPECT_EQ(of_spool.at("fibers_per_thread"), 20);
  EXPECT_GT(of_spool.at("draw").get<double>(), 0);  // 0.07; without the noise, so that few samples may say less than 0
  EXPECT_LT(of_spool.at("draw").get<double>(), 0.2);
  EXPECT_EQ(station::read_json_file(folder_ / "out/validation.json"), found);
  std::map<fs::path, fs::file_time_type> written;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "out"))
    if (entry.path().extension() == ".exr") written[entry.path()] = entry.last_write_time();
  EXPECT_GE(written.size(), 34U);  // 17 views, twice
  const ProgramResult second = validate(spool);
  ASSERT_EQ(second.status, 0) << second.error;
  EXPECT_EQ(json::parse(second.out), found);
  for (const auto& [path, time] : written) EXPECT_EQ(fs::last_write_time(path), time) << path;
}

TEST_F(Validate, ASpoolWithoutFibersIsRefusedInOneLine) {
  json spool = station::read_json_file(kData + "/spools/packed_silk_red_20.json");
  spool.erase("simulation");
  station::write_json_file(folder_ / "real.json", spool);
  expect_one_line(validate(folder_ / "real.json"), "simulat");
  expect_one_line(validate(folder_ / "none.json"), "no such file");
}

class ValidateCloth : public ::testing::Test {
 protected:
  ProgramResult validate_cloth(const std::string& warp, const std::string& draft) {
    return run_threadstation({"validate-cloth",
                              "--rig",
                              kRig,
                              "--warp",
                              warp,
                              "--weft",
                              kData + "/spools/packed_silk_gold_40.json",
                              "--draft",
                              draft,
                              "--out",
                              folder_ / "out",
                              "--model",
                              "fiber",
                              "--paths",
                              "128",
                              "256",
                              "--spp",
                              "4",
                              "--photograph-spp",
                              "4",
                              "--width",
                              "96",
                              "--json"});
  }
  TemporaryFolder folder_;
};

TEST_F(ValidateCloth, SamplesAreLitFromBothSidesAndFromBehindAndPicturesAreMadeOnce) {
  const std::string warp = kData + "/spools/packed_silk_red_20.json", draft = kData + "/drafts/plain.json";
  const ProgramResult first = validate_cloth(warp, draft);
  ASSERT_EQ(first.status, 0) << first.error;
  const json found = json::parse(first.out);
  ASSERT_EQ(found.at("samples").size(), 3U);
  const auto peak_px = [&](std::size_t i, const char* of) {
    return found["samples"][i]["models"]["fiber"][of]["peak_px"].get<double>();
  };
  for (const char* of : {"photograph", "rendering"}) EXPECT_GT(peak_px(0, of), peak_px(1, of) + 5) << of;
  for (const json& sample : found.at("samples")) {
    const double difference = sample.at("models").at("fiber").at("mean_delta_e_2000").get<double>();
    EXPECT_GT(difference, 0);
    EXPECT_LT(difference, 40);
    EXPECT_EQ(sample.at("models").at("fiber").at("scale"), 1.0) << "nothing is scaled to fit";
    // The means say how bright the picture is against the reference, written as both are.
    const auto mean = [&](const char* what) {
      const std::string name = "plain-packed_silk_red_20-" + sample.at("lamp").get<std::string>() + "-" + what;
      const cv::Mat3f a = renderer::read_exr(folder_ / "out/samples" / (name + "-a.exr")),
                      b = renderer::read_exr(folder_ / "out/samples" / (name + "-b.exr"));
      return cv::Scalar(cv::mean(a) + cv::mean(b));  // black outside of the mask
    };
    const cv::Scalar rendered = mean("fiber"), reference = mean("reference");
    const auto brightness = sample.at("models").at("fiber").at("brightness").get<std::vector<double>>();
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(brightness[static_cast<std::size_t>(c)], rendered[c] / reference[c], 1e-4) << sample.at("lamp");
  }
  EXPECT_EQ(station::read_json_file(folder_ / "out/validation.json"), found);
  EXPECT_TRUE(fs::exists(folder_ / "out/samples.png"));
  std::map<fs::path, fs::file_time_type> written;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "out"))
    if (entry.path().extension() == ".exr") written[entry.path()] = entry.last_write_time();
  EXPECT_EQ(written.size(),
            2U * 34U + 3U * 2U * 2U);  // two spools' views; three lamps, reference and model, two halves
  const ProgramResult second = validate_cloth(warp, draft);
  ASSERT_EQ(second.status, 0) << second.error;
  EXPECT_EQ(json::parse(second.out), found);
  for (const auto& [path, time] : written) EXPECT_EQ(fs::last_write_time(path), time) << path;
}

TEST(WithFibersOf, FlatYarnsHaveRoundFibersAndPliesThinnerOnes) {
  const station::Spool spool = station::read_spool(kData + "/spools/packed_silk_red_20.json");
  renderer::YarnPatch patch = renderer::initial_patch(renderer::plain_draft());  // 0.5 mm, as the spool's thread
  patch.yarns[0].flatness = 2.5;
  const renderer::YarnPatch fibers = station::with_fibers_of(patch, {spool});
  ASSERT_EQ(fibers.yarns.size(), 20 * patch.yarns.size());
  double widest = 0, highest = 0;  // of the flat yarn, a warp end
  for (int i = 0; i < 20; ++i) {
    const renderer::Yarn& fiber = fibers.yarns[static_cast<std::size_t>(i)];
    EXPECT_EQ(fiber.flatness, 1);
    EXPECT_EQ(fiber.radius_mm, 0.0375);
    const Eigen::Vector3d offset = renderer::spline_value(renderer::center_line(fibers, fiber), 0) -
                                   renderer::spline_value(renderer::center_line(patch, patch.yarns[0]), 0);
    widest = std::max(widest, std::abs(offset.x()) + fiber.radius_mm);
    highest = std::max(highest, offset.tail<2>().norm() + fiber.radius_mm);
  }
  EXPECT_GT(widest, 0.27) << "wider than the round yarn";
  EXPECT_LT(widest, 0.25 * std::sqrt(2.5) + 1e-3);
  EXPECT_LT(highest, 0.25 / std::sqrt(2.5) + 1e-3);
  const renderer::YarnPatch plied = renderer::with_plies(patch, {.count = 2});
  const renderer::YarnPatch of_plies = station::with_fibers_of(plied, {spool});
  EXPECT_EQ(of_plies.yarns.size(), 20 * plied.yarns.size());
  for (const renderer::Yarn& fiber : of_plies.yarns) EXPECT_NEAR(fiber.radius_mm, 0.0375 / 2, 1e-12);
}

TEST_F(ValidateCloth, AThreadThatIsNotTheDraftsIsRefusedInOneLine) {
  const std::string draft = kData + "/drafts/plain.json";
  json spool = station::read_json_file(kData + "/spools/packed_silk_red_20.json");
  spool["thread_diameter_mm"] = 0.6;
  station::write_json_file(folder_ / "thick.json", spool);
  expect_one_line(validate_cloth(folder_ / "thick.json", draft), "0.6");
  spool["thread_diameter_mm"] = 0.5;
  spool.erase("simulation");
  station::write_json_file(folder_ / "real.json", spool);
  expect_one_line(validate_cloth(folder_ / "real.json", draft), "simulat");
  expect_one_line(validate_cloth(folder_ / "none.json", draft), "no such file");
}

}  // namespace
}  // namespace station_test
