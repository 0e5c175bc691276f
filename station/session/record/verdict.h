// The verdict on one picture: what was found, check by check, and whether the picture serves.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace station {

enum class Grade { good, doubtful, bad };  // doubtful: the picture is kept, and the person is told

// The result of one check. Names of checks: "settings" "duplicate" "stale" "file" "saturation" "exposure" "shadows"
// "focus" "tags" "angle" "bench" "motion" "orientation" "lamp" "lamp_side" "dark" "verify".
struct Finding {
  std::string check;
  Grade grade = Grade::good;
  std::optional<double> value;  // in the check's unit (capture_checks.h); absent: not measured
  std::string reason;           // one line that says what to do; empty when good
  bool may_pass_again = false;  // bad, but another picture may serve without anybody doing anything
};

struct Verdict {
  std::vector<Finding> findings;

  Grade grade() const;                                  // the worst of the findings; good without any
  std::string reason() const;                           // that of the first finding of the worst grade; empty when good
  bool may_pass_again() const;                          // every bad finding may pass again
  const Finding* find(const std::string& check) const;  // nullptr: no such finding
  void add(const Verdict& other);
};

// The value rounded to three digits, as journals have it: another machine's last bits then write the same text.
double three_digits(double value);

// Writes a verdict, its values rounded by three_digits.
nlohmann::json verdict_to_json(const Verdict& verdict);
Verdict verdict_from_json(const nlohmann::json& document);  // throws nlohmann::json::exception and std::runtime_error

std::string grade_name(Grade grade);  // "good" "doubtful" "bad"

}  // namespace station
