#include "station/serve/result_document.h"

#include <Eigen/Dense>
#include <algorithm>
#include <map>

#include "calibration/light/colour_chart.h"
#include "inversion/fit/energy_bands.h"
#include "station/cloth/preview/cloth_preview.h"
#include "station/documents/matrix_rows.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/srgb.h"
#include "station/session/results.h"
#include "station/thread/invert/invert_session.h"
#include "station/thread/thread_colour.h"

namespace station {
namespace {

using nlohmann::json;

constexpr int kCosines = 40;

// The covariance of the unknowns; nothing where the file has none of this model's size.
std::optional<Eigen::MatrixXd> covariance_of(const ThreadFile& thread) {
  constexpr auto kSize = static_cast<std::size_t>(renderer::kThreadParameterCount);
  try {
    const json& rows = thread.fit.at("certainty").at("covariance");
    if (rows.size() != kSize) return std::nullopt;
    Eigen::MatrixXd covariance(kSize, kSize);
    for (std::size_t row = 0; row < kSize; ++row)
      for (std::size_t column = 0; column < kSize; ++column)
        covariance(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
            rows.at(row).at(column).get<double>();
    return covariance;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

json colour_of_linear_srgb(const Eigen::Vector3d& linear) {
  constexpr double kSeen = 0.002;  // less than a step of a screen's eight bits
  const Eigen::Vector3d lab = calibration::lab_of_linear_srgb(linear);
  return {{"srgb", hex_text(srgb_of_linear(linear))},
          {"lab", {lab[0], lab[1], lab[2]}},
          {"clipped", linear.minCoeff() < -kSeen || linear.maxCoeff() > 1 + kSeen}};
}

json colour_document(const Eigen::Vector3d& camera, const std::array<double, 9>& linear_srgb_from_camera) {
  return colour_of_linear_srgb(matrix_of(linear_srgb_from_camera) * camera);
}

Eigen::Vector3d lab_of(const json& document) {
  const json& values = document.at("colour").at("lab");
  return Eigen::Vector3d(values.at(0), values.at(1), values.at(2));
}

json part_of(const json& fit, const char* key) {
  const auto found = fit.find(key);
  return found == fit.end() ? json::array() : *found;
}

json unknowns_of_fit(const ThreadFile& thread) {
  json unknowns = json::array();
  const auto certainty = thread.fit.find("certainty");
  if (certainty == thread.fit.end()) return unknowns;
  for (const json& one : part_of(*certainty, "unknowns"))
    unknowns.push_back({{"name", one.at("name")},
                        {"value", one.at("value")},
                        {"sigma", one.at("sigma")},
                        {"at_bound", one.at("at_bound")}});
  return unknowns;
}

}  // namespace

json thread_document(const ThreadFile& thread) {
  std::vector<double> cosines;
  for (int i = 0; i <= kCosines; ++i) cosines.push_back(static_cast<double>(i) / kCosines);
  const auto covariance = covariance_of(thread);
  Eigen::VectorXd unknowns = inversion::tinted_unknowns_of(thread.parameters);
  if (!covariance || covariance->rows() != unknowns.size()) unknowns = inversion::unknowns_of(thread.parameters);
  const auto bands = inversion::energy_bands(
      unknowns, covariance.value_or(Eigen::MatrixXd::Zero(unknowns.size(), unknowns.size())), cosines);
  json curves = json::array();
  for (const inversion::EnergyBand& band : bands) {
    curves.push_back({{"cosine", band.cosine}, {"lambda", band.lambda}});
    if (covariance) curves.back()["sigma"] = band.sigma;
  }
  json views = json::array();
  for (const json& view : part_of(thread.fit, "views"))
    views.push_back({{"id", view.at("id")},
                     {"relative_rmse", view.at("relative_rmse")},
                     {"relative_bias", view.at("relative_bias")},
                     {"held_out", view.value("held_out", false)}});
  const ThreadColour thread_colour = colour_of(thread);
  json colour = colour_of_linear_srgb(thread_colour.linear_srgb);
  colour["of"] = thread_colour.photographed ? "views" : "model";
  return {{"name", thread.name},
          {"diameter_mm", thread.diameter_mm},
          {"relative_rmse", thread.fit.value("relative_rmse", json())},
          {"unknowns", unknowns_of_fit(thread)},
          {"curves", curves},
          {"views", views},
          {"doubts", part_of(thread.fit, "doubts")},
          {"colour", colour}};
}

json result_document(const std::filesystem::path& session) {
  const ThreadFile thread = read_thread(thread_file_of(session));
  json document = thread_document(thread);
  document["cloth"] = json::array();
  for (const std::filesystem::path& picture : cloth_pictures(session)) {
    std::error_code error;
    document["cloth"].push_back(
        {{"name", picture.stem().string()},
         {"made", std::filesystem::last_write_time(picture, error).time_since_epoch().count()}});
  }
  const json made_of = cloth_made_of(session);
  document["cloth_made_of"] = made_of;
  if (made_of.is_object() && made_of.contains("reflectance")) {
    const json& mean = made_of["reflectance"];
    json woven;
    woven["colour"] =
        colour_document(Eigen::Vector3d(mean.at(0), mean.at(1), mean.at(2)), thread.linear_srgb_from_camera);
    document["cloth_colour"] = woven["colour"];
    document["cloth_delta_e_2000"] = colour_difference(document, woven);
  }
  return document;
}

json lots_document(const Library& library) {
  std::map<std::string, std::vector<LibraryThread>> lots;
  for (const LibraryThread& thread : library.list())
    if (!thread.sample.lot.empty()) lots[thread.sample.lot].push_back(thread);
  json document = json::array();
  for (const auto& [lot, threads] : lots) {
    if (threads.size() < 2) continue;
    json numbers = json::array();
    std::map<std::string, std::vector<Eigen::Vector3d>> labs_of;  // by what the colours are of
    double thinnest = threads.front().diameter_mm, thickest = thinnest;
    for (const LibraryThread& thread : threads) {
      numbers.push_back(thread.number);
      const json of = thread_document(read_thread(library.thread_file(thread.number)));
      labs_of[of.at("colour").at("of").get<std::string>()].push_back(lab_of(of));
      thinnest = std::min(thinnest, thread.diameter_mm), thickest = std::max(thickest, thread.diameter_mm);
    }
    const auto photographed = labs_of.find("views");
    const std::vector<Eigen::Vector3d>& labs =
        photographed == labs_of.end() ? labs_of.begin()->second : photographed->second;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& lab : labs) mean += lab / static_cast<double>(labs.size());
    double sum = 0, largest = 0;
    for (const Eigen::Vector3d& lab : labs) {
      const double off = calibration::delta_e_2000(lab, mean);
      sum += off, largest = std::max(largest, off);
    }
    document.push_back({{"lot", lot},
                        {"numbers", numbers},
                        {"colour", colour_of_linear_srgb(calibration::linear_srgb_of_lab(mean))},
                        {"mean_delta_e_2000", sum / static_cast<double>(labs.size())},
                        {"largest_delta_e_2000", largest},
                        {"diameter_mm", {thinnest, thickest}}});
  }
  return document;
}

double colour_difference(const json& document, const json& other) {
  return calibration::delta_e_2000(lab_of(document), lab_of(other));
}

}  // namespace station
