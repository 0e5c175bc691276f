// The departure of a Spectralon panel from a Lambertian surface: brighter where light and view are steep, darker where
// they graze, brightest towards the mirror direction.
//
// BRF relative to a Lambertian surface of the panel's certified reflectance = 1 + droop * s(theta_i, theta_e, phi). The
// shape s comes from a published model of a 99 % panel at 550 nm (doi 10.1109/TGRS.2024.3361392, table in
// fixtures/reference/spectralon), less its 8 degree / hemispherical reflectance, which is what a certificate states,
// and scaled so that s(0, 0) - s(60, 0) = 1: droop is how much less of 1 is left at 60 degrees of incidence than at 0,
// both seen along the normal. The published panel has a droop of kPublishedDroop. The table's scale is uncertain by
// 3-6 %, hence only its shape is used.
#pragma once

namespace calibration {

inline constexpr double kPublishedDroop = 0.156;

// The shape s at angles given by their cosines; cos_phi = 1 when light and viewer are on the same side of the normal.
// Angles beyond 70 degrees count as 70.
double droop_shape(double cos_theta_i, double cos_theta_e, double cos_phi);

}  // namespace calibration
