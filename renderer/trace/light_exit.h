// Where light leaves a thread that a ray has met, and where the ray goes on from there.
//
//   ThreadExit   | light that goes along wi leaves
//   entry_point  | where the ray came in
//   far_side     | where it came in if wi points out of the thread there, otherwise anywhere across the width that is
//                | seen from wi
//   wandering    | at the offset that simulated bundles of fibers say (exit_offsets.h), as far along the thread from
//                | the entry as the ray flies while it crosses from the entry to there
//
// A place is an angle on the thread's section, which may be an ellipse. Light may be drawn direction first (toward) or
// place first (near): paths that are drawn by scattering know the direction, light sampling knows a place and then
// draws the direction in which the lamp is seen from that place. Rays begin inside the thread, halfway along their
// chord through it: where yarns press into each other, light that leaves one of them inside another meets it there.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "renderer/picture/sampler.h"
#include "renderer/scattering/thread.h"
#include "renderer/trace/ray_hit.h"

namespace renderer {

// The offset h = sin gamma_o of a ray that met a curve and came from unit direction wo: how far from the curve's axis
// it passes, as a share of the half width that is seen from wo.
float offset_in_section(const CurvePoint& point, const Eigen::Vector3f& wo);

// A place where light leaves, with how it was drawn.
struct LightExit {
  Eigen::Vector3f place;      // world, on the thread's surface
  Eigen::Vector2f on_circle;  // of the section, (side, out) of CurvePoint as unit vectors
  // What near() drew the place with: its density per radian, or the probability of the entry. 0: toward() drew it.
  float drawn = 0;
  bool at_entry = true;
};

// A ray that goes on from a place of exit. It begins `lead` before that place.
struct LeavingRay {
  Ray ray;
  float lead = 0;  // mm
};

class ThreadExits {
 public:
  // `point` must outlive it; `wo`: unit direction back along the ray that met the thread.
  ThreadExits(ThreadExit rule, const CurvePoint& point, const Eigen::Vector3f& wo);

  // A place where light leaves along unit direction wi.
  LightExit toward(const Eigen::Vector3f& wi, Sampler& sampler) const;
  // A place where light leaves in some direction like `about`, to be weighted by share().
  LightExit near(const Eigen::Vector3f& about, Sampler& sampler) const;
  // The density with which light that goes along wi leaves there, over that with which the place was drawn.
  float share(const LightExit& exit, const Eigen::Vector3f& wi) const;
  LeavingRay ray(const LightExit& exit, const Eigen::Vector3f& wi) const;

 private:
  // How the section looks from a direction across the tangent.
  struct Seen {
    Eigen::Vector2f outward, across;  // on the circle: the middle of what is seen, and where offsets are largest
    float half_width = 0;             // mm
    float cosine = 0;                 // of the inclination; 0: along the tangent
  };
  Seen seen_from(const Eigen::Vector3f& direction) const;
  // The azimuth of wi relative to wo, about the tangent.
  float azimuth_of(const Eigen::Vector3f& wi) const;
  LightExit at(const Eigen::Vector2f& on_circle, float drawn) const;
  LightExit at_entry(float drawn) const;
  bool faces_entry(const Seen& seen) const { return seen.cosine == 0 || seen.outward.y() >= 0; }
  // The density per radian of the circle with which light along wi leaves there; `seen`: seen_from(wi).
  float density(const Eigen::Vector2f& on_circle, const Seen& seen, const Eigen::Vector3f& wi) const;

  ThreadExit rule_;
  const CurvePoint* point_;
  Eigen::Vector3f side_, out_;  // unit vectors across the tangent, against which azimuths are measured
  Eigen::Vector2f came_from_;   // wo by those
  float offset_in_, slope_;
};

}  // namespace renderer
