// A spool of threads wrapped on the holder: an open black frame with a window, its threads side by side across the
// front.
//
// Holder frame (mm): origin = centre of the frame's front face, +x = outward normal of the front, threads run along y,
// +z up while the threads are mounted horizontally. Thread centre-lines lie one radius in front of the face; with
// front_and_back a second sheet lies one radius behind the back face.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "renderer/scene/scene.h"

namespace inversion {

struct WrappedSpool {
  double frame_width_mm = 68, frame_height_mm = 68, frame_depth_mm = 3;
  double window_width_mm = 30, window_height_mm = 22;
  int turns = 50;
  double thread_diameter_mm = 0.5;  // = pitch: the turns touch
  bool front_and_back = false;
};

struct Segment3 {
  Eigen::Vector3d from, to;  // mm, holder frame
};

// The centre-lines of the threads: the front sheet from bottom to top, then the back sheet if there is one.
std::vector<Segment3> thread_lines(const WrappedSpool& spool);

// Adds a straight curve of constant radius from `line.from` to `line.to`, in `pieces` equal B-spline segments.
void add_straight_curve(renderer::CurveSet& curves, const Segment3& line, double radius_mm, int pieces);

// The threads as curves, one each, all with the same scattering.
renderer::CurveSet aligned_threads(const WrappedSpool& spool, const renderer::ScatteringModel& scattering);

// The same of a thread that is uneven along itself, a set for each turn from bottom to top: its absorption is
// exp(shades[turn]) times that of `thread`. std::invalid_argument unless there is a shade for each turn.
std::vector<renderer::CurveSet> shaded_threads(const WrappedSpool& spool, const renderer::ThreadParameters& thread,
                                               const std::vector<double>& shades);

// The frame without threads: four bars round the window, Lambertian.
renderer::TriangleMesh holder_frame(const WrappedSpool& spool, double albedo);

}  // namespace inversion
