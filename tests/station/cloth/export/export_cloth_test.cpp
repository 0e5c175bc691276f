// `threadstation export cloth` as a person types it; its files are judged by Khronos' validator and U3M's schema, which
// tests/run installs from npm.
#include "station/cloth/export/export_cloth.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "renderer/picture/image_file.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"
#include "tests/station/documents/refusal.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kData = DATA_DIR, kNpm = std::string(SOURCE_DIR) + "/tests/npm/";
const std::string kSwatch = kData + "/scenes/plain_swatch.json";

ProgramResult export_cloth(const std::vector<std::string>& arguments) {
  std::vector<std::string> all{"export", "cloth"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return run_threadstation(all);
}

ProgramResult run_node(const std::string& arguments) {
  if (!fs::exists(kNpm + "node_modules")) ADD_FAILURE() << "run tests/run, or npm ci in tests/npm";
  return run_shell("node " + kNpm + arguments);
}

// One small export for all tests that look at its files.
class ExportedCloth : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    result_ =
        new ProgramResult(export_cloth({kSwatch, "--out", *folder_ / "cloth", "--size", "48", "--spp", "8", "--json"}));
  }
  static void TearDownTestSuite() {
    delete result_;
    delete folder_;
  }
  void SetUp() override { ASSERT_EQ(result_->status, 0) << result_->error; }
  static std::string path(const std::string& name) { return *folder_ / ("cloth/" + name); }

  static TemporaryFolder* folder_;
  static ProgramResult* result_;
};
TemporaryFolder* ExportedCloth::folder_ = nullptr;
ProgramResult* ExportedCloth::result_ = nullptr;

TEST_F(ExportedCloth, HasNoErrorAndNoWarningForTheGltfValidator) {
  const ProgramResult found = run_node("validate_gltf.mjs " + path("gltf/cloth.gltf"));
  ASSERT_EQ(found.status, 0) << found.error;
  const json report = json::parse(found.out);
  EXPECT_EQ(report.at("issues").at("numErrors"), 0) << report.at("issues").dump(1);
  EXPECT_EQ(report.at("issues").at("numWarnings"), 0) << report.at("issues").dump(1);
  EXPECT_EQ(report.at("info").at("resources").size(), 6u) << "a buffer and five pictures";
  EXPECT_EQ(report.at("info").at("extensionsUsed").size(), 3u);
}

// The validator does not know the extension: its keys and ranges are looked at here.
TEST_F(ExportedCloth, LetsLightThroughByTheExtensionsKeys) {
  const json material = json(station::read_json_file(path("gltf/cloth.gltf"))).at("materials").at(0);
  const json& through = material.at("extensions").at("KHR_materials_diffuse_transmission");
  EXPECT_GT(through.at("diffuseTransmissionFactor"), 0);
  EXPECT_LE(through.at("diffuseTransmissionFactor"), 1);
  EXPECT_EQ(through.at("diffuseTransmissionTexture").at("index"), 2);
  EXPECT_EQ(through.at("diffuseTransmissionColorTexture").at("index"), 2);
  EXPECT_EQ(through.size(), 3u);
  EXPECT_EQ(material.at("alphaMode"), "BLEND") << "plain cloth has holes";
}

TEST_F(ExportedCloth, IsU3mByItsSchema) {
  const ProgramResult found = run_node("validate_json.mjs " + kNpm + "u3m_1_1_schema.json " + path("u3m/cloth.u3m"));
  EXPECT_EQ(found.status, 0) << found.out << found.error;
}

TEST_F(ExportedCloth, HasThePicturesThatItsDocumentsNameInTheSizeThatTheySay) {
  const json u3m = station::read_json_file(path("u3m/cloth.u3m"));
  for (const char* side : {"front", "back"})
    for (const char* key : {"basecolor", "normal", "alpha", "transmission"}) {
      const json& image = u3m.at("material").at(side).at(key).at("texture").at("image");
      const cv::Mat1b picture = renderer::read_png_grey(path("u3m/" + image.at("path").get<std::string>()));
      EXPECT_NEAR(picture.cols / image.at("dpi").at("x").get<double>() * 25.4, image.at("width"), 1e-9);
      EXPECT_NEAR(picture.rows / image.at("dpi").at("y").get<double>() * 25.4, image.at("height"), 1e-9);
      EXPECT_DOUBLE_EQ(image.at("width"), 1.8) << "two ends, 0.9 mm apart";
    }
  for (const char* name : {"base_color", "normal", "opacity", "transmission", "transmission_color", "roughness",
                           "specular", "specular_color", "sheen_color", "sheen_roughness"})
    EXPECT_EQ(renderer::read_png_grey(path(std::string("textures/") + name + ".png")).size(), cv::Size(48, 48));
}

TEST_F(ExportedCloth, RepeatsOnTheSwatchAtItsPhysicalSize) {
  const json gltf = station::read_json_file(path("gltf/cloth.gltf"));
  std::ifstream in(path("gltf/cloth.bin"), std::ios::binary);
  const json& attributes = gltf.at("meshes").at(0).at("primitives").at(0).at("attributes");
  const auto first_of = [&](const char* name, std::size_t count) {
    const json& accessor = gltf.at("accessors").at(attributes.at(name).get<std::size_t>());
    in.seekg(gltf.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>()).at("byteOffset").get<int>());
    std::vector<float> values(count);
    in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(float)));
    return values;
  };
  const std::vector<float> position = first_of("POSITION", 6), texture = first_of("TEXCOORD_0", 4);
  const double side_mm = 1000 * static_cast<double>(position[3] - position[0]),
               repeats = static_cast<double>(texture[2] - texture[0]);
  EXPECT_NEAR(side_mm / repeats, 1.8, 1e-5);
}

TEST_F(ExportedCloth, StatesHowFarItIsOff) {
  const json report = json::parse(result_->out);
  EXPECT_EQ(report, station::read_json_file(path("export.json")));
  const json& front = report.at("far_field").at("light_from_the_front");
  EXPECT_EQ(front.at("pairs"), 325);
  EXPECT_GT(front.at("relative_rms"), 0.02) << "no glTF material is this cloth";
  EXPECT_LT(front.at("relative_rms"), 0.7);
  EXPECT_EQ(report.at("views").size(), 5u);
  EXPECT_LT(report.at("views").at(0).at("mean_delta_e_2000"), 6) << "even light, 8 samples";
  const json& even = report.at("even_light");
  for (int c = 0; c < 3; ++c) {
    const double cloth = even.at("reflectance_cloth").at(c), through = even.at("transmittance_cloth").at(c);
    EXPECT_NEAR(even.at("reflectance_export").at(c), cloth, 0.03 * cloth) << "8 bits, 8 samples";
    EXPECT_NEAR(even.at("transmittance_export").at(c), through, 0.05 * through) << "8 bits, 8 samples";
  }
  EXPECT_GT(renderer::read_png_grey(path("comparison.png")).rows, 1000);
}

class ExportCloth : public ::testing::Test {
 protected:
  void expect_refused(const std::vector<std::string>& arguments, int status, const std::string& must_name) {
    const ProgramResult found = export_cloth(arguments);
    EXPECT_EQ(found.status, status) << found.error;
    EXPECT_EQ(found.error_lines(), 1) << found.error;
    EXPECT_NE(found.error.find(must_name), std::string::npos) << found.error;
  }
  bool nothing_left() const {
    return std::none_of(fs::directory_iterator(folder_.path()), fs::directory_iterator(),
                        [](const fs::directory_entry& entry) { return entry.is_directory(); });
  }
  TemporaryFolder folder_;
};

TEST_F(ExportCloth, RefusesInOneLineWhatItCannotDo) {
  const std::string out = folder_ / "out", thread = kData + "/threads/silk_red.json";
  expect_refused({kData + "/scenes/none.json", "--out", out}, 1, "none.json");
  expect_refused({kData + "/scenes/satin_drape.json", "--out", out}, 1, "mesh or garment");
  expect_refused({kData + "/scenes/satin_cylinder.json", "--out", out}, 1, "cylinder");
  expect_refused({kData + "/scenes/skirts_four_colours.json", "--out", out}, 1, "cloths");
  expect_refused({"--out", out}, 2, "--draft");
  expect_refused({kSwatch, "--out", ""}, 1, "--out");
  expect_refused({kSwatch, "--out", out, "--size", "8"}, 2, "--size");
  expect_refused({kSwatch, "--out", out, "--spp", "0"}, 2, "--spp");
  expect_refused({kSwatch, "--out", out, "--only", "obj"}, 2, "obj");
  station::write_text_file(folder_ / "file", "not a folder");
  expect_refused({kSwatch, "--out", folder_ / "file/out"}, 1, "file/out");
  expect_refused({kSwatch, "--out", folder_.path()}, 1, "is there already");
  expect_refused({"--draft", kData + "/drafts/plain.json", "--warp", thread, "--out", out}, 2, "--weft");
  EXPECT_TRUE(nothing_left());
}

TEST_F(ExportCloth, RefusesWhatTakesMoreMemoryThanThereIs) {
  station::ExportClothRequest request{.scene = kSwatch, .out = folder_ / "out", .size_px = 4096, .most_bytes = 1e9};
  EXPECT_NE(refusal([&] { station::export_cloth(request); }).find("--size"), std::string::npos);
  EXPECT_TRUE(nothing_left());
}

TEST_F(ExportCloth, WritesOnlyWhatIsAskedForOfADraftAndTwoThreads) {
  const std::string thread = kData + "/threads/silk_";
  const ProgramResult found = export_cloth({"--draft", kData + "/drafts/twill_2_2.json", "--warp", thread + "blue.json",
                                            "--weft", thread + "gold.json", "--out", folder_ / "twill", "--size", "24",
                                            "--spp", "1", "--only", "textures,u3m", "--quiet"});
  ASSERT_EQ(found.status, 0) << found.error;
  EXPECT_EQ(found.error, "");
  EXPECT_NE(found.out.find("CIEDE2000"), std::string::npos) << found.out;
  EXPECT_TRUE(fs::exists(folder_ / "twill/textures/base_color.png"));
  EXPECT_TRUE(fs::exists(folder_ / "twill/u3m/cloth.u3m"));
  EXPECT_FALSE(fs::exists(folder_ / "twill/gltf"));
}

TEST_F(ExportCloth, InterruptedItLeavesNothing) {
  const std::string pipe = folder_ / "pipe";
  const ProgramResult found =
      run_shell("mkfifo " + pipe + "; " + std::string(THREADSTATION_PROGRAM) + " export cloth " + kSwatch + " --out " +
                (folder_ / "out").string() + " 2> " + pipe +
                " & program=$!; { read first; kill -INT $program; cat; } < " + pipe + "; wait $program");
  EXPECT_EQ(found.status, 1);
  EXPECT_NE(found.out.find("stopped on request"), std::string::npos) << found.out;
  EXPECT_TRUE(nothing_left());
}

}  // namespace
}  // namespace station_test
