// The stages on which cloth is shown, against where their cameras and lamps stand by hand.
#include "station/cloth/preview/cloth_stage.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "station/data/data_folder.h"
#include "station/documents/reader.h"

namespace {

using Eigen::Vector3d;
using nlohmann::json;

Vector3d vector_of(const json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}
json swatch(const station::ClothView& view) {
  return station::scene_on_stage(station::cloth_stage("swatch"), {.threads = {"warp.json", "weft.json"}}, view, 1);
}

// The swatch's camera looks along -z from (0, 0, 400) with y upwards.
TEST(ClothStage, TurnsTheCameraRoundTheClothAndUpwards) {
  const double height = 400 * std::sin(std::numbers::pi / 6), flat = 400 * std::cos(std::numbers::pi / 6);
  EXPECT_TRUE(vector_of(swatch({.turn_deg = 90})["camera"]["eye_mm"]).isApprox(Vector3d(400, 0, 0)));
  EXPECT_TRUE(vector_of(swatch({.tilt_deg = 30})["camera"]["eye_mm"]).isApprox(Vector3d(0, height, flat)));
  EXPECT_TRUE(
      vector_of(swatch({.turn_deg = -90, .tilt_deg = 30})["camera"]["eye_mm"]).isApprox(Vector3d(-flat, height, 0)));
  EXPECT_LT(vector_of(swatch({.tilt_deg = 90})["camera"]["eye_mm"]).y(), 400) << "straight above there is no turn";
}

TEST(ClothStage, TurnsTheLampAloneAndLeavesTheSurroundings) {
  const json still = swatch({}), turned = swatch({.light_turn_deg = 180});
  EXPECT_EQ(turned["camera"], still["camera"]);
  EXPECT_TRUE(vector_of(turned["lights"][0]["position_mm"]).isApprox(Vector3d(150, 200, -400)));
  EXPECT_EQ(turned["lights"][1], still["lights"][1]);
}

TEST(ClothStage, StaysAboveTheFloorWhereThereIsOne) {
  for (const char* shape : {"cylinder", "skirt", "pleats", "drape", "sari"})
    for (const double turn : {0.0, 120.0}) {
      const json scene = station::scene_on_stage(
          station::cloth_stage(shape), {.threads = {"a", "b"}},
          {.turn_deg = turn, .tilt_deg = -90, .light_turn_deg = turn, .light_tilt_deg = -90}, 1);
      EXPECT_NEAR(vector_of(scene["camera"]["eye_mm"]).z(), 20, 1e-6) << shape;
      EXPECT_NEAR(vector_of(scene["lights"][0]["position_mm"]).z(), 20, 1e-6) << shape;
    }
}

// A larger picture of the same view; and the ready scene's own view where nothing is asked.
TEST(ClothStage, ScaleAndZoomChangeSizeAndFieldOfView) {
  const auto half_angle = [](const json& camera) {
    return std::atan(camera["width_px"].get<double>() / 2 / camera["focal_length_px"].get<double>());
  };
  for (const station::ClothStage& stage : station::cloth_stages()) {
    const auto camera = [&](double zoom, double scale) {
      return station::scene_on_stage(stage, {.threads = {"a", "b"}}, {.zoom = zoom}, scale)["camera"];
    };
    const json ready = station::read_json_file(station::data_folder() / "scenes" / stage.scene)["camera"];
    EXPECT_NEAR(half_angle(camera(1, 1)), half_angle(ready), 1e-3) << stage.shape;
    EXPECT_EQ(vector_of(camera(1, 1)["eye_mm"]), vector_of(ready["eye_mm"])) << stage.shape;
    EXPECT_NEAR(half_angle(camera(1, 3)), half_angle(camera(1, 1)), 1e-3) << stage.shape;
    EXPECT_EQ(camera(1, 3)["width_px"], 3 * stage.width_px);
    EXPECT_NEAR(std::tan(half_angle(camera(1, 1))) / std::tan(half_angle(camera(2, 1))), 2, 1e-6) << stage.shape;
  }
}

// By the angle between the ways to the lamp and to the camera; the lamp's distance and strength stay.
TEST(ClothStage, LightComesFromWhereItIsAsked) {
  for (const station::ClothStage& stage : station::cloth_stages()) {
    const auto lit = [&](const std::string& lights) {
      return station::scene_on_stage(stage, {.threads = {"a", "b"}, .lights = lights}, {}, 1);
    };
    const json studio = lit("studio"), middle = studio["camera"]["target_mm"];
    const auto way_to = [&](const json& place) { return Vector3d(vector_of(place) - vector_of(middle)); };
    const Vector3d to_eye = way_to(studio["camera"]["eye_mm"]).normalized();
    const auto cosine = [&](const std::string& lights) {
      const json scene = lit(lights);
      EXPECT_EQ(scene["lights"].size(), 1U) << stage.shape << " " << lights;
      const Vector3d lamp = way_to(scene["lights"][0]["position_mm"]);
      EXPECT_NEAR(lamp.norm(), way_to(studio["lights"][0]["position_mm"]).norm(), 1e-6) << stage.shape << " " << lights;
      EXPECT_EQ(scene["lights"][0].value("intensity_mm2", json()), studio["lights"][0].value("intensity_mm2", json()));
      return lamp.normalized().dot(to_eye);
    };
    EXPECT_GT(cosine("front"), 0.9) << stage.shape;
    EXPECT_NEAR(cosine("side"), 0.3, 0.2) << stage.shape;
    EXPECT_LT(cosine("behind"), -0.5) << stage.shape;
    const json even = lit("even")["lights"];
    ASSERT_EQ(even.size(), 1U);
    EXPECT_EQ(even[0]["kind"], "environment");
    EXPECT_EQ(lit("room.exr")["lights"][0]["file"], "room.exr");
  }
}

TEST(ClothStage, AMeshStandsOnTheFloorOfAStageOfItsSize) {
  const station::ClothStage& stage = station::cloth_stage(station::kMeshShape);
  const Eigen::AlignedBox3d box(Vector3d(10, -20, 30), Vector3d(110, 180, 230));  // 300 mm from corner to corner
  const auto staged = [&](double larger) {
    const station::StagedMesh mesh{
        .file = "mesh.obj", .unit_mm = 2, .box_mm = {larger * box.min(), larger * box.max()}};
    return station::scene_on_stage(stage, {.threads = {"a", "b"}, .mesh = mesh}, {}, 1);
  };
  const json scene = staged(1), cloth = scene["cloths"][0];
  EXPECT_EQ(cloth["shape"], (json{{"kind", "mesh"}, {"file", "mesh.obj"}, {"unit_mm", 2.0}}));
  const json place = cloth["world_from_cloth"];
  const Vector3d moved(place[0][3], place[1][3], place[2][3]);
  EXPECT_TRUE((box.min() + moved).isApprox(Vector3d(-50, -100, 0)));
  EXPECT_TRUE(vector_of(scene["camera"]["target_mm"]).isApprox(Vector3d(0, 0, 100)));
  // Twice as large, all is twice as far and the light as strong on it.
  const json twice = staged(2);
  for (const char* key : {"eye_mm", "target_mm"})
    EXPECT_TRUE(vector_of(twice["camera"][key]).isApprox(2 * vector_of(scene["camera"][key]))) << key;
  EXPECT_EQ(twice["camera"]["focal_length_px"], scene["camera"]["focal_length_px"]);
  const json &lamp = scene["lights"][0], &far = twice["lights"][0];
  EXPECT_TRUE(vector_of(far["position_mm"]).isApprox(2 * vector_of(lamp["position_mm"])));
  EXPECT_TRUE(vector_of(far["intensity_mm2"]).isApprox(4 * vector_of(lamp["intensity_mm2"])));
  EXPECT_NEAR(far["width_mm"].get<double>(), 2 * lamp["width_mm"].get<double>(), 1e-9);
}

TEST(ClothStage, RefusesWhatCannotBeShown) {
  EXPECT_FALSE(station::problem_of({.turn_deg = 360, .zoom = 20}));
  for (const station::ClothView& view : {station::ClothView{.turn_deg = 361}, station::ClothView{.light_tilt_deg = NAN},
                                         station::ClothView{.zoom = 0}, station::ClothView{.zoom = 21}})
    EXPECT_TRUE(station::problem_of(view));
  EXPECT_TRUE(station::problem_of(station::cloth_view_of({{"turn_deg", "far"}}))) << "no silent guess";
  EXPECT_EQ(station::cloth_view_of(json::object()), station::ClothView{});
  EXPECT_THROW(station::cloth_stage("cube"), std::runtime_error);
}

}  // namespace
