#include "station/reproduce/figure_file.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "station/documents/reader.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Choice = std::vector<std::pair<std::string, std::string>>;  // names and what they stand for

// The products of the lists of "for", the last of which turns fastest: [["weave", ["plain", "twill"]], ...].
std::vector<Choice> choices_of(ObjectReader& reader, const std::string& key) {
  std::vector<Choice> choices{{}};
  if (!reader.has(key)) return choices;
  const json& lists = reader.raw(key);
  const auto is_list = [](const json& list) {
    return list.is_array() && list.size() == 2 && list[0].is_string() && list[1].is_array() &&
           std::ranges::all_of(list[1], [](const json& value) { return value.is_string(); });
  };
  if (!lists.is_array() || !std::ranges::all_of(lists, is_list))
    reader.refuse(key, "expected a list of [name, [values]]");
  for (const json& list : lists) {
    std::vector<Choice> more;
    for (const Choice& choice : choices)
      for (const json& value : list[1]) {
        more.push_back(choice);
        more.back().emplace_back(list[0].get<std::string>(), value.get<std::string>());
      }
    choices = std::move(more);
  }
  return choices;
}

// "for", or what --quick takes instead.
std::vector<Choice> asked_choices(ObjectReader& reader, bool quick) {
  const std::vector<Choice> whole = choices_of(reader, "for");
  if (!reader.has("quick_for")) return whole;
  const std::vector<Choice> few = choices_of(reader, "quick_for");
  return quick ? few : whole;
}

// The text with each {name} replaced.
std::string chosen(std::string text, const Choice& choice) {
  for (const auto& [name, value] : choice) {
    const std::string mark = "{" + name + "}";
    for (std::size_t at = text.find(mark); at != text.npos; at = text.find(mark, at + value.size()))
      text.replace(at, mark.size(), value);
  }
  return text;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

void read_step(ObjectReader reader, bool quick, Figure& figure) {
  std::string text = reader.text("run");
  for (const auto& [key, asked] : {std::pair{"quick", quick}, std::pair{"whole", !quick}})
    if (reader.has(key)) {
      const std::string options = reader.text(key);
      if (asked) text += " " + options;
    }
  for (const Choice& choice : asked_choices(reader, quick)) figure.steps.push_back(words_of(chosen(text, choice)));
  reader.finish();
}

// Pictures that come with the program are copied beside those that are made.
FigurePicture picture_of(const std::string& file, const std::string& caption) {
  if (!file.starts_with(kData)) return {.file = file, .caption = caption};
  const fs::path from = file.substr(std::string(kData).size());
  return {.file = fs::path("given") / from.filename(), .caption = caption, .given = from};
}

// A row, or a row for each choice of "rows": its pictures are listed, or there is one for each choice of "for".
void read_row(ObjectReader reader, bool quick, Figure& figure) {
  std::vector<Choice> rows{{}};
  if (reader.has("rows")) rows = choices_of(reader, "rows");
  if (reader.has("quick_rows")) {
    const std::vector<Choice> few = choices_of(reader, "quick_rows");
    if (quick) rows = few;
  }
  std::vector<FigurePicture> pictures;
  if (reader.has("pictures")) {
    for (ObjectReader& one : reader.objects("pictures")) {
      pictures.push_back({.file = one.text("file"), .caption = one.text("caption")});
      one.finish();
    }
  } else {
    const FigurePicture each{.file = reader.text("file"), .caption = reader.text("caption")};
    for (const Choice& choice : asked_choices(reader, quick))
      pictures.push_back({.file = chosen(each.file, choice), .caption = chosen(each.caption, choice)});
  }
  for (const Choice& row : rows) {
    std::vector<FigurePicture>& made = figure.rows.emplace_back();
    for (const FigurePicture& picture : pictures)
      made.push_back(picture_of(chosen(picture.file, row), chosen(picture.caption, row)));
  }
  reader.finish();
}

FigureNumber read_number(ObjectReader reader) {
  FigureNumber number{.name = reader.text("name"), .file = reader.text("file"), .at = reader.text("at")};
  if (reader.has("unit")) number.unit = reader.text("unit");
  if (reader.has("paper")) number.paper = reader.text("paper");
  if (reader.has("scale")) number.scale = reader.number("scale", 1e-12, 1e12);
  if (reader.has("digits")) number.digits = reader.integer("digits", 0, 6);
  if (reader.has("stored")) {
    number.stored = reader.number("stored", -1e12, 1e12);
    number.within = reader.number("within", 0, 1e12);
  }
  reader.finish();
  return number;
}

Figure read_figure(const fs::path& file, bool quick) {
  const json document = read_json_file(file);
  ObjectReader reader(document, file.string(), "figure");
  Figure figure{.id = reader.text("figure"),
                .title = reader.text("title"),
                .paper = reader.text("paper"),
                .different = reader.text("different")};
  if (reader.has("needs")) {
    const json& needs = reader.raw("needs");
    if (!needs.is_array()) reader.refuse("needs", "expected a list of figures");
    for (const json& other : needs) figure.needs.push_back(other.get<std::string>());
  }
  for (const ObjectReader& step : reader.objects("steps")) read_step(step, quick, figure);
  for (const ObjectReader& row : reader.objects("pictures")) read_row(row, quick, figure);
  if (reader.has("numbers"))
    for (const ObjectReader& number : reader.objects("numbers")) figure.numbers.push_back(read_number(number));
  reader.finish();
  return figure;
}

}  // namespace

fs::path said_by_step(std::size_t number) {
  return "step-" + std::to_string(number) + ".txt";
}

std::vector<Figure> read_figures(const fs::path& data_folder, bool quick) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(data_folder / "figures"))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<Figure> figures;
  for (const fs::path& file : files) figures.push_back(read_figure(file, quick));
  return figures;
}

}  // namespace station
