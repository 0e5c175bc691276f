// What was found in one picture, check by check, and whether it serves.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace station {

enum class Grade { good, doubtful, bad };  // doubtful: kept, and said to the person

// Names of checks: "settings" "duplicate" "stale" "file" "saturation" "exposure" "shadows" "focus" "tags" "angle" "bench" "motion"
// "orientation" "lamp" "lamp_side" "dark" "verify".
struct Finding {
  std::string check;
  Grade grade = Grade::good;
  std::optional<double> value;  // in the unit that the check's name has in the report; absent: could not be looked at
  std::string reason;           // one line with what to do; empty when good
  bool may_pass_again = false;  // bad, but the next picture may serve without anybody doing anything
};

struct Verdict {
  std::vector<Finding> findings;

  Grade grade() const;          // the worst of its findings; good without any
  std::string reason() const;   // of the first of the worst; empty when good
  bool may_pass_again() const;  // all that is bad may pass
  const Finding* find(const std::string& check) const;
  void add(const Verdict& other);
};

// A value as journals have it: to three digits, so that another machine's last bits write the same text.
double three_digits(double value);

// Values to three digits, so that another machine's last bits write the same text.
nlohmann::json verdict_to_json(const Verdict& verdict);
Verdict verdict_from_json(const nlohmann::json& document);  // throws nlohmann::json::exception and std::runtime_error

std::string grade_name(Grade grade);  // "good" "doubtful" "bad"

}  // namespace station
