// The stages on which cloth is shown: ready scenes (station/data/scenes) with a white card, in which cloth and threads
// are replaced, and the camera and the lamps are turned about the middle of the picture.
#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace station {

struct ClothStage {
  std::string shape;                // "swatch", "cylinder", "skirt", "pleats", "drape" or "sari"
  std::string scene;                // in station/data/scenes
  int width_px = 0, height_px = 0;  // on a screen
  int samples_per_pixel = 0;
};

const std::vector<ClothStage>& cloth_stages();
std::vector<std::string> cloth_shapes();           // the stages' names
inline constexpr const char* kMeshShape = "mesh";  // a stage for meshes, which is none of these
// Errors: std::runtime_error, one line, for a shape that is none of them.
const ClothStage& cloth_stage(const std::string& shape);
double scale_to(const ClothStage& stage, int longer_side_px);

// Angles from where the ready scene has camera and lamps, in degrees: `turn` counter-clockwise seen from above, `tilt`
// upwards. They end short of the floor, where the stage has one, and of straight above and below.
struct ClothView {
  double turn_deg = 0, tilt_deg = 0, light_turn_deg = 0, light_tilt_deg = 0;
  double zoom = 1;  // of the focal length
  bool operator==(const ClothView&) const = default;
};

// {"turn_deg", "tilt_deg", "light_turn_deg", "light_tilt_deg", "zoom"}; what is left out is the ready scene's, and what
// is no number is none, which problem_of() refuses.
nlohmann::json to_json(const ClothView& view);
ClothView cloth_view_of(const nlohmann::json& document);
// The line that refuses a view beyond 360 degrees or a zoom outside 0.25 to 20; nothing for a view that can be shown.
std::optional<std::string> problem_of(const ClothView& view);

// Where the light comes from: "studio" (the ready scene's lamps), "front", "side", "behind" (its first lamp alone,
// moved) or "even" (from everywhere); besides, a picture of all surroundings (EXR; scenes/README.md).
const std::vector<std::string>& cloth_lights();

// A mesh in the place of a stage's own cloth: the stage is as much larger as the mesh is larger than that, and its
// lowest point stands on the floor.
struct StagedMesh {
  std::string file;  // as the scene names it
  double unit_mm = 1;
  Eigen::AlignedBox3d box_mm{};
};

// What is put on a stage.
struct OnStage {
  std::vector<std::string> threads;  // of the patch
  std::string fibers{};              // what is seen of them close by (documents/cloth_fibers.h), or nothing
  std::string lights = "studio";     // one of cloth_lights(), or a picture, as the scene names it
  std::optional<StagedMesh> mesh{};
};

// The scene of patch.json, beside which it is written. `scale`: of the picture's size.
nlohmann::json scene_on_stage(const ClothStage& stage, const OnStage& shown, const ClothView& view, double scale);

}  // namespace station
