#include "station/reproduce/reproduce.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "rig/devices/clock.h"
#include "station/data/data_folder.h"
#include "station/documents/disk/folder_lock.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/number_text.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

const Figure& figure_named(const std::vector<Figure>& figures, const std::string& id) {
  const auto found = std::ranges::find(figures, id, &Figure::id);
  if (found != figures.end()) return *found;
  std::string names;
  for (const Figure& figure : figures) names += (names.empty() ? "" : ", ") + figure.id;
  throw std::runtime_error("there is no figure '" + id + "' to make; there are " + names);
}

// With those that they need.
std::set<std::string> wanted_of(const std::vector<Figure>& figures, const std::vector<std::string>& asked) {
  std::set<std::string> wanted;
  std::vector<std::string> open = asked;
  if (open.empty())
    for (const Figure& figure : figures) open.push_back(figure.id);
  while (!open.empty()) {
    const Figure& figure = figure_named(figures, open.back());
    open.pop_back();
    if (wanted.insert(figure.id).second) open.insert(open.end(), figure.needs.begin(), figure.needs.end());
  }
  return wanted;
}

// Figures after all that they need, which none does in a circle.
void make_in_order(const Figure& figure, const std::vector<Figure>& figures, std::map<std::string, MadeFigure>& made,
                   const std::function<MadeFigure(const Figure&)>& make) {
  if (made.contains(figure.id)) return;
  made[figure.id].figure = figure;
  for (const std::string& other : figure.needs) {
    make_in_order(figure_named(figures, other), figures, made, make);
    if (made[other].problem.empty()) continue;
    made[figure.id].problem = "it needs " + other + ", which could not be made";
    return;
  }
  made[figure.id] = make(figure);
}

}  // namespace

FiguresPage reproduce(const ReproduceRequest& request) {
  watch_interrupts(100);
  const std::filesystem::path data = data_folder();
  const std::vector<Figure> figures = read_figures(data, request.quick);
  const std::set<std::string> wanted = wanted_of(figures, request.figures);
  make_folder(request.out);
  FileSystem disk;
  const OpenFile lock = lock_folder(request.out, disk);
  int steps = 0, done = 0;
  for (const Figure& figure : figures)
    if (wanted.contains(figure.id)) steps += static_cast<int>(figure.steps.size());
  ProgressDisplay progress("reproduce", request.progress_style);
  std::map<std::string, MadeFigure> made;
  const auto make = [&](const Figure& figure) {
    MadeFigure one = make_figure(figure, request.out, data, lock.descriptor(),
                                 [&](const std::string& what) { progress.show(done++, steps, what); });
    if (!one.problem.empty()) progress.note("figure " + figure.id + " could not be made: " + one.problem);
    return one;
  };
  for (const Figure& figure : figures)
    if (wanted.contains(figure.id)) make_in_order(figure, figures, made, make);
  FiguresPage page{.quick = request.quick, .utc = rig::SystemClock().utc()};
  for (const Figure& figure : figures)
    if (made.contains(figure.id))
      page.figures.push_back(made[figure.id]);
    else if (const auto earlier = made_figure(figure, request.out))
      page.figures.push_back(*earlier);
  write_figures_html(page, request.out);
  write_figures_pdf(page, request.out);
  progress.finish(std::to_string(made.size()) + " figures: " + (request.out / "index.html").string());
  return page;
}

std::string describe(const FiguresPage& page) {
  std::string text;
  for (const MadeFigure& made : page.figures) {
    text += made.figure.id + ": " + made.figure.title + ", " + number_text(made.seconds, 0) + " s\n";
    if (!made.problem.empty()) text += "  could not be made: " + made.problem + "\n";
    for (const MadeNumber& one : made.numbers)
      text += "  " + one.number.name + ": " + shown_number(one) +
              (one.number.paper.empty() ? "" : " (paper: " + one.number.paper + ")") + "\n";
  }
  return text;
}

nlohmann::json to_json(const FiguresPage& page) {
  nlohmann::json figures = nlohmann::json::array();
  for (const MadeFigure& made : page.figures) {
    nlohmann::json numbers = nlohmann::json::array();
    for (const MadeNumber& one : made.numbers) {
      nlohmann::json number{{"name", one.number.name}, {"unit", one.number.unit}, {"paper", one.number.paper}};
      number["value"] = one.value ? nlohmann::json(*one.value) : nlohmann::json();
      if (one.number.stored) number["stored"] = *one.number.stored, number["within"] = *one.number.within;
      numbers.push_back(number);
    }
    figures.push_back({{"figure", made.figure.id},
                       {"title", made.figure.title},
                       {"seconds", made.seconds},
                       {"problem", made.problem},
                       {"numbers", numbers}});
  }
  return {{"quick", page.quick}, {"utc", page.utc}, {"figures", figures}};
}

}  // namespace station
