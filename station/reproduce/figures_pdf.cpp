// The figures as a PDF by cairo: pages of A4 that are filled from the top.
#include <cairo-pdf.h>

#include <algorithm>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <stdexcept>

#include "renderer/picture/image_file.h"
#include "renderer/picture/jpeg.h"
#include "station/output/display.h"
#include "station/reproduce/figures_page.h"

namespace station {
namespace {

namespace fs = std::filesystem;

constexpr double kPoint_mm = 25.4 / 72, kWidth_mm = 210, kHeight_mm = 297, kMargin_mm = 15;
constexpr double kGap_mm = 2, kText_mm = 3.1, kHeading_mm = 4.6, kLine = 1.35;  // lines in letters' sizes
constexpr int kMostPixels = 900;                                                // across a picture

class PaperRoll {
 public:
  explicit PaperRoll(const fs::path& file)
      : surface_(cairo_pdf_surface_create(file.c_str(), kWidth_mm / kPoint_mm, kHeight_mm / kPoint_mm),
                 cairo_surface_destroy),
        pen_(cairo_create(surface_.get()), cairo_destroy) {
    cairo_scale(pen_.get(), 1 / kPoint_mm, 1 / kPoint_mm);
    cairo_select_font_face(pen_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  }

  void text(const std::string& words, double size_mm = kText_mm, bool bold = false, double indent_mm = 0) {
    cairo_select_font_face(pen_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(pen_.get(), size_mm);
    for (const std::string& line : wrapped(words, kWidth_mm - 2 * kMargin_mm - indent_mm)) {
      need(size_mm * kLine);
      cairo_move_to(pen_.get(), kMargin_mm + indent_mm, y_ + size_mm);
      cairo_show_text(pen_.get(), line.c_str());
      y_ += size_mm * kLine;
    }
  }

  void space(double mm) { y_ += mm; }

  // Pictures side by side, all of the height of the highest, with their captions.
  void pictures(const std::vector<FigurePicture>& row, const fs::path& folder) {
    const auto count = static_cast<double>(row.size());
    const double width = (kWidth_mm - 2 * kMargin_mm - (count - 1) * kGap_mm) / count;
    std::vector<cv::Mat3b> shown;
    double height = 0;
    for (const FigurePicture& picture : row) {
      shown.push_back(pixels_of(folder / picture.file));
      height = std::max(height, width * shown.back().rows / shown.back().cols);
    }
    const double most = (kHeight_mm - 2 * kMargin_mm) * 0.6, scale = std::min(1.0, most / height);
    constexpr double kCaption_mm = 2.2;
    cairo_set_font_size(pen_.get(), kCaption_mm);
    std::size_t lines = 1;
    for (const FigurePicture& picture : row) lines = std::max(lines, wrapped(picture.caption, width).size());
    need(height * scale + static_cast<double>(lines) * kCaption_mm * kLine + kGap_mm);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const double left = kMargin_mm + static_cast<double>(i) * (width + kGap_mm);
      paint(shown[i], left + width * (1 - scale) / 2, y_, width * scale);
      cairo_set_font_size(pen_.get(), kCaption_mm);
      double below = y_ + height * scale + kCaption_mm;
      for (const std::string& line : wrapped(row[i].caption, width)) {
        cairo_move_to(pen_.get(), left, below);
        cairo_show_text(pen_.get(), line.c_str());
        below += kCaption_mm * kLine;
      }
    }
    y_ += height * scale + static_cast<double>(lines) * kCaption_mm * kLine + kGap_mm;
  }

  void finish(const fs::path& file) {
    cairo_show_page(pen_.get());
    cairo_surface_finish(surface_.get());
    if (const cairo_status_t status = cairo_surface_status(surface_.get()); status != CAIRO_STATUS_SUCCESS)
      throw std::runtime_error("cannot write " + file.string() + ": " + cairo_status_to_string(status));
  }

 private:
  void need(double mm) {
    if (y_ + mm <= kHeight_mm - kMargin_mm) return;
    cairo_show_page(pen_.get());
    y_ = kMargin_mm;
  }

  // In the pen's present size.
  std::vector<std::string> wrapped(const std::string& words, double width_mm) {
    std::vector<std::string> lines{""};
    std::istringstream stream(words);
    for (std::string word; stream >> word;) {
      const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
      cairo_text_extents_t extents;
      cairo_text_extents(pen_.get(), longer.c_str(), &extents);
      if (extents.x_advance > width_mm && !lines.back().empty())
        lines.push_back(word);
      else
        lines.back() = longer;
    }
    return lines;
  }

  static cv::Mat3b pixels_of(const fs::path& file) {
    cv::Mat3b picture = renderer::encode_srgb(renderer::read_linear_srgb(file), 1);
    if (picture.cols > kMostPixels)
      cv::resize(picture, picture, {kMostPixels, std::max(1, picture.rows * kMostPixels / picture.cols)}, 0, 0,
                 cv::INTER_AREA);
    return picture;
  }

  // As JPEG in the document; cairo asks for pixels all the same.
  void paint(const cv::Mat3b& rgb, double left, double top, double width_mm) {
    cv::Mat4b bgra;
    cv::cvtColor(rgb, bgra, cv::COLOR_RGB2BGRA);
    const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> image(
        cairo_image_surface_create_for_data(bgra.data, CAIRO_FORMAT_RGB24, bgra.cols, bgra.rows,
                                            static_cast<int>(bgra.step)),
        cairo_surface_destroy);
    auto jpeg = std::make_unique<std::string>(renderer::encode_jpeg(rgb, 88));
    const auto* bytes = reinterpret_cast<const unsigned char*>(jpeg->data());
    const unsigned long size = jpeg->size();
    cairo_surface_set_mime_data(
        image.get(), CAIRO_MIME_TYPE_JPEG, bytes, size, [](void* held) { delete static_cast<std::string*>(held); },
        jpeg.release());
    const double pixel_mm = width_mm / rgb.cols;
    cairo_save(pen_.get());
    cairo_translate(pen_.get(), left, top);
    cairo_scale(pen_.get(), pixel_mm, pixel_mm);
    cairo_set_source_surface(pen_.get(), image.get(), 0, 0);
    cairo_paint(pen_.get());
    cairo_restore(pen_.get());
    cairo_surface_flush(surface_.get());
  }

  std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_;
  std::unique_ptr<cairo_t, void (*)(cairo_t*)> pen_;
  double y_ = kMargin_mm;
};

}  // namespace

void write_figures_pdf(const FiguresPage& page, const fs::path& out) {
  const fs::path file = out / "figures.pdf";
  PaperRoll paper(file);
  paper.text("Figures of Xia et al. 2025, made anew", 6, true);
  paper.text("Everything here is simulated: spools, bench and camera. Made " + page.utc +
             (page.quick ? ", quickly." : "."));
  for (const MadeFigure& made : page.figures) {
    const Figure& figure = made.figure;
    paper.space(4);
    paper.text(figure.id + ": " + figure.title, kHeading_mm, true);
    paper.text("The paper: " + figure.paper);
    paper.space(kGap_mm);
    if (made.problem.empty())
      for (const std::vector<FigurePicture>& row : figure.rows) paper.pictures(row, figure_folder(out, figure.id));
    else
      paper.text("It could not be made: " + made.problem);
    for (const MadeNumber& one : made.numbers)
      paper.text(one.number.name + ": " + shown_number(one) +
                     (one.number.paper.empty() ? "" : "; in the paper " + one.number.paper),
                 kText_mm, false, 4);
    paper.text("Different here: " + figure.different);
    paper.text("threadstation reproduce " + figure.id + (page.quick ? " --quick" : "") + ": " +
                   std::to_string(std::lround(made.seconds)) + " s",
               2.4);
  }
  paper.finish(file);
}

}  // namespace station
