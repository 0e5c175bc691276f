// One page of paper drawn in millimetres by cairo: as vectors (PDF, SVG) or as pixels (PNG, 300 dpi).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <string>

typedef struct _cairo cairo_t;  // of cairo.h, which those who draw include

namespace station {

enum class Paper { a4, letter };

Eigen::Vector2d page_mm(Paper paper);

inline constexpr double kPageMargin_mm = 10.0;  // printers leave about 5 mm white

// Draws on a white page; cairo's unit is the millimetre, from the top left corner, y downwards.
using DrawPage = std::function<void(cairo_t* pen)>;

// Each writes one file. Throws std::runtime_error when it cannot be written.
void write_page_pdf(const std::filesystem::path& file, Paper paper, const DrawPage& draw);
void write_page_svg(const std::filesystem::path& file, Paper paper, const DrawPage& draw);
void write_page_png(const std::filesystem::path& file, Paper paper, const DrawPage& draw);

void draw_text(cairo_t* pen, double x, double y, double size_mm, const std::string& text);

}  // namespace station
