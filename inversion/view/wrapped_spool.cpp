#include "inversion/view/wrapped_spool.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace inversion {
namespace {

// Long segments cost Embree precision and tight boxes; ten segments a thread measured no slower than one. Pieces of at
// most 28 radii are met as cylinders (renderer/trace/curve_geometry.cpp), in less than half the time.
constexpr int kLeastPieces = 10;
constexpr double kLongestPiece = 28;

int pieces_per_thread(const WrappedSpool& spool) {
  const double radii = spool.frame_width_mm / (spool.thread_diameter_mm / 2);
  return std::max(kLeastPieces, static_cast<int>(std::ceil(radii / kLongestPiece)));
}

void add_box(renderer::TriangleMesh& mesh, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d v(corner & 1 ? high.x() : low.x(), corner & 2 ? high.y() : low.y(),
                            corner & 4 ? high.z() : low.z());
    mesh.vertices.push_back(v.cast<float>());
  }
  const std::array<std::array<std::uint32_t, 4>, 6> faces{
      {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
    mesh.triangles.push_back({first + f[0], first + f[2], first + f[3]});
  }
}

}  // namespace

std::vector<Segment3> thread_lines(const WrappedSpool& spool) {
  std::vector<Segment3> lines;
  const double radius = spool.thread_diameter_mm / 2;
  const double half_width = spool.frame_width_mm / 2;
  const auto add_sheet = [&](double x) {
    for (int i = 0; i < spool.turns; ++i) {
      const double z = (i - (spool.turns - 1) / 2.0) * spool.thread_diameter_mm;
      lines.push_back({{x, -half_width, z}, {x, half_width, z}});
    }
  };
  add_sheet(radius);
  if (spool.front_and_back) add_sheet(-spool.frame_depth_mm - radius);
  return lines;
}

void add_straight_curve(renderer::CurveSet& curves, const Segment3& line, double radius_mm, int pieces) {
  // Equally spaced collinear control points make a uniform B-spline that runs straight from the second to the
  // second last of them.
  const auto first = static_cast<std::uint32_t>(curves.control_points.size());
  const Eigen::Vector3d step = (line.to - line.from) / pieces;
  for (int i = -1; i <= pieces + 1; ++i) {
    const Eigen::Vector3d p = line.from + i * step;
    curves.control_points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()),
                                       static_cast<float>(radius_mm));
  }
  for (int i = 0; i < pieces; ++i) curves.segments.push_back(first + static_cast<std::uint32_t>(i));
}

renderer::CurveSet aligned_threads(const WrappedSpool& spool, const renderer::ScatteringModel& scattering) {
  renderer::CurveSet curves;
  curves.scattering = scattering;
  for (const Segment3& line : thread_lines(spool))
    add_straight_curve(curves, line, spool.thread_diameter_mm / 2, pieces_per_thread(spool));
  return curves;
}

std::vector<renderer::CurveSet> shaded_threads(const WrappedSpool& spool, const renderer::ThreadParameters& thread,
                                               const std::vector<double>& shades) {
  if (shades.size() != static_cast<std::size_t>(spool.turns))
    throw std::invalid_argument("shaded_threads: one shade for each turn");
  std::vector<renderer::CurveSet> turns(shades.size());
  for (std::size_t turn = 0; turn < turns.size(); ++turn) {
    renderer::ThreadParameters shaded = thread;
    shaded.sigma_a *= std::exp(shades[turn]);
    turns[turn].scattering = shaded;
  }
  std::size_t line_number = 0;
  for (const Segment3& line : thread_lines(spool))
    add_straight_curve(turns[line_number++ % turns.size()], line, spool.thread_diameter_mm / 2,
                       pieces_per_thread(spool));
  return turns;
}

renderer::TriangleMesh holder_frame(const WrappedSpool& spool, double albedo) {
  renderer::TriangleMesh mesh;
  const double w = spool.frame_width_mm / 2, h = spool.frame_height_mm / 2, d = spool.frame_depth_mm;
  const double iw = spool.window_width_mm / 2, ih = spool.window_height_mm / 2;
  add_box(mesh, {-d, -w, ih}, {0, w, h});      // above the window
  add_box(mesh, {-d, -w, -h}, {0, w, -ih});    // below
  add_box(mesh, {-d, -w, -ih}, {0, -iw, ih});  // left and right
  add_box(mesh, {-d, iw, -ih}, {0, w, ih});
  const auto grey = static_cast<float>(albedo);
  mesh.albedo = cv::Mat3f(1, 1, cv::Vec3f(grey, grey, grey));
  return mesh;
}

}  // namespace inversion
