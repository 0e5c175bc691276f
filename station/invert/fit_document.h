// What a fit says of itself, as JSON: solver, rounds, agreement view by view, unknowns with their covariance, bands of the
// thread's energies. Keys in fixtures/threads/README.md.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "inversion/agreement.h"
#include "inversion/fit_views.h"

namespace station {

struct FittedView {
  std::string id;
  bool transmission = false;
  inversion::ViewAgreement agreement;
};

std::map<std::string, inversion::ModelKind> names_of_models();  // as on the command line
std::string name_of(inversion::ModelKind model);
std::string name_of(inversion::Solver solver);

nlohmann::json fit_document(const inversion::ViewFit& fit, const inversion::FitOptions& options,
                            const std::vector<FittedView>& views, int samples_per_pixel);

}  // namespace station
