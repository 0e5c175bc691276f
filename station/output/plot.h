// Plots drawn by gnuplot: sheets of panels with lines and circles, as SVG for pages and as PNG for documents.
//
// Errors: std::runtime_error when gnuplot is missing or draws nothing, or when the disk is full.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace station {

enum class PlotStyle { line, dashed, points };

struct PlotLine {
  std::string title;
  std::vector<std::pair<double, double>> points;
  PlotStyle style = PlotStyle::line;
  int color = 0;  // 1, 2, ... of gnuplot's series; 0: the next one
};

struct PlotCircle {
  double x = 0, y = 0, radius = 1;
  bool filled = true;
};

struct PlotPanel {
  std::string title, x_label, y_label;
  std::vector<PlotLine> lines;
  std::vector<PlotCircle> circles;                   // make the axes equal and hide them
  std::optional<std::pair<double, double>> x_range;  // of the data when left out; y starts at 0
  std::optional<std::pair<double, double>> y_range;
};

struct PlotSheet {
  std::vector<PlotPanel> panels;  // row after row
  int columns = 1;
  int panel_width_px = 680, panel_height_px = 340;
  bool key_outside = true;  // to the right of each panel
};

enum class PlotFormat { svg, png };

// The drawn sheet: as SVG an <svg> element to put into a page, as PNG the bytes of a file.
std::string draw(const PlotSheet& sheet, PlotFormat format);

// One panel of lines as SVG.
std::string line_plot(const std::string& x_label, const std::string& y_label, const std::vector<PlotLine>& lines);

}  // namespace station
