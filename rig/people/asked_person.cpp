#include "rig/people/asked_person.h"

namespace rig {

std::string ask_or_end(AskedPerson& asked, const Question& question) {
  const std::optional<std::string> answer = asked.ask(question);
  if (!answer) {
    throw Declined("asked to: \"" + question.text +
                   "\", but the input ended before anybody answered; run it at a terminal");
  }
  if (*answer == kDecline)
    throw Declined("asked to: \"" + question.text + "\", and the person declined; resume when it can be done");
  return *answer;
}

}  // namespace rig
