#include "station/bench/drawing_operator.h"

#include <array>

#include "station/documents/plan_file.h"

namespace station {
namespace {

class DrawingOperator final : public rig::Operator {
 public:
  DrawingOperator(rig::Operator& person, rig::AskedPerson& asked) : person_(person), asked_(asked) {}

  void arrange(const rig::Arrangement& wanted) override {
    asked_.prepare({{"arrangement", arrangement_document(wanted)}}, "\n" + drawing(wanted));
    person_.arrange(wanted);
  }
  void correct(const std::string& what) override { person_.correct(what); }

 private:
  rig::Operator& person_;
  rig::AskedPerson& asked_;
};

const char* name_of(rig::BenchObject object) {
  switch (object) {
    case rig::BenchObject::nothing:
      return "nothing";
    case rig::BenchObject::board:
      return "board";
    case rig::BenchObject::spectralon:
      return "spectralon";
    case rig::BenchObject::holder:
      return "holder";
    case rig::BenchObject::colour_chart:
      return "colour_chart";
    case rig::BenchObject::cylinder:
      return "cylinder";
  }
  return "";
}

}  // namespace

std::string drawing(const rig::Arrangement& wanted) {
  const bool back = wanted.lamp == rig::Lamp::back, front = wanted.lamp == rig::Lamp::front,
             left = wanted.lamp == rig::Lamp::front_left;
  const bool cylinder = wanted.object == rig::BenchObject::cylinder;
  std::array<std::string, 7> lines = {cylinder ? "   from above                    the cylinder"
                                               : "   from above                    the holder's front",
                                      back ? "       (*) lamp ON, behind" : "",
                                      "     .-------.",
                                      cylinder ? "     |  (_)  |  platform" : "     | ===== |  platform",
                                      "     '-------'",
                                      front  ? "           (*) lamp ON, in front"
                                      : left ? "  (*) lamp ON, in front on the left"
                                      : back ? ""
                                             : "       lamp OFF",
                                      std::string("      [cam]    room light ") + (wanted.room_light ? "ON" : "OFF")};
  if (wanted.object == rig::BenchObject::holder) {
    const bool vertical = wanted.mounting == rig::Mounting::vertical;
    const std::array<std::string, 5> holder = {
        "+-----------+", vertical ? "|  | | | |  |" : "|  -------  |", vertical ? "|  | | | |  |" : "|  -------  |",
        vertical ? "|  | | | |  |  threads upright" : "|  -------  |  threads lying", "+-----------+"};
    for (std::size_t i = 0; i < holder.size(); ++i) {
      std::string& line = lines.at(i + 1);
      line.resize(34, ' ');
      line += holder.at(i);
    }
  }
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

nlohmann::json arrangement_document(const rig::Arrangement& wanted) {
  return {{"object", name_of(wanted.object)},  {"mounting", mounting_name(wanted.mounting)},
          {"on_platform", wanted.on_platform}, {"stand", wanted.stand},
          {"on_its_side", wanted.on_its_side}, {"kept_moving", wanted.kept_moving},
          {"lamp", lamp_name(wanted.lamp)},    {"room_light", wanted.room_light}};
}

std::unique_ptr<rig::Operator> make_drawing_operator(rig::Operator& person, rig::AskedPerson& asked) {
  return std::make_unique<DrawingOperator>(person, asked);
}

}  // namespace station
