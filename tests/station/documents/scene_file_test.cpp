#include "station/documents/scene_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "renderer/weave/initial_patch.h"
#include "renderer/weave/woven_patch.h"
#include "station/documents/draft_file.h"
#include "station/documents/patch_file.h"
#include "station/documents/reader.h"
#include "station/documents/thread_file.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"
#include "tests/station/documents/refusal.h"

namespace station {
namespace {

using nlohmann::json;
using station_test::refusal;
namespace fs = std::filesystem;

const fs::path kScenes = fs::path(DATA_DIR) / "scenes";
const fs::path kThreads = fs::path(DATA_DIR) / "threads";

json plain_scene() {
  return read_json_file(kScenes / "plain_swatch.json");
}

TEST(SceneFile, ADraftIsReadAndNotWoven) {
  const station_test::TemporaryFolder folder;
  json draft = read_json_file(fs::path(DATA_DIR) / "drafts" / "plain.json");
  draft["plies"] = {{"count", 2}, {"radius_mm", 5}};
  write_json_file(folder / "draft.json", draft);
  json document = plain_scene();
  document["cloths"][0]["draft"] = (folder / "draft.json").string();
  const SceneFile scene = parse_scene(document, "scene", kScenes);
  const auto& read = std::get<renderer::Draft>(scene.cloths[0].weave);
  EXPECT_EQ(read.plies.radius_mm, 5);
  EXPECT_NE(refusal([&] { renderer::woven_patch(read); }).find("thicker than its yarn"), std::string::npos)
      << "this draft would have been refused, had it been woven";
}

TEST(SceneFile, FibersAreAKindOrNumbers) {
  json document = plain_scene();
  const auto fibers = [&] { return parse_scene(document, "scene", kScenes).cloths[0].fibers; };
  EXPECT_FALSE(fibers());
  document["cloths"][0]["fibers"] = "spun";
  ASSERT_TRUE(fibers());
  EXPECT_GT(fibers()->detail.spread_rad, 0);
  EXPECT_TRUE(fibers()->flyaways);
  document["cloths"][0]["fibers"] = {{"twist_deg", -20}, {"spread_deg", 5}, {"shade", 0.1}, {"width_mm", 0.02}};
  EXPECT_NEAR(fibers()->detail.twist_rad, -20 * std::numbers::pi / 180, 1e-12);
  EXPECT_FALSE(fibers()->flyaways);
  document["cloths"][0]["fibers"]["flyaways_per_mm"] = 2;
  EXPECT_NE(refusal(fibers).find("flyaway_length_mm"), std::string::npos);
  document["cloths"][0]["fibers"] = "felt";
  EXPECT_NE(refusal(fibers).find("filament"), std::string::npos);
  document["cloths"][0]["fibers"] = "spun";
  document["cloths"][0]["method"] = "brute_force";
  EXPECT_NE(refusal(fibers).find("two scales"), std::string::npos);
}

TEST(SceneFile, ReadyThreadsAreReadAndWrittenAgainAsTheyAre) {
  int read = 0;
  for (const auto& entry : fs::directory_iterator(kThreads)) {
    if (entry.path().extension() != ".json") continue;
    const ThreadFile thread = read_thread(entry.path());
    EXPECT_EQ(to_json(parse_thread(to_json(thread), "again")), to_json(thread));
    ++read;
  }
  EXPECT_EQ(read, 5);
}

TEST(SceneFile, OptionsOfAThreadAreReadAndWrittenOnlyWhereTheyDiffer) {
  const ThreadFile metal = read_thread(kThreads / "metal_gold.json");
  EXPECT_EQ(metal.parameters.lambda0_rgb, Eigen::Vector3d(1, 0.76, 0.34));
  EXPECT_EQ(metal.parameters.transmittance_powers, (std::array<double, 2>{1, 2}));
  EXPECT_EQ(parse_thread(to_json(metal), "again").parameters.lambda0_rgb, metal.parameters.lambda0_rgb);
  EXPECT_EQ(parse_thread(to_json(metal), "again").parameters.transmittance_powers,
            metal.parameters.transmittance_powers);
  EXPECT_EQ(metal.parameters.exit, renderer::ThreadExit::far_side);  // named by no file that is older than the others
  EXPECT_FALSE(to_json(metal).at("parameters").contains("exit"));
  ThreadFile other = metal;
  for (const auto& [name, exit] : thread_exits()) {
    other.parameters.exit = exit;
    EXPECT_EQ(parse_thread(to_json(other), "again").parameters.exit, exit) << name;
  }
  other.parameters.exit = renderer::ThreadExit::entry_point;
  json elsewhere = to_json(other);
  elsewhere["parameters"]["exit"] = "middle";
  EXPECT_NE(refusal([&] { parse_thread(elsewhere, "t"); }).find("by \"wandering\", at its \"far_side\""),
            std::string::npos);
  const json silk = to_json(read_thread(kThreads / "silk_gold.json")).at("parameters");
  EXPECT_FALSE(silk.contains("lambda0_rgb") || silk.contains("transmittance_powers") || silk.contains("exit"));

  json document = to_json(metal);
  document["parameters"]["lambda0_rgb"] = {1.2, 1, 1};
  EXPECT_NE(refusal([&] { parse_thread(document, "t"); }).find("parameters.lambda0_rgb"), std::string::npos);
  document = to_json(metal);
  document["parameters"]["transmittance_powers"] = {1, -1};
  EXPECT_NE(refusal([&] { parse_thread(document, "t"); }).find("parameters.transmittance_powers"), std::string::npos);
}

TEST(SceneFile, CanListABundleInPlaceOfAThread) {
  json document = read_json_file(kScenes / "satin_cylinder.json");
  document["threads"][1] = "../bundles/silk_red.json";
  const SceneFile scene = parse_scene(document, "scene", kScenes);
  EXPECT_EQ(std::get<renderer::BundleParameters>(scene.threads.at(1)).fiber_count, 20);
}

TEST(SceneFile, WhatItSaysIsWhereItBelongs) {
  json document = read_json_file(kScenes / "satin_cylinder.json");
  document["cloths"][0]["world_from_cloth"] = {{1, 0, 0, 5}, {0, 1, 0, 6}, {0, 0, 1, 7}, {0, 0, 0, 1}};
  document["exposure"] = 2.5;
  const SceneFile scene = parse_scene(document, "scene", kScenes);
  ASSERT_EQ(scene.threads.size(), 2u);
  EXPECT_EQ(std::get<renderer::ThreadParameters>(scene.threads[1]).sigma_a,
            read_thread(kThreads / "silk_gold.json").parameters.sigma_a);
  EXPECT_EQ(std::get<renderer::CylinderShape>(scene.cloths[0].shape).radius_mm, 41);
  EXPECT_EQ(scene.cloths[0].world_from_cloth.translation(), Eigen::Vector3d(5, 6, 7));
  EXPECT_EQ(std::get<renderer::Draft>(scene.cloths[0].weave).warp.threads, std::vector<int>{0});
  EXPECT_EQ(std::get<renderer::Draft>(scene.cloths[0].weave).weft.threads, std::vector<int>{1});
  EXPECT_TRUE(scene.cloths[0].two_scale);
  EXPECT_DOUBLE_EQ(scene.lights[0].radiance.x() * std::numbers::pi * 40 * 40, 600000);
  EXPECT_FALSE(scene.lights[0].visible);
  EXPECT_EQ(scene.lights[1].radiance.x(), 0.15);
  EXPECT_EQ(scene.camera.width, 400);
  EXPECT_LT((renderer::project(scene.camera, {0, 0, 84}) - Eigen::Vector2d(199.5, 299.5)).norm(), 1e-9);
  EXPECT_EQ(scene.brightness, 2.5);
}

TEST(SceneFile, ANumberIsTheRadianceOfAWhiteLight) {
  json document = plain_scene();
  document["lights"][0].erase("intensity_mm2");
  document["lights"][0]["radiance"] = 7.5;
  EXPECT_EQ(parse_scene(document, "scene", kScenes).lights.at(0).radiance, Eigen::Vector3d(7.5, 7.5, 7.5));
  document["lights"][0].erase("radiance");
  document["lights"][0]["intensity_mm2"] = 3;
  const renderer::SphereLight light = parse_scene(document, "scene", kScenes).lights.at(0);
  EXPECT_DOUBLE_EQ(light.radiance.z() * std::numbers::pi * light.radius_mm * light.radius_mm, 3);
}

TEST(SceneFile, AStudioHasABackdropAndIsExposedByAWhiteCard) {
  json document = plain_scene();
  document["objects"] = {{{"kind", "backdrop"}, {"radius_mm", 900}, {"bend_mm", 300}, {"albedo", {0.5, 0.5, 0.5}}}};
  document["objects"].push_back({{"kind", "form"}, {"height_mm", 700}, {"albedo", {0.1, 0.1, 0.1}}});
  document["white_card"] = {{"position_mm", {1, 2, 3}}, {"normal", {0, 0, 4}}};
  const SceneFile scene = parse_scene(document, "scene", kScenes);
  const renderer::UvMesh& backdrop = *std::get<renderer::MeshShape>(scene.objects.at(0).shape).mesh;
  double most = 0;
  for (const Eigen::Vector3d& place : backdrop.vertices) most = std::max(most, place.head<2>().norm());
  EXPECT_NEAR(most, 900, 1e-9);
  const renderer::UvMesh& form = *std::get<renderer::MeshShape>(scene.objects.at(1).shape).mesh;
  EXPECT_EQ(form.vertices.front(), Eigen::Vector3d(0, 0, 700));
  ASSERT_TRUE(scene.white_card);
  EXPECT_EQ(scene.white_card->position_mm, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(scene.brightness);
  document["objects"][0]["bend_mm"] = 1000;
  EXPECT_NE(refusal([&] { parse_scene(document, "scene", kScenes); }).find("bends by more"), std::string::npos);
  document["objects"][0]["bend_mm"] = 300;
  document["white_card"]["normal"] = {0, 0, 0};
  EXPECT_NE(refusal([&] { parse_scene(document, "scene", kScenes); }).find("no direction"), std::string::npos);
}

TEST(SceneFile, ARectanglesBrightSideFacesItsTarget) {
  json document = plain_scene();
  document["lights"] = {{{"kind", "rectangle"},
                         {"position_mm", {100, 0, 50}},
                         {"target_mm", {0, 0, 50}},
                         {"width_mm", 30},
                         {"height_mm", 20},
                         {"intensity_mm2", {600, 1200, 1800}},
                         {"visible", false}}};
  const SceneFile scene = parse_scene(document, "scene", kScenes);
  EXPECT_TRUE(scene.lights.empty());
  ASSERT_EQ(scene.rectangles.size(), 1u);
  const renderer::RectangleLight& light = scene.rectangles[0];
  EXPECT_LT((light.edge_x.cross(light.edge_y) - Eigen::Vector3d(-600, 0, 0)).norm(), 1e-9);
  EXPECT_LT((light.edge_y - Eigen::Vector3d(0, 0, 20)).norm(), 1e-9);
  EXPECT_LT((light.radiance - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
  EXPECT_FALSE(light.visible);
}

TEST(SceneFile, ALensIsFocusedOnTheTargetUnlessItSaysWhere) {
  json document = plain_scene();
  EXPECT_EQ(parse_scene(document, "scene", kScenes).camera.aperture_mm, 0);
  document["camera"]["aperture_mm"] = 12;
  const renderer::Camera camera = parse_scene(document, "scene", kScenes).camera;
  EXPECT_EQ(camera.aperture_mm, 12);
  EXPECT_DOUBLE_EQ(camera.focus_mm, 400);
  document["camera"]["focus_mm"] = 380;
  EXPECT_EQ(parse_scene(document, "scene", kScenes).camera.focus_mm, 380);
}

TEST(SceneFile, APatchServesAsWellAsItsDraft) {
  const station_test::TemporaryFolder folder;
  const renderer::YarnPatch patch = renderer::initial_patch(read_draft(fs::path(DATA_DIR) / "drafts" / "plain.json"));
  write_json_file(folder / "patch.json", to_json(patch));
  json document = plain_scene();
  document["threads"] = {(kThreads / "silk_red.json").string()};
  document["cloths"][0].erase("draft");
  document["cloths"][0].erase("warp_threads");
  document["cloths"][0].erase("weft_threads");
  document["cloths"][0]["patch"] = "patch.json";
  const SceneFile scene = parse_scene(document, "scene", folder.path());
  EXPECT_EQ(std::get<renderer::YarnPatch>(scene.cloths[0].weave).yarns.size(), patch.yarns.size());
}

TEST(SceneFile, EachMistakeIsRefusedInOneLineThatNamesIt) {
  struct Mistake {
    std::string pointer;
    json value;  // null: the key is removed
    std::string named;
  };
  const std::vector<Mistake> mistakes{
      {"/format", "threadstation/draft", "expected a \"threadstation/scene\" document"},
      {"/colour", 1, "unknown key \"colour\""},
      {"/threads", "silk_red.json", "threads"},
      {"/threads/0", "none.json", "none.json: no such file"},
      {"/threads/0", "../drafts/plain.json", "expected a \"threadstation/thread\" document"},
      {"/cloths/0/draft", "../threads/silk_red.json", "expected a \"threadstation/draft\" document"},
      {"/cloths/0/patch", "p.json", "either a draft or a patch"},
      {"/cloths/0/draft", nullptr, "either a draft or a patch"},
      {"/cloths/0/weft_threads", {2}, "has a yarn of thread 2, but the scene lists 2 threads"},
      {"/cloths/0/weft_threads", {0.5}, "cloths[0].weft_threads"},
      {"/cloths/0/weft_threads", {-1}, "cloths[0].weft_threads"},
      {"/cloths/0/weft_threads", json::array(), "the list is empty"},
      {"/cloths/0/shape/kind", "sphere", "cloths[0].shape.kind"},
      {"/cloths/0/shape", {{"kind", "mesh"}, {"unit_mm", 1}}, "cloths[0].shape.file"},
      {"/cloths/0/shape", {{"kind", "mesh"}, {"file", "none.obj"}, {"unit_mm", 1}}, "none.obj: no such file"},
      {"/cloths/0/shape", {{"kind", "mesh"}, {"file", "README.md"}, {"unit_mm", 1}}, "expected .obj"},
      {"/cloths/0/shape", {{"kind", "skirt"}, {"flare_deg", 20}}, "cloths[0].shape.flare_deg"},
      {"/cloths/0/shape", {{"kind", "drape"}, {"folds", 5}}, "unknown key \"cloths[0].shape.folds\""},
      {"/cloths/0/shape/width_mm", 0, "cloths[0].shape.width_mm"},
      {"/cloths/0/shape/radius_mm", 3, "unknown key \"cloths[0].shape.radius_mm\""},
      {"/cloths/0/method", "fast", "cloths[0].method"},
      {"/cloths/0/world_from_cloth", {1, 2}, "4 x 4 rigid transform"},
      {"/objects",
       {{{"kind", "plane"}, {"width_mm", 1}, {"height_mm", 1}, {"albedo", {2, 0, 0}}}},
       "objects[0].albedo"},
      {"/lights", json::array(), "lights"},
      {"/lights/0/radiance", {1, 1, 1}, "either radiance or intensity_mm2"},
      {"/lights/0/intensity_mm2", {1, -1, 1}, "from 0 to"},
      {"/lights/0/intensity_mm2", -1, "lights[0].intensity_mm2"},
      {"/lights/0", {{"kind", "environment"}, {"file", "none.exr"}}, "none.exr"},
      {"/lights/0", {{"kind", "sphere"}, {"file", "none.exr"}}, "lights[0].kind"},
      {"/lights/0/radius_mm", -1, "lights[0].radius_mm"},
      {"/lights/0",
       {{"kind", "rectangle"}, {"position_mm", {0, 0, 1}}, {"target_mm", {0, 0, 1}}},
       "lights[0].target_mm"},
      {"/lights/0", {{"kind", "rectangle"}, {"position_mm", {0, 0, 1}}, {"target_mm", {0, 0, 0}}}, "lights[0].up"},
      {"/lights/0",
       {{"kind", "rectangle"}, {"position_mm", {0, 0, 1}}, {"target_mm", {1, 0, 0}}, {"width_mm", -1}},
       "lights[0].width_mm"},
      {"/camera/eye_mm", {0, 0, 0}, "camera.target_mm"},
      {"/camera/up", {0, 0, 1}, "camera.up"},
      {"/camera/width_px", 0, "camera.width_px"},
      {"/camera/focal_length_px", nullptr, "camera.focal_length_px"},
      {"/camera/aperture_mm", -1, "camera.aperture_mm"},
      {"/camera/focus_mm", 0, "camera.focus_mm"},
      {"/samples_per_pixel", 0.5, "samples_per_pixel"},
      {"/exposure", -1, "exposure"}};
  for (const Mistake& mistake : mistakes) {
    json document = plain_scene();
    const json::json_pointer at(mistake.pointer);
    if (mistake.value.is_null())
      document[at.parent_pointer()].erase(at.back());
    else
      document[at] = mistake.value;
    const std::string line = refusal([&] { parse_scene(document, "scene.json", kScenes); });
    EXPECT_NE(line.find(mistake.named), std::string::npos) << mistake.pointer << ": " << line;
    EXPECT_NE(line.find(".json"), std::string::npos) << "names no file: " << line;
  }
}

}  // namespace
}  // namespace station
