#include "rig/people/console_operator.h"

#include <optional>
#include <string>

namespace rig {
namespace {

class ConsoleOperator final : public Operator {
 public:
  explicit ConsoleOperator(AskedPerson& asked) : asked_(asked) {}

  void arrange(const Arrangement& wanted) override {
    const std::string todo = standing_ ? instruction(*standing_, wanted) : full_instruction(wanted);
    if (!todo.empty()) {
      standing_.reset();  // until the person confirms, the bench may be half way
      ask_or_end(asked_, {.text = todo});
    }
    standing_ = wanted;
  }
  void correct(const std::string& what) override { ask_or_end(asked_, {.text = what}); }

 private:
  AskedPerson& asked_;
  std::optional<Arrangement> standing_;
};

}  // namespace

std::unique_ptr<Operator> make_console_operator(AskedPerson& asked) {
  return std::make_unique<ConsoleOperator>(asked);
}

}  // namespace rig
