// What a figure or table of the paper [Xia 2025] is made of here: the commands that make it, which of their pictures
// and numbers are shown, and what is said of both. A file for each in DATA/figures (kind "figure"; keys in its README).
//
// Errors: those of reader.h.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace station {

inline constexpr const char* kData = "DATA/";  // what stands for the folder of what comes with the program

struct FigurePicture {
  std::filesystem::path file;  // from the figure's folder; "../figure-6/..." of another
  std::string caption;
  std::filesystem::path given{};  // what it is a copy of, in the folder of what comes with the program; empty: none
};

struct FigureNumber {
  std::string name, unit, paper;  // `paper`: what the paper says of it; may be empty
  std::filesystem::path file;     // JSON, from the figure's folder, or what a step has said
  std::string at;                 // a JSON pointer; the mean over all elements where a part of it is *
  double scale = 1;
  int digits = 1;
  // What --quick has printed, and how far another run may be from it.
  std::optional<double> stored, within;
};

struct Figure {
  std::string id, title;                         // "8", "Skirts in four weaves"
  std::string paper;                             // what the paper shows
  std::string different;                         // what is different here, and why
  std::vector<std::string> needs;                // other figures that are made before
  std::vector<std::vector<std::string>> steps;   // arguments of threadstation each, run in the figure's folder
  std::vector<std::vector<FigurePicture>> rows;  // as they lie on the page
  std::vector<FigureNumber> numbers;
};

// The file of step `number`, counted from 1, in the figure's folder with what it has said.
std::filesystem::path said_by_step(std::size_t number);

// All figures that there are, in the order of the paper; `quick`: with the options that make them soon.
std::vector<Figure> read_figures(const std::filesystem::path& data_folder, bool quick);

}  // namespace station
