#include <algorithm>
#include <cctype>
#include <istream>
#include <ostream>

#include "rig/people/asked_person.h"

namespace rig {
namespace {

bool same_key(const std::string& key, const std::string& typed) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  return std::equal(key.begin(), key.end(), typed.begin(), typed.end(), same);
}

class PersonAtTerminal final : public AskedPerson {
 public:
  PersonAtTerminal(std::istream& in, std::ostream& out) : in_(in), out_(out) {}

  std::optional<std::string> ask(const Question& question) override {
    if (!question.remark.empty()) out_ << question.remark << "\n";
    out_ << question.text << "\n" << question.how << std::flush;
    std::string typed;
    if (!std::getline(in_, typed)) return std::nullopt;
    if (typed.find_first_not_of(" \t\r") == std::string::npos) typed.clear();
    for (const Choice& choice : question.choices)
      if (same_key(choice.key, typed)) return choice.answer;
    return question.typed.empty() ? question.choices.front().answer : typed;
  }

  void prepare(const nlohmann::json&, const std::string& drawing) override { out_ << drawing << std::flush; }

 private:
  std::istream& in_;
  std::ostream& out_;
};

}  // namespace

std::unique_ptr<AskedPerson> make_person_at_terminal(std::istream& in, std::ostream& out) {
  return std::make_unique<PersonAtTerminal>(in, out);
}

}  // namespace rig
