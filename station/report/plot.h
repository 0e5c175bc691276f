// Line plots as SVG, drawn by gnuplot.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace station {

struct PlotLine {
  std::string title;
  std::vector<std::pair<double, double>> points;
};

// An <svg> element to put into a page. Errors: std::runtime_error when gnuplot is missing or draws nothing, or when the
// disk is full.
std::string line_plot(const std::string& x_label, const std::string& y_label, const std::vector<PlotLine>& lines);

}  // namespace station
