#include "station/documents/patch_file.h"

#include <cmath>

#include "station/documents/reader.h"

namespace station {
namespace {

using nlohmann::json;

constexpr double kMostLength = 1e5;  // mm
constexpr std::size_t kFewestPoints = 4;

Eigen::Vector3d parse_point(const ObjectReader& yarn, const json& point, std::size_t index) {
  Eigen::Vector3d p;
  const auto refuse = [&] {
    yarn.refuse("control_points_mm", "point " + std::to_string(index + 1) + " is not [x, y, z] in millimetres");
  };
  if (!point.is_array() || point.size() != 3) refuse();
  for (int i = 0; i < 3; ++i) {
    const json& value = point[static_cast<std::size_t>(i)];
    if (!value.is_number() || !(std::abs(value.get<double>()) <= kMostLength)) refuse();
    p[i] = value.get<double>();
  }
  return p;
}

renderer::Yarn parse_yarn(ObjectReader reader) {
  renderer::Yarn yarn;
  yarn.warp = reader.choice("system", {"warp", "weft"}) == "warp";
  yarn.thread = reader.integer("thread", 0, renderer::kMostThreads - 1);
  yarn.radius_mm = reader.number("radius_mm", 1e-6, kMostLength);
  yarn.flatness = reader.number("flatness", 1, renderer::kMostFlatness);
  yarn.tex = reader.number("tex", 0, 1e6);
  const json& points = reader.raw("control_points_mm");
  if (!points.is_array() || points.size() < kFewestPoints)
    reader.refuse("control_points_mm", "expected a list of at least " + std::to_string(kFewestPoints) + " points");
  for (const json& point : points)
    yarn.control_points.push_back(parse_point(reader, point, yarn.control_points.size()));
  const std::size_t count = yarn.control_points.size();
  if (reader.has("thickness")) yarn.thickness = reader.numbers("thickness", count, Range{0.01, 100});
  if (reader.has("threads"))
    for (const double thread : reader.numbers("threads", count, Range{0, renderer::kMostThreads - 1})) {
      if (thread != std::floor(thread)) reader.refuse("threads", "expected whole numbers");
      yarn.threads.push_back(static_cast<int>(thread));
    }
  reader.finish();
  return yarn;
}

void parse_measures(ObjectReader reader, renderer::YarnPatch& patch) {
  patch.thickness_mm = reader.number("thickness_mm", 0, kMostLength);
  patch.crimp_warp = reader.number("crimp_warp", -1, 1e6);
  patch.crimp_weft = reader.number("crimp_weft", -1, 1e6);
  patch.areal_mass_g_m2 = reader.number("areal_mass_g_m2", 0, 1e9);
  patch.cover = reader.number("cover", 0, 1);
  patch.least_gap_mm = reader.number("least_gap_mm", -kMostLength, kMostLength);
  reader.finish();
}

json yarn_json(const renderer::Yarn& yarn) {
  json points = json::array();
  for (const Eigen::Vector3d& point : yarn.control_points) points.push_back(to_json(point));
  json document{{"system", yarn.warp ? "warp" : "weft"},
                {"thread", yarn.thread},
                {"radius_mm", yarn.radius_mm},
                {"flatness", yarn.flatness},
                {"tex", yarn.tex},
                {"control_points_mm", points}};
  if (!yarn.thickness.empty()) document["thickness"] = yarn.thickness;
  if (!yarn.threads.empty()) document["threads"] = yarn.threads;
  return document;
}

}  // namespace

renderer::YarnPatch parse_patch(const json& document, const std::string& source) {
  ObjectReader reader(document, source, "patch");
  renderer::YarnPatch patch;
  patch.name = reader.text("name");
  patch.period_x_mm = reader.number("period_x_mm", 1e-6, kMostLength);
  patch.period_y_mm = reader.number("period_y_mm", 1e-6, kMostLength);
  patch.height_scale = reader.number("height_scale", 1e-6, 1e6);
  for (const ObjectReader& yarn : reader.objects("yarns")) patch.yarns.push_back(parse_yarn(yarn));
  if (patch.yarns.empty()) reader.refuse("yarns", "the list is empty, expected at least one yarn");
  parse_measures(reader.object("measured"), patch);
  reader.finish();
  return patch;
}

renderer::YarnPatch read_patch(const std::filesystem::path& file) {
  return parse_patch(read_json_file(file), file.string());
}

json to_json(const renderer::YarnPatch& patch) {
  json yarns = json::array();
  for (const renderer::Yarn& yarn : patch.yarns) yarns.push_back(yarn_json(yarn));
  return {{"format", "threadstation/patch"},
          {"version", 1},
          {"name", patch.name},
          {"period_x_mm", patch.period_x_mm},
          {"period_y_mm", patch.period_y_mm},
          {"height_scale", patch.height_scale},
          {"measured",
           {{"thickness_mm", patch.thickness_mm},
            {"crimp_warp", patch.crimp_warp},
            {"crimp_weft", patch.crimp_weft},
            {"cover", patch.cover},
            {"areal_mass_g_m2", patch.areal_mass_g_m2},
            {"least_gap_mm", patch.least_gap_mm}}},
          {"yarns", yarns}};
}

}  // namespace station
