#include "station/bench/bench_objects.h"

#include <cmath>
#include <numbers>

#include "calibration/light/colour_chart.h"
#include "calibration/light/spectralon.h"
#include "station/bench/reference_chip.h"

namespace station {
namespace {

constexpr float kPaperAlbedo = 0.85F, kGreyPaperAlbedo = 0.12F, kInkAlbedo = 0.04F, kTableAlbedo = 0.03F;
constexpr double kPaperLift_mm = 0.02;  // a printed tag lies this far above what carries it

// A flat rectangle centred at the frame's origin, in its xy plane, +y up; texture upright seen from +z.
renderer::TriangleMesh rectangle(const Eigen::Isometry3d& frame, double width, double height, const cv::Mat3f& albedo) {
  renderer::TriangleMesh mesh;
  const double x = width / 2, y = height / 2;
  for (const Eigen::Vector3d& corner :
       {Eigen::Vector3d(-x, y, 0), Eigen::Vector3d(x, y, 0), Eigen::Vector3d(x, -y, 0), Eigen::Vector3d(-x, -y, 0)})
    mesh.vertices.push_back((frame * corner).cast<float>());
  mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  mesh.albedo = albedo;
  return mesh;
}

cv::Mat3f plain(float albedo) {
  return cv::Mat3f(1, 1, cv::Vec3f(albedo, albedo, albedo));
}

void make_spectralon(renderer::TriangleMesh& mesh, double droop) {
  if (droop == 0) return;
  mesh.reflectance_factor = [droop](double cos_theta_i, double cos_theta_o, double cos_phi) {
    return 1 + droop * calibration::droop_shape(cos_theta_i, cos_theta_o, cos_phi);
  };
}

// The tag as printed on paper: 10 x 10 cells, the black square being 8 cells wide.
renderer::TriangleMesh printed_tag(const calibration::Tag& tag, float paper_albedo) {
  const cv::Mat1b bitmap = calibration::tag_bitmap(tag.id);
  cv::Mat3f albedo(bitmap.size());
  for (int row = 0; row < bitmap.rows; ++row)
    for (int column = 0; column < bitmap.cols; ++column) {
      const float value = bitmap(row, column) ? paper_albedo : kInkAlbedo;
      albedo(row, column) = cv::Vec3f(value, value, value);
    }
  const Eigen::Isometry3d lifted = tag.object_from_tag * Eigen::Translation3d(0, 0, kPaperLift_mm);
  const double edge = tag.size_mm * bitmap.cols / 8.0;
  return rectangle(lifted, edge, edge, albedo);
}

void add_tags(std::vector<renderer::TriangleMesh>& meshes, const calibration::TagLayout& layout,
              float paper_albedo = kPaperAlbedo) {
  for (const calibration::Tag& tag : layout.tags) meshes.push_back(printed_tag(tag, paper_albedo));
}

renderer::TriangleMesh disc(double radius, double height) {
  constexpr int kSides = 96;
  renderer::TriangleMesh mesh;
  mesh.vertices.emplace_back(0.F, 0.F, static_cast<float>(height));
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    mesh.vertices.push_back(Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), height).cast<float>());
  }
  for (std::uint32_t i = 0; i < kSides; ++i) mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % kSides});
  mesh.albedo = plain(kBlackPaintAlbedo);
  return mesh;
}

}  // namespace

std::vector<renderer::TriangleMesh> table_and_platform(double platform_height_mm, double platform_radius_mm) {
  return {rectangle(Eigen::Isometry3d::Identity(), 2400, 2400, plain(kTableAlbedo)),
          disc(platform_radius_mm, platform_height_mm)};
}

std::vector<renderer::TriangleMesh> lying_tag_meshes(const calibration::TagLayout& tags) {
  std::vector<renderer::TriangleMesh> meshes;
  add_tags(meshes, tags, kGreyPaperAlbedo);
  return meshes;
}

std::vector<renderer::TriangleMesh> board_meshes(const calibration::TagLayout& board, double bow_mm) {
  Eigen::Vector2d extent = Eigen::Vector2d::Zero();
  for (const calibration::Tag& tag : board.tags)
    extent = extent.cwiseMax(tag.object_from_tag.translation().head<2>().cwiseAbs() +
                             Eigen::Vector2d::Constant(tag.size_mm * 0.75));
  // Behind every bent tag: the paper between them stays flat.
  const Eigen::Isometry3d behind(Eigen::Translation3d(0, 0, bow_mm == 0 ? 0 : -0.5 - std::abs(bow_mm)));
  std::vector<renderer::TriangleMesh> meshes{rectangle(behind, 2 * extent.x(), 2 * extent.y(), plain(kPaperAlbedo))};
  calibration::TagLayout bent = board;
  for (calibration::Tag& tag : bent.tags) {
    const double u = tag.object_from_tag.translation().x() / extent.x();
    tag.object_from_tag.translation().z() += bow_mm * (1 - u * u);
    tag.object_from_tag.rotate(Eigen::AngleAxisd(std::atan(2 * bow_mm * u / extent.x()), Eigen::Vector3d::UnitY()));
  }
  add_tags(meshes, bent);
  return meshes;
}

std::vector<renderer::TriangleMesh> spectralon_meshes(const SpectralonPanel& panel, double droop) {
  const Eigen::Isometry3d lifted(Eigen::Translation3d(0, 0, kPaperLift_mm));
  std::vector<renderer::TriangleMesh> meshes{
      rectangle(Eigen::Isometry3d::Identity(), panel.plate_mm, panel.plate_mm, plain(kBlackPaintAlbedo)),
      rectangle(lifted, panel.white_mm, panel.white_mm, plain(static_cast<float>(panel.albedo)))};
  make_spectralon(meshes.back(), droop);
  add_tags(meshes, panel.tags);
  return meshes;
}

std::vector<renderer::TriangleMesh> colour_chart_meshes(const ColourChart& chart,
                                                        const Eigen::Matrix3d& camera_from_linear_srgb) {
  std::vector<renderer::TriangleMesh> meshes{
      rectangle(Eigen::Isometry3d::Identity(), chart.plate_mm, chart.plate_mm, plain(kBlackPaintAlbedo))};
  const auto& squares = calibration::colour_chart();
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const Eigen::Vector3d colour = camera_from_linear_srgb * calibration::linear_srgb_of_lab(squares[i].lab_d50);
    const Eigen::Vector3f albedo = colour.cwiseMax(0.0).cwiseMin(1.0).cast<float>();
    const Eigen::Isometry3d place(
        Eigen::Translation3d(chart_square_centre(chart, i) + Eigen::Vector3d(0, 0, kPaperLift_mm)));
    meshes.push_back(rectangle(place, chart.square_mm, chart.square_mm,
                               cv::Mat3f(1, 1, cv::Vec3f(albedo[0], albedo[1], albedo[2]))));
  }
  add_tags(meshes, chart.tags);
  return meshes;
}

std::vector<renderer::TriangleMesh> holder_meshes(const inversion::WrappedSpool& spool,
                                                  const calibration::TagLayout& tags) {
  std::vector<renderer::TriangleMesh> meshes{inversion::holder_frame(spool, kBlackPaintAlbedo)};
  add_tags(meshes, tags);
  return meshes;
}

std::vector<renderer::TriangleMesh> reference_chip_meshes(const ReferenceChip& chip,
                                                          const inversion::WrappedSpool& spool, double droop) {
  std::vector<renderer::TriangleMesh> meshes;
  for (const rig::Mounting mounting : {rig::Mounting::horizontal, rig::Mounting::vertical}) {
    const Eigen::Isometry3d lifted =
        holder_from_chip(chip, spool, mounting) * Eigen::Translation3d(0, 0, kPaperLift_mm);
    meshes.push_back(rectangle(lifted, chip.edge_mm, chip.edge_mm, plain(static_cast<float>(chip.albedo))));
    make_spectralon(meshes.back(), droop);
  }
  return meshes;
}

void transform(renderer::TriangleMesh& mesh, const Eigen::Isometry3d& to_from_mesh) {
  for (Eigen::Vector3f& vertex : mesh.vertices) vertex = (to_from_mesh * vertex.cast<double>()).cast<float>();
}

}  // namespace station
