#include "rig/people/operator.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "rig/devices/degree.h"
#include "rig/people/asked_person.h"

namespace rig {
namespace {

using Sentences = std::vector<std::string>;

std::string mounting_name(Mounting mounting) {
  return mounting == Mounting::horizontal ? "horizontal" : "vertical";
}

std::string join_phrases(const Sentences& phrases) {
  std::string joined;
  for (std::size_t i = 0; i < phrases.size(); ++i)
    joined += (i == 0 ? "" : i + 1 == phrases.size() ? " and " : ", ") + phrases[i];
  return joined;
}

// "12.0 cm above the table and 3.0 cm to the right of the platform's centre"; a millimetre is the finest a hand does.
std::string place_phrase(const Eigen::Vector3d& position_mm) {
  const auto centimetres = [](double mm) {
    const long tenths = std::lround(std::abs(mm));
    return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " cm ";
  };
  const auto away = [](double mm) { return std::lround(mm) != 0; };
  Sentences phrases;
  if (away(position_mm.z()))
    phrases.push_back(centimetres(position_mm.z()) + (position_mm.z() > 0 ? "above the table" : "below the table"));
  if (away(position_mm.x())) {
    phrases.push_back(centimetres(position_mm.x()) + (position_mm.x() > 0 ? "in front of" : "behind") +
                      " the platform's centre");
  }
  if (away(position_mm.y())) {
    phrases.push_back(centimetres(position_mm.y()) + (position_mm.y() > 0 ? "to the right" : "to the left") +
                      " of the platform's centre");
  }
  return phrases.empty() ? "at the platform's centre" : join_phrases(phrases);
}

// Where the face (+z of the object) looks, as the camera sees it.
std::string facing_phrase(const Eigen::Vector3d& normal) {
  const long up = std::lround(std::asin(std::clamp(normal.z(), -1.0, 1.0)) / kDegree);
  if (std::abs(up) > 85) return up > 0 ? "its face up" : "its face down";
  const long right = std::lround(std::atan2(normal.y(), normal.x()) / kDegree);
  Sentences turns;
  if (right != 0)
    turns.push_back("turned " + std::to_string(std::abs(right)) + " degrees to the " + (right > 0 ? "right" : "left"));
  if (up != 0)
    turns.push_back("tilted " + std::to_string(std::abs(up)) + " degrees " + (up > 0 ? "upwards" : "downwards"));
  return turns.empty() ? "its face towards the camera" : "its face " + join_phrases(turns) + " from the camera";
}

bool stands_the_same(const Arrangement& a, const Arrangement& b) {
  if (a.object != b.object || a.object == BenchObject::nothing) return a.object == b.object;
  if (a.kept_moving || b.kept_moving) return a.kept_moving == b.kept_moving;
  return a.on_platform == b.on_platform && a.stand == b.stand && a.on_its_side == b.on_its_side &&
         a.pose.isApprox(b.pose, 1e-6);
}

bool mounted_the_same(const Arrangement& a, const Arrangement& b) {
  return a.object != BenchObject::holder || b.object != BenchObject::holder || a.mounting == b.mounting;
}

std::string remove_sentence(BenchObject object) {
  return "Take " + object_name(object) + " away.";
}

std::string place_sentence(const Arrangement& to) {
  const std::string name = object_name(to.object);
  if (to.object == BenchObject::holder) {
    return "Put the holder " +
           std::string(to.on_platform ? "on the platform, its front towards the camera"
                                      : place_phrase(to.pose.translation())) +
           ", with the threads " + mounting_name(to.mounting) + ".";
  }
  if (to.object == BenchObject::cylinder)
    return "Stand the cylinder with the cloth upright in the middle of the platform, its seam away from the camera.";
  if (to.kept_moving) {
    return "Hold " + name +
           " close before the lens, so that its white face fills the picture, and move it gently to and fro until the "
           "next instruction.";
  }
  if (to.stand > 0) {
    return "Put " + name + (to.on_its_side ? ", on its side," : "") + " on stand " + std::to_string(to.stand) +
           ", in the middle of the platform, its face towards the camera; 3 cm or 15 degrees off do no harm.";
  }
  return (to.on_platform ? "Stand " + name + " on the platform, " : "Hold " + name + " ") +
         place_phrase(to.pose.translation()) + ", " + facing_phrase(to.pose.linear().col(2)) + ".";
}

std::string mounting_sentence(Mounting to) {
  return "Turn the holder so that the threads are " + mounting_name(to) + ".";
}

std::string lamp_sentence(Lamp to, bool is_on) {
  if (to == Lamp::off) return "Switch the flashlight off.";
  const std::string where = to == Lamp::front        ? "in front of the platform"
                            : to == Lamp::front_left ? "in front of the platform, on the left"
                                                     : "behind the platform";
  return is_on ? "Move the flashlight " + where + "." : "Put the flashlight " + where + " and switch it on.";
}

std::string room_sentence(bool on) {
  return on ? "Switch the room light on." : "Switch the room light off.";
}

std::string join_sentences(const Sentences& sentences) {
  std::string joined;
  for (const std::string& sentence : sentences) joined += (joined.empty() ? "" : " ") + sentence;
  return joined;
}

}  // namespace

std::string object_name(BenchObject object) {
  switch (object) {
    case BenchObject::board:
      return "the printed target";
    case BenchObject::spectralon:
      return "the Spectralon target";
    case BenchObject::holder:
      return "the holder";
    case BenchObject::colour_chart:
      return "the colour chart";
    case BenchObject::cylinder:
      return "the cylinder";
    case BenchObject::nothing:
      break;
  }
  return "nothing";
}

bool same_arrangement(const Arrangement& a, const Arrangement& b) {
  return stands_the_same(a, b) && mounted_the_same(a, b) && a.lamp == b.lamp && a.room_light == b.room_light;
}

void Operator::correct(const std::string& what) {
  throw Declined(what);
}

std::string instruction(const Arrangement& from, const Arrangement& to) {
  Sentences sentences;
  if (from.object != to.object && from.object != BenchObject::nothing)
    sentences.push_back(remove_sentence(from.object));
  if (!stands_the_same(from, to) && to.object != BenchObject::nothing) {
    // Another mounting has another pose; turning the holder is all that a person has to know about it.
    const bool only_turned = from.on_platform && to.on_platform && !mounted_the_same(from, to);
    sentences.push_back(only_turned ? mounting_sentence(to.mounting) : place_sentence(to));
  } else if (!mounted_the_same(from, to)) {
    sentences.push_back(mounting_sentence(to.mounting));
  }
  if (from.lamp != to.lamp) sentences.push_back(lamp_sentence(to.lamp, from.lamp != Lamp::off));
  if (from.room_light != to.room_light) sentences.push_back(room_sentence(to.room_light));
  return join_sentences(sentences);
}

std::string full_instruction(const Arrangement& to) {
  const std::string object =
      to.object == BenchObject::nothing ? "Take away whatever stands on the platform." : place_sentence(to);
  return join_sentences({object, lamp_sentence(to.lamp, false), room_sentence(to.room_light)});
}

}  // namespace rig
