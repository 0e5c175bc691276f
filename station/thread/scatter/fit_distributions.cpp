#include "station/thread/scatter/fit_distributions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "renderer/scattering/lobes.h"
#include "station/documents/degree.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

using nlohmann::json;
using renderer::AzimuthalData;
using renderer::AzimuthalFit;

std::vector<AzimuthalData> data_of(const std::vector<Distribution>& all, const std::vector<std::size_t>& members) {
  std::vector<AzimuthalData> data;
  for (std::size_t member : members) data.push_back(all[member].data);
  return data;
}

// Shows what is fitted now and stops at ctrl-C.
class Steps {
 public:
  Steps(std::size_t total, ProgressStyle style) : total_(static_cast<int>(total)), display_("fit", style) {
    watch_interrupts();
  }
  void next(const std::string& label) {
    if (interrupted()) throw std::runtime_error("the fit was stopped on request; start it again");
    display_.show(done_++, total_, label);
  }

 private:
  int total_, done_ = 0;
  ProgressDisplay display_;
};

JointFits joint_fits(const std::vector<Distribution>& all, const std::vector<std::size_t>& members) {
  const std::vector<AzimuthalData> data = data_of(all, members);
  return {members, renderer::fit_thread_jointly(data), renderer::fit_yarn(data, all.front().radius_ratio)};
}

json quality(const AzimuthalFit& fit) {
  json unknowns = json::array(), weak = json::array();
  for (const renderer::FittedValue& value : fit.values)
    unknowns.push_back({{"name", value.name},
                        {"value", value.value},
                        {"standard_deviation", value.deviation},
                        {"at_bound", value.at_bound}});
  for (const renderer::WeakDirection& direction : fit.weak) {
    json parts = json::object();
    for (const auto& [name, part] : direction.parts) parts[name] = part;
    weak.push_back({{"standard_deviation", direction.deviation}, {"direction", parts}});
  }
  return {{"relative_l2_error", fit.error},
          {"converged", fit.converged},
          {"unknowns", unknowns},
          {"not_identifiable", weak}};
}

json thread_json(const renderer::ThreadParameters& p) {
  return {{"beta", p.beta}, {"r0", {p.r0a, p.r0b, p.r0c}}, {"r1", {p.r1a}}, {"r2", {p.r2a, p.r2b, p.r2c}}};
}

json yarn_json(const renderer::YarnFit& fit) {
  json document = quality(fit);
  document["fiber_count"] = fit.parameters.fiber_count;
  document["radius_ratio"] = fit.parameters.radius_ratio;
  document["eta"] = fit.parameters.eta;
  document["gamma_tt"] = fit.parameters.gamma_tt;
  document["sigma_a_per_yarn_radius"] = fit.sigma_a;
  return document;
}

json joint_json(const JointFits& fits, const std::vector<Distribution>& all) {
  json thread = quality(fits.thread);
  thread["parameters"] = thread_json(fits.thread.parameters);
  thread["sigma_a_per_thread_radius"] = fits.thread.sigma_a;
  json files = json::array();
  for (std::size_t member : fits.members) files.push_back(all[member].source);
  return {{"in", files},
          {"absorptions_per_fiber_radius", fits.thread.absorptions},
          {"relative_l2_errors", {{"thread", fits.thread.errors}, {"yarn", fits.yarn.errors}}},
          {"thread", thread},
          {"yarn", yarn_json(fits.yarn)}};
}

void check_same_thread(const std::vector<Distribution>& distributions) {
  const Distribution& first = distributions.front();
  for (const Distribution& d : distributions) {
    if (std::abs(d.radius_ratio - first.radius_ratio) > 1e-9 * first.radius_ratio || d.data.eta != first.data.eta)
      throw std::runtime_error(d.source + " has other fibers (radius ratio " + formatted("%g", d.radius_ratio) +
                               ", eta " + formatted("%g", d.data.eta) + ") than " + first.source + " (" +
                               formatted("%g", first.radius_ratio) + ", " + formatted("%g", first.data.eta) +
                               "); joint fits need one thread, fit them in two runs");
    if (!(d.data.density.maxCoeff() > 0)) throw std::runtime_error(d.source + ": no light left; nothing to fit");
  }
}

}  // namespace

DistributionFits fit_distributions(std::vector<Distribution> distributions, ProgressStyle progress) {
  DistributionFits fits;
  fits.distributions = std::move(distributions);
  std::map<double, std::vector<std::size_t>> groups;
  std::vector<std::size_t> everything;
  for (std::size_t i = 0; i < fits.distributions.size(); ++i) {
    groups[fits.distributions[i].data.absorption].push_back(i);
    everything.push_back(i);
  }
  Steps steps(everything.size() + groups.size() + (groups.size() > 1 ? 1 : 0), progress);
  for (const Distribution& d : fits.distributions) {
    steps.next("theta " + formatted("%g deg", d.data.theta_rad / kDegree));
    fits.separate.push_back({renderer::fit_thread_separately(d.data), renderer::fit_yarn({d.data}, d.radius_ratio),
                             renderer::fit_forward_and_uniform(d.data)});
  }
  for (const auto& [absorption, members] : groups) {
    steps.next("jointly, absorption " + formatted("%g", absorption));
    if (members.size() > 1) fits.by_absorption.push_back(joint_fits(fits.distributions, members));
  }
  if (groups.size() > 1) {
    steps.next("jointly over absorptions");
    fits.over_all.push_back(joint_fits(fits.distributions, everything));
  }
  return fits;
}

DistributionFits fit_files(const FitRequest& request) {
  std::vector<Distribution> distributions;
  for (const std::filesystem::path& file : request.in) distributions.push_back(read_distribution(file));
  check_same_thread(distributions);
  DistributionFits fits = fit_distributions(std::move(distributions), request.progress);
  write_json_file(request.out, to_json(fits));
  return fits;
}

json to_json(const DistributionFits& fits) {
  json distributions = json::array(), by_absorption = json::array();
  for (std::size_t i = 0; i < fits.distributions.size(); ++i) {
    const Distribution& d = fits.distributions[i];
    const SeparateFits& s = fits.separate[i];
    json thread = quality(s.thread);
    thread["beta"] = s.thread.beta;
    thread["lambda"] = s.thread.lambda;
    thread["sigma_a_per_thread_radius"] = s.thread.sigma_a;
    distributions.push_back({{"in", d.source},
                             {"theta_deg", d.data.theta_rad / kDegree},
                             {"absorption_per_fiber_radius", d.data.absorption},
                             {"thread", thread},
                             {"yarn", yarn_json(s.yarn)},
                             {"forward_and_uniform", quality(s.forward_and_uniform)}});
  }
  for (const JointFits& joint : fits.by_absorption) by_absorption.push_back(joint_json(joint, fits.distributions));
  json document{{"format", "threadstation/scatter_fit"},
                {"version", 1},
                {"software", software_version()},
                {"radius_ratio", fits.distributions.front().radius_ratio},
                {"eta", fits.distributions.front().data.eta},
                {"separate", distributions},
                {"joint", by_absorption}};
  if (!fits.over_all.empty())
    document["joint_over_absorptions"] = joint_json(fits.over_all.front(), fits.distributions);
  return document;
}

std::string error_table(const DistributionFits& fits) {
  constexpr double kNone = -1;
  const auto cell = [](double error) {
    return error == kNone ? std::string("       -") : formatted(" %7.2f", 100 * error);
  };
  const auto joint_error = [](const std::vector<JointFits>& joints, std::size_t i, bool thread) {
    for (const JointFits& joint : joints) {
      const auto at = std::find(joint.members.begin(), joint.members.end(), i);
      if (at == joint.members.end()) continue;
      const AzimuthalFit& fit = thread ? static_cast<const AzimuthalFit&>(joint.thread) : joint.yarn;
      return fit.errors[static_cast<std::size_t>(at - joint.members.begin())];
    }
    return kNone;
  };
  std::string table =
      "relative L2 errors in percent; yarn: reconstruction in the manner of Zhu et al. 2023; bound: a free forward\n"
      "lobe and a uniform rest at each angle\n"
      "                  |        thread model        |    yarn reconstruction     |\n"
      " theta absorption | separate   joint  all abs. | separate   joint  all abs. |   bound\n";
  for (std::size_t i = 0; i < fits.distributions.size(); ++i) {
    const AzimuthalData& d = fits.distributions[i].data;
    const SeparateFits& s = fits.separate[i];
    table += formatted("%6.1f", d.theta_rad / kDegree) + formatted(" %10.4g |", d.absorption) + " " +
             cell(s.thread.error) + cell(joint_error(fits.by_absorption, i, true)) + "  " +
             cell(joint_error(fits.over_all, i, true)) + " | " + cell(s.yarn.error) +
             cell(joint_error(fits.by_absorption, i, false)) + "  " + cell(joint_error(fits.over_all, i, false)) +
             " |" + cell(s.forward_and_uniform.error) + "\n";
  }
  for (const JointFits& joint : fits.by_absorption)
    table += "jointly over angles, absorption " + formatted("%g", joint.thread.absorptions.front()) + ": thread" +
             formatted(" %.2f %%", 100 * joint.thread.error) + ", yarn" +
             formatted(" %.2f %%", 100 * joint.yarn.error) + " with " +
             std::to_string(joint.yarn.parameters.fiber_count) + " fibers\n";
  for (const JointFits& joint : fits.over_all) {
    table += "jointly over " + std::to_string(joint.thread.absorptions.size()) + " absorptions: thread" +
             formatted(" %.2f %%", 100 * joint.thread.error) + ", yarn" +
             formatted(" %.2f %%", 100 * joint.yarn.error) + " with " +
             std::to_string(joint.yarn.parameters.fiber_count) + " fibers; sigma_a of the thread";
    for (double sigma : joint.thread.sigma_a) table += formatted(" %.3f", sigma);
    table += " per thread radius\n";
  }
  return table;
}

}  // namespace station
