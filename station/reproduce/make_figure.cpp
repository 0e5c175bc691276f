#include "station/reproduce/make_figure.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "station/documents/disk/stored_file.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/output/child_process.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kRecord = "made.json";

// What has been run in a folder: {"software", "steps": [{"words", "seconds"}]}.
json record_of(const fs::path& folder) {
  const fs::path file = folder / kRecord;
  if (fs::exists(file)) {
    json record = read_json_file(file);
    if (record.value("software", "") == software_version()) return record;
  }
  return {{"software", software_version()}, {"steps", json::array()}};
}

bool is_run(const json& record, std::size_t step, const std::vector<std::string>& words) {
  return step < record["steps"].size() && record["steps"][step].at("words") == words;
}

std::vector<std::string> with_data(std::vector<std::string> words, const fs::path& data_folder) {
  for (std::string& word : words)
    if (word.starts_with(kData)) word = data_folder / word.substr(std::string(kData).size());
  return words;
}

// The values at a pointer in which * stands for each element of a list or object.
void collect(const json& document, const std::string& at, std::vector<double>& values) {
  const std::size_t star = at.find("/*");
  const json::json_pointer plain(at.substr(0, star));
  if (!document.contains(plain)) return;
  const json& found = document.at(plain);
  if (star == at.npos) {
    if (found.is_number()) values.push_back(found.get<double>());
    return;
  }
  for (const json& element : found) collect(element, at.substr(star + 2), values);
}

json document_in(const fs::path& file) {
  if (file.extension() == ".txt") return json::parse(last_words(file), nullptr, false);
  return read_json_file(file);
}

std::optional<double> value_of(const FigureNumber& number, const fs::path& folder) {
  const fs::path file = folder / number.file;
  if (!fs::exists(file)) return std::nullopt;
  std::vector<double> values;
  collect(document_in(file), number.at, values);
  if (values.empty()) return std::nullopt;
  double sum = 0;
  for (const double value : values) sum += value;
  return number.scale * sum / static_cast<double>(values.size());
}

MadeFigure described(const Figure& figure, const fs::path& folder, const json& record) {
  MadeFigure made{.figure = figure};
  for (const std::vector<FigurePicture>& row : figure.rows)
    for (const FigurePicture& picture : row)
      if (made.problem.empty() && !fs::exists(folder / picture.file))
        made.problem = "none of its commands has made " + picture.file.string();
  for (const json& step : record["steps"]) made.seconds += step.at("seconds").get<double>();
  for (const FigureNumber& number : figure.numbers) made.numbers.push_back({number, value_of(number, folder)});
  return made;
}

}  // namespace

fs::path figure_folder(const fs::path& out, const std::string& id) {
  return out / ("figure-" + id);
}

MadeFigure make_figure(const Figure& figure, const fs::path& out, const fs::path& data_folder, int lock,
                       const std::function<void(const std::string&)>& step) {
  const fs::path folder = figure_folder(out, figure.id);
  make_folder(folder);
  for (const std::vector<FigurePicture>& row : figure.rows)
    for (const FigurePicture& picture : row) {
      if (picture.given.empty()) continue;
      make_folder(folder / picture.file.parent_path());
      fs::copy_file(data_folder / picture.given, folder / picture.file, fs::copy_options::overwrite_existing);
    }
  json record = record_of(folder);
  for (std::size_t i = 0; i < figure.steps.size(); ++i) {
    const std::vector<std::string>& words = figure.steps[i];
    step("figure " + figure.id + ": " + words.front() + (words.size() > 1 ? " " + words[1] : ""));
    if (is_run(record, i, words)) continue;
    json& steps = record["steps"];
    steps.erase(steps.begin() + static_cast<std::ptrdiff_t>(std::min(i, steps.size())), steps.end());
    const fs::path said = fs::absolute(folder) / said_by_step(i + 1);
    const EndedProcess ended = run_own_program(with_data(words, fs::absolute(data_folder)), said, folder, lock);
    if (ended.status == 0) {
      steps.push_back({{"words", words}, {"seconds", ended.seconds}});
      write_json_file(folder / kRecord, record);
    }
    if (interrupted())
      throw std::runtime_error("stopped on request; the same command goes on with figure " + figure.id);
    if (ended.status != 0) {
      MadeFigure failed = described(figure, folder, record);
      const std::string why = last_words(said);
      failed.problem =
          shown_command(words) + ": " + (why.empty() ? "it ended with status " + std::to_string(ended.status) : why);
      return failed;
    }
  }
  return described(figure, folder, record);
}

std::optional<MadeFigure> made_figure(const Figure& figure, const fs::path& out) {
  const fs::path folder = figure_folder(out, figure.id);
  const json record = record_of(folder);
  for (std::size_t i = 0; i < figure.steps.size(); ++i)
    if (!is_run(record, i, figure.steps[i])) return std::nullopt;
  if (!fs::exists(folder)) return std::nullopt;
  return described(figure, folder, record);
}

std::string shown_command(const std::vector<std::string>& words) {
  std::string text = "threadstation";
  for (const std::string& word : words) text += " " + word;
  return text;
}

}  // namespace station
