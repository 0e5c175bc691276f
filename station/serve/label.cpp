#include "station/serve/label.h"

#include <qrencode.h>

#include <memory>
#include <stdexcept>

#include "station/documents/number_text.h"
#include "station/output/html.h"

namespace station {
namespace {

constexpr double kWidth_mm = 62, kHeight_mm = 29, kMargin_mm = 4, kCode_mm = 21;  // scanners want four modules free
constexpr std::size_t kLine = 20;                                                 // characters that fit beside the code

// Black modules as squares of one unit, from (0, 0).
std::string modules_of(const QRcode& code) {
  std::string path;
  for (int row = 0; row < code.width; ++row)
    for (int column = 0; column < code.width; ++column)
      if ((code.data[row * code.width + column] & 1) != 0)
        path += "M" + std::to_string(column) + " " + std::to_string(row) + "h1v1h-1z";
  return path;
}

// The first characters of a UTF-8 text.
std::string shortened(const std::string& text) {
  std::size_t bytes = 0, characters = 0;
  for (; bytes < text.size(); ++bytes)
    if ((static_cast<unsigned char>(text[bytes]) & 0xC0U) != 0x80U && ++characters > kLine) break;
  return text.substr(0, bytes);
}

}  // namespace

std::string label_svg(const LibraryThread& thread) {
  const Sample& sample = thread.sample;
  const std::string held = sample.barcode.empty() ? "thread-" + std::to_string(thread.number) : sample.barcode;
  const std::unique_ptr<QRcode, void (*)(QRcode*)> code(QRcode_encodeString8bit(held.c_str(), 0, QR_ECLEVEL_M),
                                                        QRcode_free);
  if (!code) throw std::runtime_error("no QR code can hold the barcode \"" + held.substr(0, 60) + "\"; shorten it");
  const std::string scale = formatted("%.4f", kCode_mm / code->width);
  std::string svg = formatted(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0fmm\" height=\"%.0fmm\" viewBox=\"0 0 %.0f %.0f\">"
      "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>",
      kWidth_mm, kHeight_mm, kWidth_mm, kHeight_mm);
  svg += formatted("<g transform=\"translate(%.1f %.1f) scale(", kMargin_mm, kMargin_mm) + scale + ")\"><path d=\"" +
         modules_of(*code) + "\"/></g><g font-family=\"sans-serif\" font-size=\"3\">";
  double y = 6;
  const auto line = [&](const std::string& words, bool strong) {
    if (words.empty()) return;
    svg += formatted("<text x=\"%.1f\" y=\"%.1f\"%s>", 2 * kMargin_mm + kCode_mm, y,
                     strong ? " font-weight=\"bold\" font-size=\"3.6\"" : "") +
           escaped(shortened(words)) + "</text>";
    y += 4;
  };
  line(sample.name.empty() ? thread.thread_name : sample.name, true);
  line(sample.lot.empty() ? "" : "lot " + sample.lot, false);
  line(sample.material + (sample.material.empty() || sample.colour.empty() ? "" : ", ") + sample.colour, false);
  line(number_text(thread.diameter_mm, 2) + " mm, no. " + std::to_string(thread.number), false);
  line(thread.added_utc.substr(0, 10), false);
  line(held, false);
  return svg + "</g></svg>\n";
}

}  // namespace station
