// What a technician should know before trusting a fitted thread: one line for each thing that is wrong or uncertain, with
// what was found and what to do. Empty for a fit without doubt.
//
//   doubt               | found by
//   saturated view      | many pixels as bright as the brightest
//   near black          | threads that return hardly any of what a white diffuser would
//   bad view            | its robust weight (robust_weights.h)
//   brightness per view | views too bright and too dark by more than a thread does: lamp, geometry, wrong mask
//   coloured highlights | reflections whose colour the model cannot have: metallic threads
//   badly explained     | relative RMSE over all views
//   undetermined        | directions of the unknowns that the views do not tell apart
#pragma once

#include <string>
#include <vector>

#include "inversion/agreement.h"
#include "inversion/fit_views.h"

namespace inversion {

// agreements: of each view with the fitted thread (agreement.h).
std::vector<std::string> fit_doubts(const std::vector<View>& views, const ViewFit& fit,
                                    const std::vector<ViewAgreement>& agreements);

// Share of the masked pixels within half a percent of their brightest value in any channel.
double saturated_share(const View& view);

}  // namespace inversion
