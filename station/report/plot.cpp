#include "station/report/plot.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <span>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "station/capture/stored_file.h"

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

std::string script_text(const std::string& x_label, const std::string& y_label, const std::vector<PlotLine>& lines) {
  std::ostringstream script;
  script << "set terminal svg size 680,340 font 'sans-serif,13' background '#ffffff'\n"
         << "set xlabel '" << x_label << "'\nset yrange [0:*]\nset ylabel '" << y_label
         << "'\nset grid lc rgb '#dddddd'\nset key outside right\n";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    script << "$line" << i << " << EOD\n";
    for (const auto& [x, y] : lines[i].points) script << x << ' ' << y << '\n';
    script << "EOD\n";
  }
  script << "plot ";
  for (std::size_t i = 0; i < lines.size(); ++i)
    script << (i ? ", " : "") << "$line" << i << " with lines lw 2 title '" << lines[i].title << "'";
  script << '\n';
  return script.str();
}

}  // namespace

std::string line_plot(const std::string& x_label, const std::string& y_label, const std::vector<PlotLine>& lines) {
  const Script script(script_text(x_label, y_label, lines));
  const std::string command = "gnuplot '" + script.file().string() + "' 2>/dev/null";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> answer(popen(command.c_str(), "r"), pclose);
  std::string svg;
  std::array<char, 4096> part;
  for (std::size_t got = 1; answer && (got = std::fread(part.data(), 1, part.size(), answer.get())) > 0;)
    svg.append(part.data(), got);
  const std::size_t start = svg.find("<svg");
  if (start == std::string::npos)
    throw std::runtime_error("gnuplot drew no plot; install gnuplot-nox (station/install_packages does)");
  return svg.substr(start);
}

}  // namespace station
