#include "rig/console_operator.h"

#include <optional>
#include <string>

#include "rig/asked_person.h"

namespace rig {
namespace {

class ConsoleOperator final : public Operator {
 public:
  ConsoleOperator(std::istream& in, std::ostream& out) : in_(in), out_(out) {}

  void arrange(const Arrangement& wanted) override {
    const std::string todo = standing_ ? instruction(*standing_, wanted) : full_instruction(wanted);
    if (!todo.empty()) {
      standing_.reset();  // until the person confirms, the bench may be half way
      ask_person(in_, out_, todo, "Press Enter when it is done, or q and Enter to end: ");
    }
    standing_ = wanted;
  }

 private:
  std::istream& in_;
  std::ostream& out_;
  std::optional<Arrangement> standing_;
};

}  // namespace

std::unique_ptr<Operator> make_console_operator(std::istream& in, std::ostream& out) {
  return std::make_unique<ConsoleOperator>(in, out);
}

}  // namespace rig
