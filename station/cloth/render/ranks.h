// The processes ("ranks") that draw one picture together, where mpirun or srun started this one with others (MPI);
// otherwise this process alone. Each weaves and builds the scene, draws a share of the tiles, and hands what it drew
// to the first, which alone reads and writes files beside its own part of a checkpoint.
//
// All members but tell() are called by all ranks in the same order. Who waits for the others asks every 50 ms whether
// ctrl-C came (output/interrupt.h).
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <string>

#include "renderer/trace/path_tracer.h"

namespace station {

// One rank ends because all do, and the first says why.
struct EndsWithOthers : std::exception {
  const char* what() const noexcept override { return "this process ends with the others of its rendering"; }
};

class RenderRanks {
 public:
  RenderRanks();  // this process alone
  // It and those that it was started with; once in a process. Errors: std::runtime_error, one line, where several were
  // started that cannot talk to each other.
  static RenderRanks started();
  // Where it is left by an error, the other ranks end as well, after the program has said what it was.
  ~RenderRanks();
  RenderRanks(const RenderRanks&) = delete;
  RenderRanks& operator=(const RenderRanks&) = delete;

  const renderer::TileShare& share() const { return share_; }
  bool alone() const { return share_.of == 1; }
  bool first() const { return share_.number == 0; }
  // Processor threads for this one: `asked` unless that is 0; then what it is bound to, or its part of the computer
  // where the ranks of one computer are not told apart.
  int threads(int asked) const;

  // What the first says, for all. Errors: EndsWithOthers after ctrl-C.
  bool of_first(bool said);
  void of_first(renderer::Film& film);
  // Errors: std::runtime_error, one line, where another rank has another `text`: `what` names what it is of.
  void must_agree(const std::string& text, const std::string& what);

  // The end of a pass (renderer/trace/path_tracer.h): the first's film has all tiles then. `go_on` is asked while it
  // waits; where it says no the next call goes on waiting.
  renderer::PassEnd end_pass(renderer::Film& film, int most_samples, double noise, const std::function<bool()>& go_on);

  // The finished fraction of this share; at the first it returns that of the whole.
  double tell(double finished);
  // After ctrl-C, which mpirun and Slurm hand on to all: waits a while until all have stored what they have.
  void wait_for_parts();
  // The sums over all ranks, at the first; after the last pass.
  renderer::RenderStatistics sum_of(const renderer::RenderStatistics& mine);

 private:
  struct Others;
  explicit RenderRanks(std::unique_ptr<Others> others);
  renderer::TileShare share_;
  std::unique_ptr<Others> others_;  // none where it is alone
};

}  // namespace station
