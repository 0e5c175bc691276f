#include "station/session/results.h"

#include <algorithm>
#include <array>
#include <system_error>

#include "station/documents/reader.h"

namespace station {
namespace {

constexpr std::array<const char*, 7> kClothPictures{"swatch", "cylinder", "skirt", "pleats", "drape", "sari", "mesh"};

}  // namespace

std::filesystem::path results_of(const std::filesystem::path& session, const std::string& model) {
  return model == "thread" ? session / "result" : session / "result" / model;
}

std::string shown_model(const std::string& model) {
  return model == "yarn" ? "yarn reconstruction" : model;
}

std::filesystem::path baseline_fit_of(const std::filesystem::path& session, const std::string& model) {
  return results_of(session, model) / "fit.json";
}

std::filesystem::path model_file_of(const std::filesystem::path& session, const std::string& model) {
  return results_of(session, model) / (model + ".json");
}

std::filesystem::path thread_file_of(const std::filesystem::path& session) {
  return model_file_of(session, "thread");
}

std::filesystem::path fitted_file_of(const std::filesystem::path& session, const std::string& view,
                                     const std::string& model) {
  return results_of(session, model) / "fitted" / (view + ".exr");
}

bool is_made(const std::filesystem::path& file, const std::vector<std::filesystem::path>& from) {
  std::error_code error;
  const auto made = std::filesystem::last_write_time(file, error);
  if (error) return false;
  return std::ranges::none_of(from, [&](const std::filesystem::path& one) {
    const auto time = std::filesystem::last_write_time(one, error);
    return !error && time > made;
  });
}

std::filesystem::path cloth_folder(const std::filesystem::path& session) {
  return session / "result" / "cloth";
}

std::filesystem::path cloth_made_of_file(const std::filesystem::path& session) {
  return cloth_folder(session) / kMadeOf;
}

nlohmann::json cloth_made_of(const std::filesystem::path& session) {
  const std::filesystem::path file = cloth_made_of_file(session);
  return std::filesystem::exists(file) ? read_json_file(file) : nlohmann::json();
}

std::vector<std::filesystem::path> pictures_of_cloth(const std::filesystem::path& cloth) {
  std::vector<std::filesystem::path> pictures;
  for (const std::string name : kClothPictures) {
    const std::filesystem::path file = cloth / (name + ".exr");
    if (std::filesystem::exists(file)) pictures.push_back(file);
  }
  return pictures;
}

std::vector<std::filesystem::path> cloth_pictures(const std::filesystem::path& session) {
  return pictures_of_cloth(cloth_folder(session));
}

}  // namespace station
