#include "rig/people/practice_operator.h"

#include <utility>

namespace rig {
namespace {

class PracticeOperator final : public Operator {
 public:
  PracticeOperator(std::unique_ptr<Operator> person, std::unique_ptr<Operator> hand)
      : person_(std::move(person)), hand_(std::move(hand)) {}

  void arrange(const Arrangement& wanted) override {
    person_->arrange(wanted);
    hand_->arrange(wanted);
  }
  void correct(const std::string& what) override {
    person_->correct(what);
    hand_->correct(what);
  }

 private:
  std::unique_ptr<Operator> person_, hand_;
};

}  // namespace

std::unique_ptr<Operator> make_practice_operator(std::unique_ptr<Operator> person, std::unique_ptr<Operator> hand) {
  return std::make_unique<PracticeOperator>(std::move(person), std::move(hand));
}

}  // namespace rig
