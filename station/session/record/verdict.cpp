#include "station/session/record/verdict.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace station {
namespace {

using nlohmann::json;

Grade grade_from_name(const std::string& name) {
  for (const Grade grade : {Grade::good, Grade::doubtful, Grade::bad})
    if (name == grade_name(grade)) return grade;
  throw std::runtime_error("the grade '" + name + "' is not known");
}

}  // namespace

double three_digits(double value) {
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 2);
  double rounded = 0;
  std::from_chars(text.data(), written.ptr, rounded);
  return std::isfinite(rounded) && std::abs(rounded) > 1e-6 ? rounded : 0;
}

std::string grade_name(Grade grade) {
  return grade == Grade::good ? "good" : grade == Grade::doubtful ? "doubtful" : "bad";
}

Grade Verdict::grade() const {
  const auto worst = std::max_element(findings.begin(), findings.end(),
                                      [](const Finding& a, const Finding& b) { return a.grade < b.grade; });
  return worst == findings.end() ? Grade::good : worst->grade;
}

std::string Verdict::reason() const {
  const auto first =
      std::find_if(findings.begin(), findings.end(), [&](const Finding& finding) { return finding.grade == grade(); });
  return first == findings.end() ? "" : first->reason;
}

bool Verdict::may_pass_again() const {
  return std::all_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.grade != Grade::bad || finding.may_pass_again; });
}

const Finding* Verdict::find(const std::string& check) const {
  const auto found =
      std::find_if(findings.begin(), findings.end(), [&](const Finding& finding) { return finding.check == check; });
  return found == findings.end() ? nullptr : &*found;
}

void Verdict::add(const Verdict& other) {
  findings.insert(findings.end(), other.findings.begin(), other.findings.end());
}

json verdict_to_json(const Verdict& verdict) {
  json findings = json::array();
  for (const Finding& finding : verdict.findings) {
    json entry = {{"check", finding.check}, {"grade", grade_name(finding.grade)}};
    if (finding.value) entry["value"] = three_digits(*finding.value);
    if (!finding.reason.empty()) entry["reason"] = finding.reason;
    findings.push_back(entry);
  }
  return {{"grade", grade_name(verdict.grade())}, {"findings", findings}};
}

Verdict verdict_from_json(const json& document) {
  Verdict verdict;
  for (const json& entry : document.at("findings")) {
    Finding finding{.check = entry.at("check").get<std::string>(),
                    .grade = grade_from_name(entry.at("grade").get<std::string>()),
                    .value = std::nullopt,
                    .reason = entry.value("reason", std::string()),
                    .may_pass_again = false};
    if (entry.contains("value")) finding.value = entry.at("value").get<double>();
    verdict.findings.push_back(finding);
  }
  return verdict;
}

}  // namespace station
