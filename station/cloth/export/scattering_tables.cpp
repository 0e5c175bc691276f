#include "station/cloth/export/scattering_tables.h"

#include <cstdio>
#include <xtensor/xadapt.hpp>
#include <xtensor/xnpy.hpp>

#include "renderer/scattering/thread.h"
#include "station/documents/degree.h"
#include "station/thread/scatter/queries.h"

namespace station {
namespace {

using renderer::Rgb;
constexpr int kMeanOffsets = 64;

std::vector<double> steps_deg(double first, double step, int count) {
  std::vector<double> angles_rad;
  for (int i = 0; i < count; ++i) angles_rad.push_back((first + step * i) * kDegree);
  return angles_rad;
}

std::vector<double> offsets(int count) {
  std::vector<double> h;
  for (int i = 0; i < count; ++i) h.push_back(-1 + 2 * (i + 0.5) / count);
  return h;
}

// The mean over `h` of f_cos in one direction; the single values are also put into `each` where there is one.
Rgb<double> values(const std::vector<renderer::CurveLobes<double>>& lobes, const renderer::Vec3<double>& wi,
                   std::vector<double>* each) {
  Rgb<double> sum = Rgb<double>::Zero();
  for (const auto& at : lobes) {
    const Rgb<double> f_cos = at.evaluate(wi).f_cos;
    sum += f_cos;
    if (each) each->insert(each->end(), f_cos.begin(), f_cos.end());
  }
  return sum / static_cast<double>(lobes.size());
}

std::vector<renderer::CurveLobes<double>> lobes_at(const renderer::ThreadModel<double>& model,
                                                   const std::vector<double>& h, double theta_o_rad) {
  std::vector<renderer::CurveLobes<double>> lobes;
  for (double offset : h) lobes.push_back(model.lobes_at(offset, scattering_place(offset, 0, theta_o_rad, 0).wo));
  return lobes;
}

class Lines {
 public:
  template <class... Numbers>
  void add(const char* format, Numbers... numbers) {
    char line[256];
    std::snprintf(line, sizeof line, format, numbers...);
    text_ += line;
  }
  void add_text(const char* text) { text_ += text; }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

std::string npy(const std::vector<double>& values, const std::vector<std::size_t>& shape) {
  return xt::dump_npy(xt::adapt(values, shape));
}

}  // namespace

ScatteringTables scattering_tables(const renderer::ThreadParameters& thread) {
  ScatteringTables tables{.theta_o_rad = steps_deg(0, 10, 9),
                          .theta_i_rad = steps_deg(-90, 5, 37),
                          .phi_rad = steps_deg(0, 10, 36),
                          .h = offsets(8)};
  const renderer::ThreadModel<double> model(thread);
  for (double theta_o : tables.theta_o_rad) {
    const auto lobes = lobes_at(model, tables.h, theta_o), many = lobes_at(model, offsets(kMeanOffsets), theta_o);
    for (double theta_i : tables.theta_i_rad)
      for (double phi : tables.phi_rad) {
        const renderer::Vec3<double> wi = scattering_place(0, theta_i, theta_o, phi).wi;
        values(lobes, wi, &tables.f_cos);
        const Rgb<double> mean = values(many, wi, nullptr);
        tables.f_cos_mean.insert(tables.f_cos_mean.end(), mean.begin(), mean.end());
      }
  }
  return tables;
}

std::string scattering_csv(const ScatteringTables& tables) {
  Lines lines;
  lines.add_text("h,theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad,f_cos_r,f_cos_g,f_cos_b\n");
  const double* f = tables.f_cos.data();
  for (double theta_o : tables.theta_o_rad)
    for (double theta_i : tables.theta_i_rad)
      for (double phi : tables.phi_rad)
        for (double h : tables.h) {
          lines.add("%.9g,%.9g,%.9g,%.9g,0,%.9g,%.9g,%.9g\n", h, theta_i, phi, theta_o, f[0], f[1], f[2]);
          f += 3;
        }
  return lines.take();
}

std::string mean_scattering_csv(const ScatteringTables& tables) {
  Lines lines;
  lines.add_text("theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad,f_cos_r,f_cos_g,f_cos_b\n");
  const double* f = tables.f_cos_mean.data();
  for (double theta_o : tables.theta_o_rad)
    for (double theta_i : tables.theta_i_rad)
      for (double phi : tables.phi_rad) {
        lines.add("%.9g,%.9g,%.9g,0,%.9g,%.9g,%.9g\n", theta_i, phi, theta_o, f[0], f[1], f[2]);
        f += 3;
      }
  return lines.take();
}

std::vector<NamedBytes> scattering_arrays(const ScatteringTables& tables) {
  const std::size_t o = tables.theta_o_rad.size(), i = tables.theta_i_rad.size(), p = tables.phi_rad.size(),
                    h = tables.h.size();
  return {{"f_cos.npy", npy(tables.f_cos, {o, i, p, h, 3})}, {"f_cos_mean.npy", npy(tables.f_cos_mean, {o, i, p, 3})},
          {"theta_o_rad.npy", npy(tables.theta_o_rad, {o})}, {"theta_i_rad.npy", npy(tables.theta_i_rad, {i})},
          {"phi_rad.npy", npy(tables.phi_rad, {p})},         {"h.npy", npy(tables.h, {h})}};
}

}  // namespace station
