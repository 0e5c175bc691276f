#include "rig/console_operator.h"

#include <istream>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>

namespace rig {
namespace {

class ConsoleOperator final : public Operator {
 public:
  ConsoleOperator(std::istream& in, std::ostream& out) : in_(in), out_(out) {}

  void arrange(const Arrangement& wanted) override {
    const std::string todo = standing_ ? instruction(*standing_, wanted) : full_instruction(wanted);
    if (!todo.empty()) {
      standing_.reset();  // until the person confirms, the bench may be half way
      out_ << todo << "\nPress Enter when it is done, or q and Enter to end: " << std::flush;
      wait_for_confirmation(todo);
    }
    standing_ = wanted;
  }

 private:
  void wait_for_confirmation(const std::string& todo) {
    std::string answer;
    if (!std::getline(in_, answer)) {
      throw std::runtime_error("asked to: \"" + todo +
                               "\", but the input ended before anybody answered; run it at a terminal");
    }
    if (answer == "q" || answer == "Q") {
      throw std::runtime_error("asked to: \"" + todo + "\", and the person declined; resume when it can be done");
    }
  }

  std::istream& in_;
  std::ostream& out_;
  std::optional<Arrangement> standing_;
};

}  // namespace

std::unique_ptr<Operator> make_console_operator(std::istream& in, std::ostream& out) {
  return std::make_unique<ConsoleOperator>(in, out);
}

}  // namespace rig
