// The settings of the documented GRBL (documented_grbl.h), as it keeps them in its EEPROM and prints them.
#pragma once

#include <cstdarg>
#include <map>
#include <string>
#include <vector>

class DocumentedSettings {
 public:
  explicit DocumentedSettings(const std::map<int, double>& others);  // those that differ from what GRBL comes with
  double at(int number) const { return values_.at(number); }
  bool is_on(int number) const { return values_.at(number) != 0; }
  const std::map<int, double>& all() const { return values_; }
  int set(const std::string& line);  // obeys "$100=40"; returns its error, 0 for none
  void restore();                    // makes all of them those that GRBL comes with
  std::vector<std::string> lines() const;

 private:
  std::map<int, double> values_;
};

// The text that printf would write.
std::string documented_text(const char* format, ...) __attribute__((format(printf, 1, 2)));
