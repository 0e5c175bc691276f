// A digitized thread as the result and library screens show it: its unknowns with their deviations, the energies of its
// lobes over the angle with bands from the covariance, agreement view by view, colour.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "station/documents/thread_file.h"
#include "station/thread/library.h"

namespace station {

// {"name", "diameter_mm", "relative_rmse" (null: unknown),
//  "unknowns": [{"name", "value", "sigma", "at_bound"}],
//  "curves": [{"cosine", "lambda": [R, TT, TRT], "sigma" (absent where the file has no covariance)}],
//  "views": [{"id", "relative_rmse", "relative_bias", "held_out"}],
//  "doubts", "colour": {"srgb": "#rrggbb", "lab": CIE 1976, D50, "clipped": whether sRGB cannot show it, "of": "views",
//  the mean of the photographs with light from the front over a white card in the same light, or "model" where none is
//  known, the albedo under light from all sides}}
nlohmann::json thread_document(const ThreadFile& thread);

// The thread of a session's result, and "cloth": what of its preview is there, with what it was made of; where that is
// known "cloth_colour" of the swatch, over a white card in its place, and its CIEDE2000 to the thread's,
// "cloth_delta_e_2000".
nlohmann::json result_document(const std::filesystem::path& session);

// What the threads of each lot have in common, of lots with two threads or more, in the order of their names: {"lot",
// "numbers", "colour": of the mean (Lab) of their colours, "mean_delta_e_2000", "largest_delta_e_2000": of each from
// it, "diameter_mm": [least, most]}. Where some were photographed, colours are of these alone. Errors: those of
// read_thread.
nlohmann::json lots_document(const Library& library);

// CIEDE2000 between the "colour" of two such documents.
double colour_difference(const nlohmann::json& document, const nlohmann::json& other);

}  // namespace station
