// The doubts about a fitted thread that a technician should know before trusting it: one line for each thing that is
// wrong or uncertain, with what was found and what to do. A fit without doubt has none.
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

#include "inversion/fit/view_fit.h"
#include "inversion/view/agreement.h"

namespace inversion {

// The doubts about a fit; `agreements` are those of each view with the fitted thread (agreement.h).
std::vector<std::string> fit_doubts(const std::vector<View>& views, const ViewFit& fit,
                                    const std::vector<ViewAgreement>& agreements);

// The share of the masked pixels that are within half a percent of their brightest value in any channel.
double saturated_share(const View& view);

}  // namespace inversion
