#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/output/html.h"
#include "station/reproduce/figures_page.h"

namespace station {
namespace {

std::string row_of(const std::vector<FigurePicture>& row, const std::string& folder) {
  std::string html = "<div class=\"sheet\" style=\"grid-template-columns:repeat(" + std::to_string(row.size()) +
                     ",minmax(0,1fr));margin-bottom:8px\">\n";
  for (const FigurePicture& picture : row) {
    const std::string source = (std::filesystem::path(folder) / picture.file).lexically_normal().generic_string();
    html += "<figure><img alt=\"" + escaped(picture.caption) + "\" src=\"" + escaped(source) + "\"><figcaption>" +
            escaped(picture.caption) + "</figcaption></figure>\n";
  }
  return html + "</div>\n";
}

std::string table_of(const MadeFigure& made, bool quick) {
  if (made.numbers.empty()) return {};
  std::string html = "<table><tr><th>number</th><th>here</th><th>in the paper</th>";
  if (quick) html += "<th>stored, quick</th>";
  html += "</tr>\n";
  for (const MadeNumber& one : made.numbers) {
    const FigureNumber& number = one.number;
    html += "<tr><th>" + escaped(number.name) + "</th><td>" + escaped(shown_number(one)) + "</td><td>" +
            escaped(number.paper.empty() ? "not said" : number.paper) + "</td>";
    if (quick)
      html += "<td>" +
              (number.stored ? number_text(*number.stored, number.digits) + " &plusmn; " +
                                   number_text(*number.within, number.digits)
                             : std::string("none")) +
              "</td>";
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

std::string section_of(const MadeFigure& made, bool quick) {
  const Figure& figure = made.figure;
  std::string html = "<h2 id=\"figure-" + figure.id + "\">" + escaped(figure.id + ": " + figure.title) + "</h2>\n";
  html += "<p><b>The paper:</b> " + escaped(figure.paper) + "</p>\n";
  if (made.problem.empty())
    for (const std::vector<FigurePicture>& row : figure.rows)
      html += row_of(row, figure_folder("", figure.id).string());
  else
    html += "<p class=\"doubt\">It could not be made: " + escaped(made.problem) + "</p>\n";
  html += table_of(made, quick) + "<p><b>Different here:</b> " + escaped(figure.different) + "</p>\n";
  std::string commands;
  for (const std::vector<std::string>& words : figure.steps) commands += escaped(shown_command(words)) + "\n";
  return html + "<details><summary>" + number_text(made.seconds, 0) + " s by <code>threadstation reproduce " +
         escaped(figure.id) + (quick ? " --quick" : "") + "</code>: its commands</summary><pre>" + commands +
         "</pre></details>\n";
}

}  // namespace

std::string shown_number(const MadeNumber& made) {
  if (!made.value) return "not said";
  return number_text(*made.value, made.number.digits) + (made.number.unit.empty() ? "" : " " + made.number.unit);
}

void write_figures_html(const FiguresPage& page, const std::filesystem::path& out) {
  double seconds = 0;
  std::string body, contents;
  for (const MadeFigure& made : page.figures) {
    seconds += made.seconds;
    contents += "<li><a href=\"#figure-" + made.figure.id + "\">" + escaped(made.figure.id + ": " + made.figure.title) +
                "</a></li>\n";
    body += section_of(made, page.quick);
  }
  write_text_file(out / "index.html",
                  html_page("Figures of Xia et al. 2025, made anew",
                            "<p>Everything here is simulated: spools, bench and camera. Made " + escaped(page.utc) +
                                " by " + escaped(software_version()) + (page.quick ? ", quickly" : "") + ", in " +
                                number_text(seconds / 60, 1) +
                                " minutes; seeds are those of the commands, 1 where none is given. The paper: "
                                "<i>Predicting Fabric Appearance Through Thread Scattering and Inversion</i>, doi "
                                "10.1145/3731178.</p>\n<ul>\n" +
                                contents + "</ul>\n" + body));
}

}  // namespace station
