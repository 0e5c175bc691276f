#include "station/drawing_operator.h"

#include <array>
#include <ostream>

namespace station {
namespace {

class DrawingOperator final : public rig::Operator {
 public:
  DrawingOperator(rig::Operator& person, std::ostream& out) : person_(person), out_(out) {}

  void arrange(const rig::Arrangement& wanted) override {
    out_ << "\n" << drawing(wanted) << std::flush;
    person_.arrange(wanted);
  }

 private:
  rig::Operator& person_;
  std::ostream& out_;
};

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

std::unique_ptr<rig::Operator> make_drawing_operator(rig::Operator& person, std::ostream& out) {
  return std::make_unique<DrawingOperator>(person, out);
}

}  // namespace station
