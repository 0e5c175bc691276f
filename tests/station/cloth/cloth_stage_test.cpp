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
  return station::scene_on_stage(station::cloth_stage("swatch"), {"warp.json", "weft.json"}, view, 1);
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
  for (const char* shape : {"cylinder", "skirt", "pleats", "drape"})
    for (const double turn : {0.0, 120.0}) {
      const json scene = station::scene_on_stage(
          station::cloth_stage(shape), {"a", "b"},
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
      return station::scene_on_stage(stage, {"a", "b"}, {.zoom = zoom}, scale)["camera"];
    };
    const json ready = station::read_json_file(station::data_folder() / "scenes" / stage.scene)["camera"];
    EXPECT_NEAR(half_angle(camera(1, 1)), half_angle(ready), 1e-3) << stage.shape;
    EXPECT_EQ(vector_of(camera(1, 1)["eye_mm"]), vector_of(ready["eye_mm"])) << stage.shape;
    EXPECT_NEAR(half_angle(camera(1, 3)), half_angle(camera(1, 1)), 1e-3) << stage.shape;
    EXPECT_EQ(camera(1, 3)["width_px"], 3 * stage.width_px);
    EXPECT_NEAR(std::tan(half_angle(camera(1, 1))) / std::tan(half_angle(camera(2, 1))), 2, 1e-6) << stage.shape;
  }
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
