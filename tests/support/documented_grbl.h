// A second simulation of GRBL 1.1, for tests: written from the documentation of its interface alone (gnea/grbl,
// doc/markdown: interface, commands, settings, jogging), it shares nothing with rig/simulated but the interfaces of
// line and clock. A driver that works on both does not lean on the peculiarities of either.
//
// It turns a platform by its X axis; Y and Z have no motor that matters. Time is the clock's: the board comes up to it
// whenever somebody reads, writes or asks. A line that arrives is obeyed when time has gone on, real-time characters at
// once, so that a hold may overtake the line before it. Every function may be called from any thread.
//
// Not here: arcs, probing, work coordinates but G92, overrides, the safety door, sleep, check mode, startup lines.
// Where the documents leave something open, it does what is worse for a driver: status questions while it homes are
// never answered, and a reset in motion makes the platform coast on uncounted.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "rig/devices/clock.h"
#include "rig/turntables/byte_line.h"

struct DocumentedGrblOptions {
  enum class Homing { z_first, x_only };  // what $H does: Z, then X and Y, as the firmware comes; or X alone
  double steps_per_deg = 40;              // of the motor, whatever $100 says
  double stands_at_deg = 50;              // where the platform stands when the power comes
  std::optional<double> switch_deg = 2;   // the home switch closes here, on the way in positive direction
  double switch_width_deg = 1;            // and is closed for so long
  bool switches_on_other_axes = false;    // which end their homing at once
  Homing homing = Homing::x_only;
  bool homes_single_axis = false;  // the H in [OPT:...]: it knows $HX
  bool resets_when_opened = true;  // as an Arduino does
  double boot_s = 1.5;             // until a board that was reset by its port greets
  std::map<int, double> eeprom;    // settings that differ from those that GRBL comes with
};

// What a turntable of 40 steps per degree, 30 deg/s and 150 deg/s^2 with a home switch needs.
std::map<int, double> documented_turntable_settings();

class DocumentedGrbl {
 public:
  // The power comes on. `clock` must outlive the board and its lines.
  explicit DocumentedGrbl(rig::Clock& clock, const DocumentedGrblOptions& options = {});

  std::unique_ptr<rig::ByteLine> open();  // throws std::runtime_error while another line is open
  void unplug();                          // lines throw rig::Unplugged
  void plug_in();                         // the power comes back; the position is forgotten, the settings are not

  struct Place {
    double at_s = 0, platform_deg = 0;
  };
  double platform_deg();  // the true angle
  bool turning();
  std::vector<Place> log();  // every 5 ms while it turns, and where it stood at last
  std::map<int, double> settings();
  void close_end_switch();  // the platform runs into one that its limit settings heed

 private:
  class Board;
  class Line;
  rig::Clock& clock_;
  std::shared_ptr<Board> board_;
};
