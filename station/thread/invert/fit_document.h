// The report of a fit as JSON: solver, rounds, agreement view by view, unknowns with their covariance, bands of the
// thread's energies. Keys in station/data/threads/README.md.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "inversion/fit/view_fit.h"
#include "inversion/view/agreement.h"

namespace station {

struct FittedView {
  std::string id;
  bool transmission = false, held_out = false;  // held out: the fit has not seen it
  inversion::ViewAgreement agreement;
};

std::map<std::string, inversion::ModelKind> names_of_models();  // by the words of the command line
std::string name_of(inversion::ModelKind model);
std::string name_of(inversion::Solver solver);

// The agreements of the views that were fitted, or of those that were held out.
std::vector<inversion::ViewAgreement> agreements_of(const std::vector<FittedView>& views, bool held_out);

// Makes the report; `samples_per_pixel` is that of the renderings that `views` compares with the photographs.
nlohmann::json fit_document(const inversion::ViewFit& fit, const inversion::FitOptions& options,
                            const std::vector<FittedView>& views, int samples_per_pixel);

}  // namespace station
