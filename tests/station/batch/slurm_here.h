// A Slurm of its own: controller, two nodes and munge as real daemons on this computer, all in one folder and on ports
// of the loopback that were free. Programs that this process starts then belong to it (SLURM_CONF).
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

namespace station_test {

class SlurmHere {
 public:
  static constexpr int kCores = 2;  // of each node

  // Errors: std::runtime_error with what the daemons say when they do not come up.
  explicit SlurmHere(const std::filesystem::path& folder);
  ~SlurmHere();
  SlurmHere(const SlurmHere&) = delete;
  SlurmHere& operator=(const SlurmHere&) = delete;

  // The daemon of node 1 or 2: killed as by the kernel, its tasks with it; and begun again.
  void kill_node(int number) const;
  void start_node(int number) const;

  static int queued();                                  // tasks that wait or run, of all jobs
  static int running();                                 // those that run
  bool wait_until_empty(double at_most_s) const;        // of jobs
  static std::string said(const std::string& command);  // the output of a command; what went wrong with it otherwise

 private:
  void start() const;
  void stop() const;
  pid_t pid_in(const std::string& file) const;
  std::filesystem::path folder_;
};

}  // namespace station_test
