#include "station/thread/report/capture_report.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "station/bench/calibration_validity.h"
#include "station/documents/degree.h"
#include "station/documents/disk/folder_lock.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/number_text.h"
#include "station/output/html.h"
#include "station/output/plot.h"
#include "station/session/record/journal.h"
#include "station/session/record/picture_record.h"
#include "station/session/record/run_state.h"
#include "station/session/record/verify.h"

namespace station {
namespace {

using Records = std::vector<JournalRecord>;

constexpr const char* kStyle =
    "<style>.good{background:#e4f3e4}.doubtful{background:#fdf0cf}.bad{background:#f7d7d4}"
    "code{font-size:.8rem;word-break:break-all}</style>\n";

Records records_of(const std::filesystem::path& session) {
  return read_journal(session / "journal.jsonl").records;
}

std::size_t count_of(const Records& records, const std::string& event) {
  return static_cast<std::size_t>(std::ranges::count(records, event, &JournalRecord::event));
}

// The pictures that count, in the order in which they were taken.
std::vector<PictureRecord> in_order(const Records& records) {
  std::vector<PictureRecord> pictures;
  for (const auto& [step, picture] : taken_pictures(records)) pictures.push_back(picture);
  std::ranges::stable_sort(pictures, {}, &PictureRecord::utc);
  return pictures;
}

std::string value_text(const Finding& finding) {
  static const std::map<std::string, const char*> units = {
      {"bench", " px"},   {"angle", "&deg;"}, {"motion", " px"}, {"orientation", "&deg;"}, {"saturation", " %"},
      {"exposure", " %"}, {"lamp", " %"},     {"dark", " %"},    {"lamp_side", " %"},      {"settings", " stops"}};
  if (!finding.value) return "";
  const auto unit = units.find(finding.check);
  const double value = std::abs(*finding.value) < 0.005 ? 0 : *finding.value;  // no "-0.00"
  return " " + number_text(value, finding.check == "tags" ? 0 : 2) + (unit == units.end() ? "" : unit->second);
}

std::string findings_text(const Verdict& verdict) {
  std::string text;
  for (const Finding& finding : verdict.findings) {
    if (finding.check == "settings" && finding.grade == Grade::good) continue;  // as asked
    text += (text.empty() ? "" : ", ") + escaped(finding.check) + value_text(finding);
    if (!finding.reason.empty()) text += " (<b>" + escaped(finding.reason) + "</b>)";
  }
  return text;
}

std::string picture_row(const PictureRecord& picture) {
  const std::string grade = grade_name(picture.verdict.grade());
  return "<tr><td>" + escaped(picture.step) + "</td><td class=\"" + grade + "\">" + grade + "</td><td>" +
         number_text(picture.read_angle_rad / kDegree, 2) + "&deg;</td><td>" + number_text(picture.read.exposure_s, 4) +
         " s</td><td>" +
         (picture.same_as.empty() ? findings_text(picture.verdict) : "is the picture of " + escaped(picture.same_as)) +
         "</td></tr>\n";
}

std::string refused_rows(const Records& records) {
  std::string rows;
  for (const JournalRecord& record : records)
    if (record.event == "refused")
      rows += "<tr><td>" + escaped(record.data.value("step", "")) + "</td><td class=\"bad\">refused</td><td>" +
              escaped(record.data.value("file", "no file")) + "</td><td></td><td>" +
              findings_text(verdict_from_json(record.data.at("verdict"))) + "</td></tr>\n";
  return rows;
}

// A plot of one value per view through the session.
PlotPanel panel(const std::string& title, const std::string& y_label, const std::vector<PictureRecord>& pictures,
                const std::string& began_utc, const std::function<std::optional<double>(const PictureRecord&)>& value) {
  PlotPanel result{
      .title = title, .x_label = "minutes since the start", .y_label = y_label, .lines = {}, .circles = {}};
  PlotLine front{"lamp in front", {}, PlotStyle::points}, back{"lamp behind", {}, PlotStyle::points};
  for (const PictureRecord& picture : pictures)
    if (const auto found = picture.kind == StepKind::view ? value(picture) : std::nullopt)
      (picture.lamp == rig::Lamp::back ? back : front)
          .points.emplace_back(1440 * days_between(began_utc, picture.utc), *found);
  for (const PlotLine& line : {front, back})
    if (!line.points.empty()) result.lines.push_back(line);
  return result;
}

std::string plots(const std::vector<PictureRecord>& pictures, const std::string& began_utc) {
  const auto finding = [](const char* check) {
    return [check](const PictureRecord& picture) -> std::optional<double> {
      const Finding* found = picture.verdict.find(check);
      return found == nullptr ? std::nullopt : found->value;
    };
  };
  PlotSheet sheet{.panels = {}, .columns = 2, .panel_width_px = 560, .panel_height_px = 260, .key_outside = false};
  for (PlotPanel next :
       {panel("Exposure", "s", pictures, began_utc,
              [](const PictureRecord& picture) { return std::optional(picture.read.exposure_s); }),
        panel("Lamp at the reference chip", "% of the calibrated", pictures, began_utc, finding("lamp")),
        panel("Table's tags", "px from the calibration", pictures, began_utc, finding("bench")),
        panel("Platform", "degrees from its reading", pictures, began_utc, finding("angle"))})
    if (!next.lines.empty()) {
      if (next.title == "Lamp at the reference chip") next.y_range = {90, 110};
      if (next.title == "Platform") next.y_range = {-0.5, 0.5};
      sheet.panels.push_back(std::move(next));
    }
  return sheet.panels.empty() ? "" : draw(sheet, PlotFormat::svg);
}

}  // namespace

std::string capture_facts(const std::filesystem::path& session, const SessionFile& asked,
                          const RigCalibration* calibration) {
  const Records records = records_of(session);
  std::vector<std::pair<std::string, std::string>> facts = {
      {"state", state_name(state_of(records, folder_in_use(session)))},
      {"spool", asked.spool.name + " (" + asked.spool.material + ")"},
      asked.spool.fabric
          ? std::pair<std::string, std::string>{"cloth", "round a cylinder of radius " +
                                                             number_text(asked.spool.fabric->cylinder.radius_mm, 1) +
                                                             " mm"}
          : std::pair<std::string, std::string>{"wrapping",
                                                std::to_string(asked.spool.wrapping.turns) + " turns of " +
                                                    number_text(asked.spool.wrapping.thread_diameter_mm, 3) + " mm"}};
  if (asked.sample)
    for (const auto& [name, text] : {std::pair{"barcode", asked.sample->barcode},
                                     {"lot", asked.sample->lot},
                                     {"colour", asked.sample->colour},
                                     {"note", asked.sample->note}})
      if (!text.empty()) facts.emplace_back(name, text);
  facts.emplace_back("operator", asked.person.empty() ? "not said" : asked.person);
  facts.emplace_back("rig", asked.rig.name);
  for (const JournalRecord& record : records)
    if (record.event == "camera") {
      facts.emplace_back("camera", record.data.value("make", "") + " " + record.data.value("model", "") + ", serial " +
                                       record.data.value("serial", ""));
      break;
    }
  const std::string last_utc = records.empty() ? asked.utc : records.back().utc;
  facts.emplace_back("captured", asked.utc + " to " + last_utc + ", in " +
                                     std::to_string(1 + count_of(records, "resume")) + " run(s), " +
                                     std::to_string(count_of(records, "refused")) + " picture(s) refused, " +
                                     std::to_string(count_of(records, "discarded")) + " withdrawn");
  if (calibration)
    facts.emplace_back("calibration",
                       calibration->utc + ", " + number_text(days_between(calibration->utc, asked.utc), 1) +
                           " days old, SHA-256 " + sha256_of_file(session / "calibration" / "calibration.json"));
  facts.emplace_back("software", asked.software);
  return kStyle + fact_table(facts);
}

std::string verdict_section(const std::filesystem::path& session, const SessionFile& asked) {
  const Records records = records_of(session);
  const std::vector<PictureRecord> pictures = in_order(records);
  std::string rows;
  for (const PictureRecord& picture : pictures) rows += picture_row(picture);
  rows += refused_rows(records);
  return "<h2>Verdicts</h2>\n<table><tr><th>step</th><th>verdict</th><th>platform</th><th>exposure</th>"
         "<th>found</th></tr>\n" +
         rows + "</table>\n<h2>Through the session</h2>\n" + plots(pictures, asked.utc) + "\n";
}

std::string checksum_section(const std::filesystem::path& session) {
  const Records records = records_of(session);
  std::map<std::string, std::string> hashes = fixed_files(records);
  for (const auto& [step, picture] : taken_pictures(records)) hashes[picture.file] = picture.sha256;
  std::string rows;
  for (const auto& [file, sha256] : hashes)
    rows += "<tr><td>" + escaped(file) + "</td><td><code>" + sha256 + "</code></td></tr>\n";
  return "<h2>Checksums (SHA-256)</h2>\n<details><summary>" + std::to_string(hashes.size()) +
         " files; threadstation verify compares them</summary>\n<table>\n" + rows + "</table></details>\n";
}

}  // namespace station
