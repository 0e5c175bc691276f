#include "tests/station/batch/slurm_here.h"

#include <arpa/inet.h>
#include <pwd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;

bool comes_true(double at_most_s, const std::function<bool()>& asked) {
  const auto begin = std::chrono::steady_clock::now();
  while (!asked()) {
    if (std::chrono::steady_clock::now() - begin > std::chrono::duration<double>(at_most_s)) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  return true;
}

// Ports that were free a moment ago, all different.
std::array<int, 3> free_ports() {
  std::array<int, 3> sockets{}, ports{};
  for (std::size_t i = 0; i < ports.size(); ++i) {
    sockets.at(i) = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};
    socklen_t size = sizeof address;
    ::bind(sockets.at(i), reinterpret_cast<sockaddr*>(&address), size);
    ::getsockname(sockets.at(i), reinterpret_cast<sockaddr*>(&address), &size);
    ports.at(i) = ntohs(address.sin_port);
  }
  for (const int socket : sockets) ::close(socket);
  return ports;
}

std::string host_name() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  const std::string whole = name.data();
  return whole.substr(0, whole.find('.'));
}

void run(const std::string& command) {
  const ProgramResult result = run_shell(command);
  if (result.status != 0) throw std::runtime_error(command + ": " + result.out + result.error);
}

void write_key(const fs::path& file) {
  std::ofstream key(file, std::ios::binary);
  std::random_device random;
  for (int i = 0; i < 256; ++i) key.put(static_cast<char>(random()));
  key.close();
  fs::permissions(file, fs::perms::owner_read);
}

}  // namespace

SlurmHere::SlurmHere(const fs::path& folder) : folder_(folder) {
  const passwd* known = ::getpwuid(::getuid());
  const std::string in = folder.string() + "/", host = host_name(), user = known ? known->pw_name : "root";
  for (const char* name : {"state", "spool.here1", "spool.here2", "temporary"}) fs::create_directory(in + name);
  write_key(in + "munge.key");
  const auto [controller, first, second] = free_ports();
  std::ofstream(in + "slurm.conf")
      << "ClusterName=here\nSlurmctldHost=" << host << "(127.0.0.1)\nSlurmUser=" << user << "\nSlurmdUser=" << user
      << "\nSlurmctldPort=" << controller << "\nAuthType=auth/munge\nAuthInfo=socket=" << in
      << "munge.socket\nCredType=cred/munge\nStateSaveLocation=" << in << "state\nSlurmdSpoolDir=" << in
      << "spool.%n\nSlurmctldPidFile=" << in << "slurmctld.pid\nSlurmdPidFile=" << in
      << "%n.pid\nSlurmctldLogFile=" << in << "slurmctld.log\nSlurmdLogFile=" << in
      << "%n.log\nProctrackType=proctrack/linuxproc\n"
      << "TaskPlugin=task/none\nSelectType=select/cons_tres\nSelectTypeParameters=CR_Core_Memory\n"
      << "SlurmdParameters=config_overrides\nReturnToService=2\nSlurmdTimeout=5\nKillWait=2\nMpiDefault=none\n"
      << "PreemptType=preempt/partition_prio\nPreemptMode=REQUEUE\nSchedulerParameters=sched_interval=1,bf_interval=1\n"
      << "MaxArraySize=32\nJobCompType=jobcomp/filetxt\nJobCompLoc=" << in << "completed.txt\n"
      << "NodeName=here1 NodeHostname=" << host << " NodeAddr=127.0.0.1 Port=" << first << " CPUs=" << kCores
      << " RealMemory=3000\nNodeName=here2 NodeHostname=" << host << " NodeAddr=127.0.0.1 Port=" << second
      << " CPUs=" << kCores << " RealMemory=3000\nPartitionName=low Nodes=ALL Default=YES PriorityTier=1\n"
      << "PartitionName=high Nodes=ALL PriorityTier=9\n";
  ::setenv("SLURM_CONF", (in + "slurm.conf").c_str(), 1);
  try {
    start();
  } catch (const std::runtime_error&) {
    stop();
    throw;
  }
}

void SlurmHere::start() const {
  const std::string in = folder_.string() + "/";
  run("PATH=$PATH:/usr/sbin munged --force --num-threads=2 --socket=" + in + "munge.socket --key-file=" + in +
      "munge.key --pid-file=" + in + "munged.pid --log-file=" + in + "munged.log --seed-file=" + in + "munge.seed");
  run("PATH=$PATH:/usr/sbin slurmctld -i");
  for (const int node : {1, 2}) start_node(node);
  if (!comes_true(60, [] { return said("sinfo --noheader --states=idle --partition=low --format=%D") == "2\n"; }))
    throw std::runtime_error("Slurm does not come up: " + said("sinfo") + said("tail -n 20 " + in + "*.log"));
}

SlurmHere::~SlurmHere() {
  said("scancel --me");
  stop();
}

void SlurmHere::stop() const {
  for (const char* file : {"here1.pid", "here2.pid", "slurmctld.pid", "munged.pid"})
    if (const pid_t process = pid_in(file)) ::kill(process, SIGKILL);
  // What nodes that were killed have left, and tasks.
  said("for step in $(pgrep slurmstepd); do grep -qz " + folder_.string() +
       " /proc/$step/environ && kill -KILL $step; done; pkill -KILL -f " + folder_.parent_path().string());
  ::unsetenv("SLURM_CONF");
}

pid_t SlurmHere::pid_in(const std::string& file) const {
  pid_t process = 0;
  std::ifstream(folder_ / file) >> process;
  return process;
}

void SlurmHere::kill_node(int number) const {
  const std::string name = "here" + std::to_string(number);
  if (const pid_t process = pid_in(name + ".pid")) ::kill(process, SIGKILL);
  // A computer that loses its power: what ran on it ends too.
  said("for step in $(pgrep slurmstepd); do for task in $(pgrep -P $step); do grep -qz SLURMD_NODENAME=" + name +
       " /proc/$task/environ && kill -KILL $step && pkill -KILL -s $task; done; done; true");
}

void SlurmHere::start_node(int number) const {
  run("PATH=$PATH:/usr/sbin slurmd -N here" + std::to_string(number));
}

int SlurmHere::queued() {
  return std::stoi(said("squeue --noheader --array | wc -l"));
}

int SlurmHere::running() {
  return std::stoi(said("squeue --noheader --array --states=running | wc -l"));
}

bool SlurmHere::wait_until_empty(double at_most_s) const {
  return comes_true(at_most_s, [] { return queued() == 0; });
}

std::string SlurmHere::said(const std::string& command) {
  const ProgramResult result = run_shell(command);
  return result.out + result.error;
}

}  // namespace station_test
