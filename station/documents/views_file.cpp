#include "station/documents/views_file.h"

#include "renderer/picture/image_file.h"
#include "station/documents/degree.h"
#include "station/documents/reader.h"

namespace station {
namespace {

using nlohmann::json;
constexpr Range kVariance{0, 1e12};

json view_json(const DevelopedView& developed) {
  const inversion::View& view = developed.view;
  const renderer::Camera& camera = view.camera;
  json document{{"id", view.id},
                {"light_side", view.transmission ? "back" : "front"},
                {"mounting", developed.mounting == rig::Mounting::horizontal ? "horizontal" : "vertical"},
                {"platform_angle_deg", developed.platform_angle_rad / kDegree},
                {"angle_from", developed.angle_measured ? "tags" : "turntable"},
                {"exposure_s", developed.exposure_s},
                {"image_file", developed.image_file},
                {"mask_file", developed.mask_file},
                {"masked_pixels", developed.masked_pixels},
                {"saturated_fraction", developed.saturated_fraction},
                {"pose_rms_px", developed.pose_rms_px},
                {"lamp_strength", developed.lamp_strength},
                {"camera",
                 {{"width_px", camera.width},
                  {"height_px", camera.height},
                  {"focal_length_px", {camera.fx, camera.fy}},
                  {"principal_point_px", {camera.cx, camera.cy}},
                  {"holder_from_camera", to_json(camera.world_from_camera)}}},
                {"light",
                 {{"position_mm", to_json(view.light.position)},
                  {"intensity_mm2", to_json(view.light.intensity)},
                  {"radius_mm", view.light.radius_mm},
                  {"beam_axis", to_json(view.light.beam_axis)},
                  {"beam_exponent", view.light.beam_exponent}}}};
  if (developed.noise)
    document["noise_variance"] = {{"floor", to_json(developed.noise->floor.matrix())},
                                  {"per_radiance", to_json(developed.noise->slope.matrix())}};
  return document;
}

DevelopedView parse_view(ObjectReader reader) {
  DevelopedView developed;
  inversion::View& view = developed.view;
  view.id = reader.text("id");
  view.transmission = reader.choice("light_side", {"front", "back"}) == "back";
  developed.mounting = reader.choice("mounting", {"horizontal", "vertical"}) == "horizontal" ? rig::Mounting::horizontal
                                                                                             : rig::Mounting::vertical;
  developed.platform_angle_rad = reader.number("platform_angle_deg", -720, 720) * kDegree;
  developed.angle_measured = reader.choice("angle_from", {"tags", "turntable"}) == "tags";
  developed.exposure_s = reader.number("exposure_s", 0, 3600);
  developed.image_file = reader.text("image_file");
  developed.mask_file = reader.text("mask_file");
  developed.masked_pixels = reader.integer("masked_pixels", 0, 1 << 30);
  developed.saturated_fraction = reader.number("saturated_fraction", 0, 1);
  developed.pose_rms_px = reader.number("pose_rms_px", 0, 1e6);
  developed.lamp_strength = reader.number("lamp_strength", 1e-6, 1e6);
  if (reader.has("noise_variance")) {
    ObjectReader noise = reader.object("noise_variance");
    developed.noise = inversion::NoiseLaw{.floor = noise.vector3("floor", kVariance).array(),
                                          .slope = noise.vector3("per_radiance", kVariance).array()};
    noise.finish();
  }
  ObjectReader camera = reader.object("camera");
  view.camera.width = camera.integer("width_px", 1, 100000);
  view.camera.height = camera.integer("height_px", 1, 100000);
  const auto focal = camera.numbers("focal_length_px", 2), centre = camera.numbers("principal_point_px", 2);
  view.camera.fx = focal[0];
  view.camera.fy = focal[1];
  view.camera.cx = centre[0];
  view.camera.cy = centre[1];
  view.camera.world_from_camera = camera.transform("holder_from_camera");
  camera.finish();
  ObjectReader light = reader.object("light");
  view.light.position = light.vector3("position_mm");
  view.light.intensity = light.vector3("intensity_mm2");
  view.light.radius_mm = light.number("radius_mm", 1e-3, 1000);
  view.light.beam_axis = light.vector3("beam_axis").normalized();
  view.light.beam_exponent = light.number("beam_exponent", -10, 1000);
  light.finish();
  reader.finish();
  return developed;
}

}  // namespace

json to_json(const DevelopedViews& views) {
  json list = json::array();
  for (const DevelopedView& view : views.views) list.push_back(view_json(view));
  json document = {{"format", "threadstation/views"},
                   {"version", 1},
                   {"linear_srgb_from_camera", views.linear_srgb_from_camera},
                   {"views", list}};
  if (views.sheet_width_mm) document["sheet_width_mm"] = *views.sheet_width_mm;
  return document;
}

DevelopedViews parse_views(const json& document, const std::string& source) {
  ObjectReader reader(document, source, "views");
  DevelopedViews result;
  const auto colour = reader.numbers("linear_srgb_from_camera", 9);
  std::copy(colour.begin(), colour.end(), result.linear_srgb_from_camera.begin());
  if (reader.has("sheet_width_mm")) result.sheet_width_mm = reader.number("sheet_width_mm", 0, 1000);
  for (const ObjectReader& view : reader.objects("views")) result.views.push_back(parse_view(view));
  reader.finish();
  return result;
}

DevelopedViews read_views(const std::filesystem::path& session) {
  const std::filesystem::path file = session / "linear" / "views.json";
  return parse_views(read_json_file(file), file.string());
}

void read_view_pictures(const std::filesystem::path& session, DevelopedViews& views) {
  for (DevelopedView& developed : views.views) {
    inversion::View& view = developed.view;
    view.image = renderer::read_exr(session / developed.image_file);
    view.mask = renderer::read_png_grey(session / developed.mask_file);
    if (developed.noise) view.noise = divided(*developed.noise, developed.lamp_strength);
    view.image /= developed.lamp_strength;
    const cv::Size expected(view.camera.width, view.camera.height);
    if (view.image.size() != expected || view.mask.size() != expected)
      throw std::runtime_error("view " + view.id + ": picture or mask is not " + std::to_string(expected.width) +
                               " x " + std::to_string(expected.height) +
                               " pixels as views.json says; run develop again");
  }
}

}  // namespace station
