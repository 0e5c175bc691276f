// Where fits and pictures of cloth lie in a session's folder, for whoever makes them and for whoever shows them.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace station {

// The folder of what a fit of `model` ("thread", "bundle", "fiber", "yarn", "paper") found. Neither it nor any file
// that these functions name needs to be there.
std::filesystem::path results_of(const std::filesystem::path& session, const std::string& model);
// The model's name for people, in tables, plots and reports: the yarn is a reconstruction (renderer/scattering/yarn.h).
std::string shown_model(const std::string& model);
// The report of the fit of a baseline; that of a thread is part of its thread file.
std::filesystem::path baseline_fit_of(const std::filesystem::path& session, const std::string& model);
// The fitted model, and the thread among them.
std::filesystem::path model_file_of(const std::filesystem::path& session, const std::string& model);
std::filesystem::path thread_file_of(const std::filesystem::path& session);
// One view (EXR) as the fitted model gives it.
std::filesystem::path fitted_file_of(const std::filesystem::path& session, const std::string& view,
                                     const std::string& model = "thread");

// Whether a file is there and not older than all that it is made from, as far as that is there.
bool is_made(const std::filesystem::path& file, const std::vector<std::filesystem::path>& from);

// The folder of the cloth that the session's thread weaves into, and the file that says what it is made of.
std::filesystem::path cloth_folder(const std::filesystem::path& session);
std::filesystem::path cloth_made_of_file(const std::filesystem::path& session);

inline constexpr const char* kMadeOf = "made_of.json";  // in a cloth's folder

// {"draft", "model", "threads": [warp's name, weft's], "warp", "weft", "white_card": by picture, the radiance (camera
// RGB) of a white card in the place of the cloth, "views": likewise, how it is seen (cloth_stage.h), "reflectance": the
// mean of the swatch over its card, where it is seen as it stands}; "warp" and "weft" {"srgb": [r, g, b],
// "delta_e_2000": how far the thread's gamut is from it}, or null for the digitized thread's own colour. Of earlier
// versions "threads" may be absent, or what is told of cards and views. Null when there is no preview.
nlohmann::json cloth_made_of(const std::filesystem::path& session);

// The EXR pictures that are in a cloth's folder, swatch first, and those of a session.
std::vector<std::filesystem::path> pictures_of_cloth(const std::filesystem::path& cloth);
std::vector<std::filesystem::path> cloth_pictures(const std::filesystem::path& session);

}  // namespace station
