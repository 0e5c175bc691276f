// Lines of an input that may be long in coming, with something to be done until then.
#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>

namespace rig {

class PatientLines {
 public:
  // The stream must live as long as the program, or end: a thread may still wait for its next line.
  explicit PatientLines(std::istream& in) : in_(in) {}

  struct Said {
    std::optional<std::string> line;   // nothing at the end of the input
    std::optional<std::string> other;  // what `meanwhile` returned before there was a line
  };
  // The next line. Until then `meanwhile`, which may be empty, is done again and again; what it returns ends the wait,
  // and the line is kept for the next call.
  Said next(const std::function<std::optional<std::string>()>& meanwhile);

 private:
  struct Coming;
  std::istream& in_;
  std::shared_ptr<Coming> coming_;  // the line that a thread waits for
};

}  // namespace rig
