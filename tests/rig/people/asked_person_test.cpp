// Questions to a person: as text at a terminal, as documents behind a program.
#include "rig/people/asked_person.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <mutex>
#include <sstream>

#include "tests/rig/people/terminal.h"

namespace {

using nlohmann::json;
using testing::HasSubstr;

struct BehindProgram : testing::Test {
  rig::AskedPerson& with(const std::string& answers) {
    in.str(answers);
    person = rig::make_person_behind_program(in, out);
    return *person;
  }
  std::vector<json> said() const {
    std::vector<json> documents;
    std::istringstream lines(out.str());
    for (std::string line; std::getline(lines, line);) documents.push_back(json::parse(line));
    return documents;
  }
  std::istringstream in;
  std::ostringstream out;
  std::unique_ptr<rig::AskedPerson> person;
};

}  // namespace

TEST(PersonAtTerminal, IsAskedInWordsAndAnswersWithAKey) {
  rig_test::Terminal terminal("\n  \nQ\nyes\n");
  const rig::Question question{.text = "Do it.", .remark = "It is not done."};
  EXPECT_EQ(terminal.person->ask(question), rig::kDone);
  EXPECT_EQ(terminal.out.str(), "It is not done.\nDo it.\nPress Enter when it is done, or q and Enter to end: ");
  EXPECT_EQ(terminal.person->ask(question), rig::kDone);
  EXPECT_EQ(terminal.person->ask(question), rig::kDecline);
  EXPECT_EQ(terminal.person->ask(question), rig::kDone) << "whatever else is typed";
  EXPECT_EQ(terminal.person->ask(question), std::nullopt);
}

TEST_F(BehindProgram, AQuestionIsALineWithAnIdItsChoicesAndWhatItIsAbout) {
  with("{\"id\": 1, \"answer\": \"done\"}\n{\"id\": 2, \"answer\": \"decline\"}\n");
  person->prepare({{"step", 2}, {"of", 17}, {"arrangement", {{"lamp", "front"}}}}, "a drawing");
  EXPECT_EQ(person->ask({.text = "Do it."}), rig::kDone);
  person->prepare({{"arrangement", nullptr}, {"step", 3}}, "");
  EXPECT_EQ(person->ask({.text = "Do that.", .typed = "an angle", .remark = "\"No\".", .turn_to_deg = 15}),
            rig::kDecline);
  const json choices{{{"answer", "done"}, {"label", "Done"}}, {{"answer", "decline"}, {"label", "Cannot be done now"}}};
  EXPECT_EQ(said(), (std::vector<json>{{{"question",
                                         {{"id", 1},
                                          {"text", "Do it."},
                                          {"choices", choices},
                                          {"step", 2},
                                          {"of", 17},
                                          {"arrangement", {{"lamp", "front"}}}}}},
                                       {{"question",
                                         {{"id", 2},
                                          {"text", "Do that."},
                                          {"choices", choices},
                                          {"typed", "an angle"},
                                          {"remark", "\"No\"."},
                                          {"turn_to_deg", 15.0},
                                          {"step", 3},
                                          {"of", 17}}}}}));
}

TEST_F(BehindProgram, AnAnswerToAnotherQuestionIsNotTakenAndSaidToBeSo) {
  with(
      "{\"id\": 1, \"answer\": \"done\"}\n{\"id\": 1, \"answer\": \"done\"}\n\nq\n[2]\n{\"id\": 2, \"answer\": "
      "\"perhaps\"}\n{\"id\": 2, \"answer\": true}\n{\"id\": 2, \"answer\": \"decline\"}\n");
  EXPECT_EQ(person->ask({.text = "Do it."}), rig::kDone);
  EXPECT_EQ(person->ask({.text = "Do that."}), rig::kDecline);
  const auto documents = said();
  ASSERT_EQ(documents.size(), 8U);
  for (std::size_t i = 2; i < documents.size(); ++i)
    EXPECT_THAT(documents[i].at("note").get<std::string>(), HasSubstr("question 2 is open"));
}

TEST_F(BehindProgram, WhatIsTypedIsTakenWhereTheQuestionAllowsIt) {
  with("{\"id\": 1, \"answer\": \"30,2\"}\n");
  EXPECT_EQ(person->ask({.text = "Turn it.", .typed = "an angle"}), "30,2");
  EXPECT_EQ(person->ask({.text = "Turn it."}), std::nullopt) << "the input has ended";
}

TEST_F(BehindProgram, ADeclinedQuestionEndsTheWork) {
  with("{\"id\": 1, \"answer\": \"done\"}\n{\"id\": 2, \"answer\": \"decline\"}\n");
  EXPECT_EQ(rig::ask_or_end(*person, {.text = "Do it."}), rig::kDone);
  EXPECT_THROW(rig::ask_or_end(*person, {.text = "Do it."}), std::runtime_error);
  EXPECT_THROW(rig::ask_or_end(*person, {.text = "Do it."}), std::runtime_error);
}

TEST_F(BehindProgram, ATextWithBytesThatAreNoTextIsAskedAllTheSame) {
  with("{\"id\": 1, \"answer\": \"done\"}\n");
  EXPECT_EQ(person->ask({.text = "Put \xff on the holder."}), rig::kDone);
}

// The person types nothing until the program has answered by itself; then the line belongs to the next question.
TEST_F(BehindProgram, WhatIsSeenMayAnswerAndALateLineAnswersNothing) {
  std::mutex typing;
  struct HeldLine : std::stringbuf {
    HeldLine(std::mutex& until, const std::string& text) : std::stringbuf(text), mutex(until) {}
    int_type underflow() override {
      const std::scoped_lock wait(mutex);
      return std::stringbuf::underflow();
    }
    std::mutex& mutex;
  } held(typing, "");
  std::istream slow(&held);
  auto person_behind = rig::make_person_behind_program(slow, out);
  typing.lock();
  int looks = 0;
  const rig::Question watched{.text = "Put it down.", .meanwhile = [&]() -> std::optional<std::string> {
                                person_behind->remark("not yet");
                                return ++looks == 3 ? std::optional<std::string>(rig::kDone) : std::nullopt;
                              }};
  EXPECT_EQ(person_behind->ask(watched), rig::kDone);
  held.str("{\"id\": 1, \"answer\": \"done\"}\n{\"id\": 2, \"answer\": \"decline\"}\n");
  typing.unlock();
  EXPECT_EQ(person_behind->ask({.text = "Do that."}), rig::kDecline);
  EXPECT_EQ(looks, 3);
  const std::vector<json> lines = said();
  EXPECT_EQ(lines.at(1), (json{{"remark", {{"id", 1}, {"text", "not yet"}}}}));
  EXPECT_EQ(lines.at(4), (json{{"answered", 1}}));
  EXPECT_THAT(lines.at(6).at("note").get<std::string>(), HasSubstr("was not taken: question 2 is open"));
}
