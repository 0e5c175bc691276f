// The part of a session that a person does: what stands on the bench, where the flashlight is, the room's light.
//
// World frame: +z up along the platform's axis, +x towards the camera, so +y is to the right as the camera sees it.
// Frame of the board, the Spectralon target and the colour chart: +z out of the face, +x right and +y up for who looks
// at the face.
#pragma once

#include <Eigen/Geometry>
#include <string>

namespace rig {

// cylinder: black, with cloth wrapped round it; its frame has its origin in the middle of its foot and +z up.
enum class BenchObject { nothing, board, spectralon, holder, colour_chart, cylinder };
enum class Mounting { horizontal, vertical };      // direction of the threads on the holder
enum class Lamp { off, front, back, front_left };  // front_left: front, mirrored in the plane of camera and axis

// The whole arrangement that is wanted; a person (or a motor) makes the differences.
struct Arrangement {
  BenchObject object = BenchObject::nothing;
  Mounting mounting = Mounting::horizontal;  // holder only
  bool on_platform = false;                  // true: turns with the platform
  int stand = 0;                             // on the platform: which of the stands holds the object; 0: none
  bool on_its_side = false;                  // on a stand: a quarter turn, so that the object's +x is up
  bool kept_moving = false;                  // in the hand, which moves it gently about: its pose is one of many
  // Where the object should stand: platform_from_object (platform frame at angle 0 = world) when on_platform,
  // world_from_object otherwise. A hand places it only roughly so.
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Lamp lamp = Lamp::off;
  bool room_light = false;
};

// True when a person has nothing to do between the two: a pose counts to a millionth and not at all while the object is
// kept moving, the mounting only for the holder, and none of them when nothing stands there.
bool same_arrangement(const Arrangement& a, const Arrangement& b);

std::string object_name(BenchObject object);  // "the printed target"

// One sentence per thing to do, for a person: from what stands now to what is wanted; empty when nothing is to be
// done.
std::string instruction(const Arrangement& from, const Arrangement& to);

// The same when it is not known what stands now: every part of the arrangement is said.
std::string full_instruction(const Arrangement& to);

class Operator {
 public:
  virtual ~Operator() = default;
  // Returns when the bench is in the wanted arrangement; throws Declined (asked_person.h) when the person declines.
  virtual void arrange(const Arrangement& wanted) = 0;
  // Asks to put right what was seen to stand wrongly, in whole sentences, and returns when that is done. Throws
  // Declined when the person declines, and where nobody is asked.
  virtual void correct(const std::string& what);
};

}  // namespace rig
