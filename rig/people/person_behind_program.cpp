#include <algorithm>
#include <ostream>

#include "rig/people/asked_person.h"
#include "rig/people/patient_lines.h"

namespace rig {
namespace {

using nlohmann::json;

class PersonBehindProgram final : public AskedPerson {
 public:
  PersonBehindProgram(std::istream& in, std::ostream& out) : lines_(in), out_(out) {}

  std::optional<std::string> ask(const Question& question) override {
    ++id_;
    write({{"question", document(question)}});
    for (;;) {
      const PatientLines::Said said = lines_.next(question.meanwhile);
      if (said.other) {
        write({{"answered", id_}});
        return said.other;
      }
      if (!said.line) return std::nullopt;
      if (auto answer = answer_in(*said.line, question)) return answer;
      write({{"note", "an answer was not taken: question " + std::to_string(id_) + " is open"}});
    }
  }

  void remark(const std::string& seen) override { write({{"remark", {{"id", id_}, {"text", seen}}}}); }

  void prepare(const json& context, const std::string&) override { context_.merge_patch(context); }

 private:
  json document(const Question& question) const {
    json asked = context_;
    asked.update({{"id", id_}, {"text", question.text}, {"choices", json::array()}});
    for (const Choice& choice : question.choices)
      asked["choices"].push_back({{"answer", choice.answer}, {"label", choice.label}});
    if (!question.typed.empty()) asked["typed"] = question.typed;
    if (!question.remark.empty()) asked["remark"] = question.remark;
    if (question.turn_to_deg) asked["turn_to_deg"] = *question.turn_to_deg;
    return asked;
  }

  std::optional<std::string> answer_in(const std::string& line, const Question& question) const {
    const json said = json::parse(line, nullptr, false);
    if (!said.is_object() || !said.contains("id") || said["id"] != id_ || !said.contains("answer") ||
        !said["answer"].is_string())
      return std::nullopt;
    const std::string answer = said["answer"];
    const bool offered = std::ranges::any_of(question.choices, [&](const Choice& one) { return one.answer == answer; });
    return offered || !question.typed.empty() ? std::optional(answer) : std::nullopt;
  }

  // Names of spools may hold any bytes.
  void write(const json& line) { out_ << line.dump(-1, ' ', false, json::error_handler_t::replace) << std::endl; }

  PatientLines lines_;
  std::ostream& out_;
  int id_ = 0;
  json context_ = json::object();
};

}  // namespace

std::unique_ptr<AskedPerson> make_person_behind_program(std::istream& in, std::ostream& out) {
  return std::make_unique<PersonBehindProgram>(in, out);
}

}  // namespace rig
