#include "station/cloth/render/build_scene.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "renderer/trace/ray_scene.h"
#include "renderer/weave/initial_patch.h"
#include "renderer/weave/woven_patch.h"
#include "station/documents/draft_file.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/documents/refusal.h"

namespace station {
namespace {

using nlohmann::json;
using station_test::refusal;
namespace fs = std::filesystem;

const fs::path kScenes = fs::path(DATA_DIR) / "scenes";

ProgressDisplay& quiet() {
  static ProgressDisplay display("test", ProgressStyle::quiet);
  return display;
}

SceneFile plain_scene(const json& cloth = json::object()) {
  json document = read_json_file(kScenes / "plain_swatch.json");
  document["cloths"][0].update(cloth);
  return parse_scene(document, "scene.json", kScenes);
}

TEST(BuildScene, ReadyScenesAreBuilt) {
  int read = 0;
  for (const auto& entry : fs::directory_iterator(kScenes)) {
    if (entry.path().extension() != ".json") continue;
    const SceneFile file = read_scene(entry.path());
    ++read;
    EXPECT_FALSE(file.cloths.empty()) << entry.path();
    const renderer::Scene scene = build_scene(file, build_cloths(file, quiet()));
    EXPECT_EQ(scene.cloths.size(), file.cloths.size()) << "ready scenes are in two scales";
    EXPECT_EQ(scene.meshes.size(), file.objects.size());
  }
  EXPECT_EQ(read, 13);
}

TEST(BuildScene, BruteForceTurnsClothIntoCurvesOfItsThreads) {
  const SceneFile file = plain_scene({{"method", "brute_force"}});
  const renderer::Scene scene = build_scene(file, build_cloths(file, quiet()));
  EXPECT_TRUE(scene.cloths.empty());
  EXPECT_EQ(scene.curves.size(), 2u);
}

TEST(BuildScene, ADraftIsWovenToTheClothOfTheWeaveCommand) {
  const renderer::Draft draft = read_draft(fs::path(DATA_DIR) / "drafts" / "plain.json");
  const renderer::YarnPatch woven = renderer::woven_patch(draft).patch, drawn = renderer::initial_patch(draft),
                            patch = woven_cloth(plain_scene(), 0, quiet());
  ASSERT_EQ(patch.yarns.size(), woven.yarns.size());
  for (std::size_t i = 0; i < patch.yarns.size(); ++i) {
    EXPECT_EQ(patch.yarns[i].control_points, woven.yarns[i].control_points);
    EXPECT_NE(patch.yarns[i].control_points, drawn.yarns[i].control_points);
  }
}

TEST(BuildScene, AShadeOfAThreadThatTheSceneDoesNotListIsRefused) {
  SceneFile file = plain_scene();
  renderer::Draft& draft = std::get<renderer::Draft>(file.cloths[0].weave);
  draft.warp.threads = {0}, draft.weft.threads = {1};
  EXPECT_NO_THROW(build_cloths(file, quiet()));
  draft.unevenness.shades = 2;
  const std::string line = refusal([&] { build_cloths(file, quiet()); });
  EXPECT_TRUE(line.starts_with("scene.json: key \"cloths[0].draft\": \"plain") &&
              line.find("but the scene lists 2 threads") != std::string::npos)
      << line;
}

TEST(BuildScene, APatchThatReachesFarBeyondItsCellIsRefused) {
  const SceneFile file = plain_scene();
  const std::vector<BuiltCloth> good = build_cloths(file, quiet());
  std::vector<BuiltCloth> far = good;
  far[0].patch.yarns[0].control_points[1].z() = 1e5;
  EXPECT_NE(refusal([&] { renderer::RayScene(build_scene(file, far)); }).find("periods beyond"), std::string::npos);
  far = good;
  far[0].patch.period_x_mm = 1e-6;
  EXPECT_NE(refusal([&] { renderer::RayScene(build_scene(file, far)); }).find("periods beyond"), std::string::npos);
}

}  // namespace
}  // namespace station
