#include "station/output/plot.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <span>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "station/documents/disk/stored_file.h"

namespace station {
namespace {

// A script in a file of its own, removed with the object: gnuplot then answers on its standard output.
class Script {
 public:
  explicit Script(const std::string& text) {
    std::string name = (std::filesystem::temp_directory_path() / "threadstation-plot-XXXXXX").string();
    const OpenFile out(mkstemp(name.data()));
    if (out.descriptor() < 0)
      throw std::runtime_error(write_problem(name, std::error_code(errno, std::generic_category())));
    file_ = name;
    try {
      FileSystem().write(out, std::as_bytes(std::span(text)));
    } catch (const std::system_error& error) {
      std::filesystem::remove(file_, ignored_);
      throw std::runtime_error(write_problem(file_, error.code()));
    }
  }
  ~Script() { std::filesystem::remove(file_, ignored_); }
  Script(const Script&) = delete;
  Script& operator=(const Script&) = delete;
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::error_code ignored_;
};

// In single quotes nothing but the quote itself is special to gnuplot.
std::string quoted(const std::string& text) {
  std::string all = "'";
  for (char c : text) all += c == '\'' ? std::string("''") : std::string(1, c);
  return all + "'";
}

void set_range(std::ostream& script, char axis, const std::optional<std::pair<double, double>>& range,
               const char* otherwise) {
  script << "set " << axis << "range ";
  if (range)
    script << '[' << range->first << ':' << range->second << "]\n";
  else
    script << otherwise << '\n';
}

// Data blocks are named by panel and line.
void add_panel(std::ostream& script, const PlotPanel& panel, std::size_t number) {
  const bool drawing = !panel.circles.empty();
  script << "set title " << quoted(panel.title) << "\nset xlabel " << quoted(panel.x_label) << "\nset ylabel "
         << quoted(panel.y_label) << '\n'
         << (drawing ? "unset border\nunset tics\nunset grid\nset size ratio -1\n"
                     : "set border\nset tics\nset grid lc rgb '#dddddd'\nset size noratio\n");
  double reach = 0;  // of the circles
  for (const PlotCircle& c : panel.circles) reach = std::max(reach, c.radius + std::max(std::abs(c.x), std::abs(c.y)));
  const std::optional all_circles = std::pair{-1.02 * reach, 1.02 * reach};
  set_range(script, 'x', drawing ? all_circles : panel.x_range, "[*:*]");
  set_range(script, 'y', drawing ? all_circles : panel.y_range, "[0:*]");
  for (std::size_t i = 0; i < panel.lines.size(); ++i) {
    script << "$line" << number << '_' << i << " << EOD\n";
    for (const auto& [x, y] : panel.lines[i].points) script << x << ' ' << y << '\n';
    script << "EOD\n";
  }
  const char* kinds[] = {"discs", "rings"};
  for (const char* kind : kinds) {
    script << '$' << kind << number << " << EOD\n";
    for (const PlotCircle& c : panel.circles)
      if (c.filled == (kind == kinds[0])) script << c.x << ' ' << c.y << ' ' << c.radius << '\n';
    script << "EOD\n";
  }
  script << "plot ";
  if (drawing)
    script << "$discs" << number << " with circles fs solid 0.3 lc 1 notitle, $rings" << number
           << " with circles fs empty lc rgb 'black' notitle";
  for (std::size_t i = 0; i < panel.lines.size(); ++i) {
    const PlotLine& line = panel.lines[i];
    script << (i || drawing ? ", " : "") << "$line" << number << '_' << i << " with ";
    script << (line.style == PlotStyle::points ? "points pt 7 ps 0.5" : "lines lw 2");
    if (line.style == PlotStyle::dashed) script << " dt 2";
    if (line.color > 0) script << " lc " << line.color;
    script << " title " << quoted(line.title);
  }
  script << '\n';
}

std::string script_text(const PlotSheet& sheet, PlotFormat format) {
  const int columns = std::max(1, sheet.columns);
  const int rows = (static_cast<int>(sheet.panels.size()) + columns - 1) / columns;
  std::ostringstream script;
  script << "set terminal " << (format == PlotFormat::svg ? "svg" : "pngcairo") << " size "
         << columns * sheet.panel_width_px << ',' << rows * sheet.panel_height_px << " noenhanced font 'sans-serif,"
         << (format == PlotFormat::svg ? 13 : 10) << "' background '#ffffff'\n"
         << "set key noenhanced " << (sheet.key_outside ? "outside right" : "top right") << '\n';
  if (sheet.panels.size() > 1) script << "set multiplot layout " << rows << ',' << columns << '\n';
  for (std::size_t i = 0; i < sheet.panels.size(); ++i) add_panel(script, sheet.panels[i], i);
  return script.str();
}

}  // namespace

std::string draw(const PlotSheet& sheet, PlotFormat format) {
  const Script script(script_text(sheet, format));
  const std::string command = "gnuplot '" + script.file().string() + "' 2>/dev/null";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> answer(popen(command.c_str(), "r"), pclose);
  std::string picture;
  std::array<char, 4096> part;
  for (std::size_t got = 1; answer && (got = std::fread(part.data(), 1, part.size(), answer.get())) > 0;)
    picture.append(part.data(), got);
  const std::size_t start = picture.find(format == PlotFormat::svg ? "<svg" : "\x89PNG");
  if (start == std::string::npos)
    throw std::runtime_error("gnuplot drew no plot; install gnuplot-nox (station/install_packages does)");
  return picture.substr(start);
}

std::string line_plot(const std::string& x_label, const std::string& y_label, const std::vector<PlotLine>& lines) {
  return draw({.panels = {{.x_label = x_label, .y_label = y_label, .lines = lines}}}, PlotFormat::svg);
}

}  // namespace station
