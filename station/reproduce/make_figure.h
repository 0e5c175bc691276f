// A figure is made: its commands are run one after the other, and its numbers looked up.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "station/reproduce/figure_file.h"

namespace station {

struct MadeNumber {
  FigureNumber number;
  std::optional<double> value;  // nothing: the command did not say it
};

struct MadeFigure {
  Figure figure;
  std::vector<MadeNumber> numbers;
  double seconds = 0;   // of its commands, whenever they ran
  std::string problem;  // why it could not be made, one line; empty when it was
};

// The folder of a figure's results.
std::filesystem::path figure_folder(const std::filesystem::path& out, const std::string& id);

// Runs what has not been run yet, with the same words and by this version, in the figure's folder; before each command
// `step` is told of it. Commands keep the file `lock` open, so that nobody else begins while they still write. One that
// fails ends the figure. Errors: std::runtime_error, one line, when a person has
// interrupted: the same again goes on.
MadeFigure make_figure(const Figure& figure, const std::filesystem::path& out, const std::filesystem::path& data_folder,
                       int lock, const std::function<void(const std::string&)>& step);

// What is there of a figure, without running anything; nothing where it has not been made.
std::optional<MadeFigure> made_figure(const Figure& figure, const std::filesystem::path& out);

// A command of a figure as a person would type it.
std::string shown_command(const std::vector<std::string>& words);

}  // namespace station
