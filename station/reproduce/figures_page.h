// The page of all figures that were made, and the same as a document to print.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "station/reproduce/make_figure.h"

namespace station {

struct FiguresPage {
  std::vector<MadeFigure> figures;
  bool quick = false;
  std::string utc;  // when it was written
};

// A number with as many digits as it has here; "not said" where there is none.
std::string shown_number(const MadeNumber& made);

// Write index.html, whose pictures are the files in the figures' folders, and figures.pdf. Errors: std::runtime_error
// for what cannot be written or a picture that cannot be read.
void write_figures_html(const FiguresPage& page, const std::filesystem::path& out);
void write_figures_pdf(const FiguresPage& page, const std::filesystem::path& out);

}  // namespace station
