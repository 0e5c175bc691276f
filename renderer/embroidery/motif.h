// An embroidered motif as machines sew it: several threads, and where the needle takes them through the cloth.
//
// Frame: x right, y up, millimetres, the cloth's face towards +z; the origin is the machine's start.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace renderer {

struct MotifThread {
  std::string name;                                  // in the colour chart; empty: unknown
  std::optional<std::array<unsigned char, 3>> srgb;  // as shown on a screen; some formats have none
};

// One uncut length of thread: it lies straight on the cloth from each needle point to the next.
struct StitchRun {
  int thread = 0;                              // into Motif::threads
  std::vector<Eigen::Vector2d> needle_points;  // mm, at least one
};

struct Motif {
  std::string name;
  std::vector<MotifThread> threads;  // one per colour stop, in the order of sewing
  std::vector<StitchRun> runs;       // in the order of sewing: later ones lie on top
};

struct MotifMeasures {
  int stitches = 0;                                           // from needle point to needle point, all threads
  std::vector<int> stitches_of_threads;                       // by thread
  std::vector<double> lengths_mm;                             // of thread on the face, by thread
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = low;  // of all needle points
};
MotifMeasures measure(const Motif& motif);

// Records a motif move by move, as machine files have it: moves are relative, with or without the needle.
class MotifRecorder {
 public:
  MotifRecorder() { motif_.threads.emplace_back(); }

  void stitch(const Eigen::Vector2d& move_mm);  // moves, and sews down with the needle
  void jump(const Eigen::Vector2d& move_mm);    // moves without the needle; the thread follows with the next stitch
  void trim();                                  // cuts the thread
  void next_thread();                           // cuts the thread and takes the next one

  const Eigen::Vector2d& at() const { return at_; }
  Motif& motif() { return motif_; }

 private:
  Motif motif_;
  Eigen::Vector2d at_ = Eigen::Vector2d::Zero();
  bool cut_ = true;
};

}  // namespace renderer
