// What a person at a terminal is shown before being asked.
#include "station/bench/drawing_operator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "tests/support/fake_devices.h"

namespace station {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(DrawingOperator, EveryArrangementHasADrawingOfItsOwnThatFitsATerminal) {
  std::set<std::string> drawings;
  for (const rig::Mounting mounting : {rig::Mounting::horizontal, rig::Mounting::vertical})
    for (const rig::Lamp lamp : {rig::Lamp::off, rig::Lamp::front, rig::Lamp::back})
      for (const bool room_light : {false, true}) {
        const std::string text = drawing({.object = rig::BenchObject::holder,
                                          .mounting = mounting,
                                          .on_platform = true,
                                          .lamp = lamp,
                                          .room_light = room_light});
        drawings.insert(text);
        EXPECT_THAT(text, HasSubstr(room_light ? "room light ON" : "room light OFF"));
        EXPECT_THAT(text, HasSubstr(mounting == rig::Mounting::vertical ? "upright" : "lying"));
        EXPECT_THAT(text, HasSubstr(lamp == rig::Lamp::off ? "lamp OFF" : "lamp ON"));
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 70U) << line;
      }
  EXPECT_EQ(drawings.size(), 12U);
}

TEST(DrawingOperator, DrawsAndThenAsks) {
  FakePerson person;
  std::istringstream in;
  std::ostringstream out;
  make_drawing_operator(person, *rig::make_person_at_terminal(in, out))
      ->arrange({.object = rig::BenchObject::holder, .lamp = rig::Lamp::back});
  EXPECT_EQ(person.asked.size(), 1U);
  EXPECT_THAT(out.str(), HasSubstr("behind"));
}

}  // namespace
}  // namespace station
