#include "station/documents/draft_drawing.h"

#include <array>
#include <cstdio>

namespace station {
namespace {

const std::array<cv::Vec3b, 8> kPalette{{{38, 52, 92},
                                         {236, 224, 196},
                                         {178, 44, 50},
                                         {222, 164, 44},
                                         {58, 122, 92},
                                         {120, 72, 140},
                                         {110, 170, 205},
                                         {92, 62, 44}}};
constexpr int kMargin = 2;  // squares: colour order, gap

struct Square {
  int column, row;  // row 0 at the top
  cv::Vec3b color;
};

// The squares that both drawings consist of.
struct Drawing {
  int columns, rows;
  std::vector<Square> squares;
};

Drawing squares_of(const renderer::Draft& draft, const ThreadColours& colours) {
  const int ends = ends_in_patch(draft), picks = picks_in_patch(draft);
  int most = 0;
  for (const auto* system : {&draft.warp, &draft.weft})
    for (const int thread : system->threads) most = std::max(most, thread);
  const auto color = [&](const renderer::YarnSystem& system, int yarn, bool warp) {
    const int thread = system.threads[static_cast<std::size_t>(yarn) % system.threads.size()];
    return thread_color(most == 0 ? (warp ? 0 : 1) : thread, colours);
  };
  Drawing drawing{ends + kMargin, picks + kMargin, {}};
  const auto& rows = draft.warp_over;
  for (int end = 0; end < ends; ++end) drawing.squares.push_back({end + kMargin, 0, color(draft.warp, end, true)});
  for (int pick = 0; pick < picks; ++pick) {
    const int row = picks - 1 - pick + kMargin;
    drawing.squares.push_back({0, row, color(draft.weft, pick, false)});
    const auto& marks = rows[static_cast<std::size_t>(pick) % rows.size()];
    for (int end = 0; end < ends; ++end) {
      const bool warp = marks[static_cast<std::size_t>(end) % marks.size()];
      drawing.squares.push_back(
          {end + kMargin, row, warp ? color(draft.warp, end, true) : color(draft.weft, pick, false)});
    }
  }
  return drawing;
}

}  // namespace

cv::Vec3b thread_color(int thread) {
  return kPalette[static_cast<std::size_t>(thread) % kPalette.size()];
}

cv::Vec3b thread_color(int thread, const ThreadColours& colours) {
  return colours.empty() ? thread_color(thread) : colours[static_cast<std::size_t>(thread) % colours.size()];
}

cv::Mat3b draw_draft(const renderer::Draft& draft, const ThreadColours& colours, int square_px) {
  const Drawing drawing = squares_of(draft, colours);
  cv::Mat3b picture(drawing.rows * square_px, drawing.columns * square_px, cv::Vec3b(255, 255, 255));
  for (const Square& square : drawing.squares)  // a line of the ground stays between squares
    picture(cv::Rect(square.column * square_px, square.row * square_px, square_px - 1, square_px - 1))
        .setTo(square.color);
  return picture;
}

std::string draw_draft_svg(const renderer::Draft& draft, const ThreadColours& colours) {
  const Drawing drawing = squares_of(draft, colours);
  char line[160];
  std::snprintf(line, sizeof line, "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\">\n",
                drawing.columns, drawing.rows);
  std::string svg = line;
  for (const Square& s : drawing.squares) {
    std::snprintf(line, sizeof line,
                  "<rect x=\"%d\" y=\"%d\" width=\"0.95\" height=\"0.95\" fill=\"#%02x%02x%02x\"/>\n", s.column, s.row,
                  s.color[0], s.color[1], s.color[2]);
    svg += line;
  }
  return svg + "</svg>\n";
}

}  // namespace station
