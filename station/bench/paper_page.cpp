#include "station/bench/paper_page.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "station/documents/reader.h"

namespace station {
namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;
constexpr double kPixelsPerMm = 300.0 / 25.4;

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Pen = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

void require_written(cairo_status_t status, const std::filesystem::path& file) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error("cannot write " + file.string() + ": " + cairo_status_to_string(status) +
                             "; choose a writable folder with --out");
}

void draw_on(const Surface& surface, double units_per_mm, const std::filesystem::path& file, const DrawPage& draw) {
  require_written(cairo_surface_status(surface.get()), file);
  const Pen pen(cairo_create(surface.get()), &cairo_destroy);
  cairo_scale(pen.get(), units_per_mm, units_per_mm);
  cairo_set_source_rgb(pen.get(), 1, 1, 1);
  cairo_paint(pen.get());
  cairo_set_source_rgb(pen.get(), 0, 0, 0);
  draw(pen.get());
  cairo_show_page(pen.get());
  require_written(cairo_status(pen.get()), file);
}

void finish(const Surface& surface, const std::filesystem::path& file) {
  cairo_surface_finish(surface.get());
  require_written(cairo_surface_status(surface.get()), file);
}

}  // namespace

Eigen::Vector2d page_mm(Paper paper) {
  return paper == Paper::a4 ? Eigen::Vector2d(210.0, 297.0) : Eigen::Vector2d(215.9, 279.4);
}

void write_page_pdf(const std::filesystem::path& file, Paper paper, const DrawPage& draw) {
  const Eigen::Vector2d points = page_mm(paper) * kPointsPerMm;
  const Surface surface(cairo_pdf_surface_create(file.c_str(), points.x(), points.y()), &cairo_surface_destroy);
  draw_on(surface, kPointsPerMm, file, draw);
  finish(surface, file);
}

void write_page_svg(const std::filesystem::path& file, Paper paper, const DrawPage& draw) {
  const Eigen::Vector2d size = page_mm(paper);
  const Surface surface(cairo_svg_surface_create(file.c_str(), size.x(), size.y()), &cairo_surface_destroy);
  require_written(cairo_surface_status(surface.get()), file);
  cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_MM);
  draw_on(surface, 1, file, draw);
  finish(surface, file);
}

void write_page_png(const std::filesystem::path& file, Paper paper, const DrawPage& draw) {
  const Eigen::Vector2d pixels = page_mm(paper) * kPixelsPerMm;
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::lround(pixels.x())),
                                                   static_cast<int>(std::lround(pixels.y()))),
                        &cairo_surface_destroy);
  draw_on(surface, kPixelsPerMm, file, draw);
  std::string bytes;
  const auto append = [](void* out, const unsigned char* data, unsigned length) {
    static_cast<std::string*>(out)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
  };
  require_written(cairo_surface_write_to_png_stream(surface.get(), append, &bytes), file);
  // Cairo does not say how large a pixel is; without it a viewer prints at a size of its own. The chunk pHYs, 11811
  // pixels per metre, stands behind the header of 33 bytes; its last four bytes are its checksum.
  constexpr unsigned char kResolution[] = {0,    0, 0, 9,    'p',  'H', 'Y',  's',  0,    0,   0x2E,
                                           0x23, 0, 0, 0x2E, 0x23, 1,   0x78, 0xA5, 0x3F, 0x76};
  bytes.insert(33, reinterpret_cast<const char*>(kResolution), sizeof kResolution);
  write_text_file(file, bytes);
}

void draw_text(cairo_t* pen, double x, double y, double size_mm, const std::string& text) {
  cairo_select_font_face(pen, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(pen, size_mm);
  cairo_move_to(pen, x, y);
  cairo_show_text(pen, text.c_str());
}

}  // namespace station
