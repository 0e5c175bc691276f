// The person who is asked to do something and answers: at a terminal, or through a program that shows the question.
#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace rig {

inline constexpr const char* kDone = "done";
inline constexpr const char* kDecline = "decline";

struct Choice {
  std::string answer;  // what `ask` returns for it
  std::string key;     // what is typed for it at a terminal before Enter
  std::string label;   // what its button says
};

struct Question {
  std::string text;                                                          // what is to be done, in whole sentences
  std::string how = "Press Enter when it is done, or q and Enter to end: ";  // said at a terminal only
  std::vector<Choice> choices = {{kDone, "", "Done"}, {kDecline, "q", "Cannot be done now"}};
  std::string typed{};   // what may be typed instead of a choice ("the angle in degrees"); empty: nothing
  std::string remark{};  // why it is asked again; empty the first time
  std::optional<double> turn_to_deg{};  // what the platform is to be turned to, for a drawing
  // Done again and again while nobody has answered; what it returns is the answer then. A terminal leaves it out: there
  // an Enter that comes too late would answer the next question.
  std::function<std::optional<std::string>()> meanwhile{};
};

class AskedPerson {
 public:
  virtual ~AskedPerson() = default;

  // The answer of one of the choices, or the text that was typed where the question allows one. Nothing when the input
  // ended before anybody answered.
  virtual std::optional<std::string> ask(const Question& question) = 0;

  // What the next questions are about. A terminal shows `drawing` at once. A program finds the members of `context` in
  // every later question, until another call replaces them or makes them null: "step" and "of" (this is step n of m),
  // "arrangement" (how the bench should stand).
  virtual void prepare(const nlohmann::json& context, const std::string& drawing) = 0;

  // What is seen while a question is open, in a sentence; a terminal shows none.
  virtual void remark(const std::string& /*seen*/) {}
};

// A person cannot or does not want to do what is asked now, or there is nobody left to ask.
class Declined : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Asks, and throws Declined when the person declines or the input ends.
std::string ask_or_end(AskedPerson& asked, const Question& question);

// The streams must outlive the person. At a terminal a line that is no choice's key is the text typed, or the first
// choice where nothing may be typed; keys are read in either case.
std::unique_ptr<AskedPerson> make_person_at_terminal(std::istream& in, std::ostream& out);

// One line each way. A question, on `out`:
//   {"question": {"id": 3, "text": ..., "choices": [{"answer": "done", "label": "Done"}, ...], "typed": ...,
//    "remark": ..., "turn_to_deg": 15, "step": 2, "of": 17, "arrangement": {...}}}
// with "typed", "remark" and "turn_to_deg" where the question has them, and the context that was prepared. Its answer,
// on `in`:
//   {"id": 3, "answer": "done"}
// Meanwhile, on `out`: {"remark": {"id": 3, "text": ...}}, and {"answered": 3} when it was answered by what is seen.
// Every question has an id of its own. A line that does not answer the open question is not taken, and `out` says so:
// {"note": ...}.
std::unique_ptr<AskedPerson> make_person_behind_program(std::istream& in, std::ostream& out);

}  // namespace rig
