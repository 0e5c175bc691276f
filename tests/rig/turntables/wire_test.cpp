// The drivers over pseudo-terminals, by the plain line and by libserialport: what a wire adds to the line without one.
// The firmware answers in real time, the platform turns in the injected clock's time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <signal.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <future>
#include <mutex>
#include <thread>

#include "rig/devices/device_contract.h"
#include "rig/simulated/pty_server.h"
#include "rig/turntables/serial_line.h"
#include "tests/rig/turntables/wired_bench.h"
#include "tests/support/refusal.h"

namespace {

using rig::kDegree;
using testing::HasSubstr;

using Rig = WiredBench<EventfulClock>;
enum class Line { pty, serial };

std::unique_ptr<rig::ByteLine> open_line(Line kind, const std::string& path) {
  return kind == Line::pty ? rig::open_pty_line(path) : rig::open_serial_line({.port = path, .usb_serial = ""});
}

class FolderOfLinks {
 public:
  FolderOfLinks() {
    std::string name = std::filesystem::temp_directory_path() / "linksXXXXXX";
    folder_ = mkdtemp(name.data());
  }
  ~FolderOfLinks() { std::filesystem::remove_all(folder_); }
  FolderOfLinks(const FolderOfLinks&) = delete;
  FolderOfLinks& operator=(const FolderOfLinks&) = delete;
  std::string make(const std::string& name, const std::string& target) const {
    std::filesystem::create_symlink(target, folder_ / name);
    return folder_ / name;
  }

 private:
  std::filesystem::path folder_;
};

// Sends a thread one signal after another, which end the system calls that they meet (no SA_RESTART).
class SignalsTo {
 public:
  explicit SignalsTo(pthread_t receiver) {
    struct sigaction action {};
    action.sa_handler = [](int) {};
    sigemptyset(&action.sa_mask);
    sigaction(SIGUSR1, &action, &before_);
    sender_ = std::jthread([this, receiver](const std::stop_token& ending) {
      for (; !ending.stop_requested(); ++sent_) {
        pthread_kill(receiver, SIGUSR1);
        std::this_thread::sleep_for(std::chrono::microseconds(20));
      }
    });
  }
  ~SignalsTo() {
    sender_.request_stop();
    sender_.join();
    sigaction(SIGUSR1, &before_, nullptr);
  }
  SignalsTo(const SignalsTo&) = delete;
  SignalsTo& operator=(const SignalsTo&) = delete;
  int sent() const { return sent_; }

 private:
  struct sigaction before_ {};
  std::atomic<int> sent_ = 0;
  std::jthread sender_;
};

// A port that does as the one behind it does.
class PassedOn : public rig::SimulatedPort {
 public:
  explicit PassedOn(std::shared_ptr<rig::SimulatedPort> port) : port_(std::move(port)) {}
  void power_on() override { port_->power_on(); }
  void opened() override { port_->opened(); }
  void receive(std::string_view bytes) override { port_->receive(bytes); }
  std::string transmit() override { return port_->transmit(); }
  void unplug() override { port_->unplug(); }
  bool plugged() override { return port_->plugged(); }
  int operations() override { return port_->operations(); }

 private:
  std::shared_ptr<rig::SimulatedPort> port_;
};

struct Wire : testing::TestWithParam<std::tuple<Protocol, Line>> {
  Wire() {
    rig.setup.reply_timeout_s = 20;  // real time here; answers come at once, however busy the computer is
    rig.setup.banner_timeout_s = 1;
    rig.open_line = [this] { return open_line(line(), server->path()); };
  }
  static Protocol protocol() { return std::get<0>(GetParam()); }
  static Line line() { return std::get<1>(GetParam()); }

  Rig rig{protocol()};
  std::unique_ptr<rig::PtyServer> server = rig::serve_on_pty(rig.port);
};

INSTANTIATE_TEST_SUITE_P(OverAPty, Wire,
                         testing::Combine(testing::Values(Protocol::grbl, Protocol::zaber),
                                          testing::Values(Line::pty, Line::serial)),
                         [](const auto& wire) {
                           return testing::PrintToString(std::get<0>(wire.param)) +
                                  (std::get<1>(wire.param) == Line::pty ? "OnPty" : "OnSerial");
                         });

}  // namespace

TEST_P(Wire, TheContractOfTurntablesIsKept) {
  rig.clock.pace = 0.02;
  const auto table = rig.make_turntable();
  for (const rig::ContractRow& row : rig::check_turntable(*table, rig.kStepRad))
    EXPECT_TRUE(row.passed) << row.name << ": " << row.what;
  EXPECT_NEAR(rig.true_angle_rad(), 0, 1e-12);
}

// Waiting for longer than the test may take, so that a time-out cannot be mistaken for it.
TEST_P(Wire, APulledPlugIsToldApartFromSilenceWhileReading) {
  const auto open = open_line(line(), server->path());
  open->read(0.2);
  std::thread puller([this] { rig.port->unplug(); });
  EXPECT_THROW(while (true) open->read(3600), rig::Unplugged);
  puller.join();
}

TEST_P(Wire, APulledPlugIsToldWhileWriting) {
  const auto open = open_line(line(), server->path());
  rig.clock.plan(0.5, [this] { rig.port->unplug(); });
  EXPECT_THROW(
      while (true) {
        open->write("?");
        rig.clock.sleep_s(0.1);
        open->read(0.01);
      },
      rig::Unplugged);
  EXPECT_FALSE(rig.clock.planned());
}

// Opening a port starts the board behind it; one that is unplugged in that very moment is not started again.
TEST_P(Wire, APlugPulledWhileTheLineIsOpenedStaysPulled) {
  class PulledWhenOpened final : public PassedOn {
   public:
    PulledWhenOpened(const std::shared_ptr<rig::SimulatedPort>& port, std::future<void> has_line)
        : PassedOn(port), has_line_(std::move(has_line)) {}
    void opened() override {
      has_line_.wait();
      unplug();
      PassedOn::opened();
    }

   private:
    std::future<void> has_line_;
  };
  std::promise<void> has_line;
  server = rig::serve_on_pty(std::make_shared<PulledWhenOpened>(rig.port, has_line.get_future()));
  const auto open = open_line(line(), server->path());
  has_line.set_value();
  const auto write_for_a_while = [&] {
    for (int i = 0; i < 300; ++i) {
      open->write("?");
      open->read(0.01);
    }
  };
  EXPECT_THROW(write_for_a_while(), rig::Unplugged);
  EXPECT_FALSE(rig.port->plugged());
}

// A board hears what was written just before its program ended, be it a stop, even when it is slow to listen.
TEST_P(Wire, WhatWasWrittenJustBeforeTheLineIsClosedIsHeard) {
  class SlowToListen final : public PassedOn {
   public:
    SlowToListen(const std::shared_ptr<rig::SimulatedPort>& port, std::mutex& other_work)
        : PassedOn(port), other_work_(other_work) {}
    std::string transmit() override {
      const std::lock_guard hold(other_work_);
      return PassedOn::transmit();
    }

   private:
    std::mutex& other_work_;
  };
  std::mutex other_work;
  server = rig::serve_on_pty(std::make_shared<SlowToListen>(rig.port, other_work));
  auto open = open_line(line(), server->path());
  open->read(0.2);
  const int before = rig.port->operations();
  {
    const std::lock_guard hold(other_work);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // it waits for its other work by now
    open->write(protocol() == Protocol::zaber ? "/1 1 stop\n" : "!");
    open.reset();
  }
  for (int i = 0; i < 500 && rig.port->operations() == before; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  EXPECT_EQ(rig.port->operations(), before + 1);
}

// The links that the system keeps below /dev/serial; a link to a link is one, too.
TEST_P(Wire, APortIsOpenedByALinkToIt) {
  const FolderOfLinks links;
  const std::string id = links.make("by-id", server->path()), mine = links.make("turntable", id);
  rig.open_line = [&] { return open_line(line(), mine); };
  const auto table = rig.make_turntable();
  table->home();
  EXPECT_NEAR(rig.true_angle_rad(), 0, 1e-12);
  EXPECT_THAT(refusal([&] { open_line(line(), id); }),
              testing::AllOf(HasSubstr("by-id"), HasSubstr("used by another program")));
}

TEST_P(Wire, SilenceIsAnEmptyRead) {
  const auto open = open_line(line(), server->path());
  while (!open->read(0.05).empty()) {
  }
  EXPECT_EQ(open->read(0), "");
}

// A program that is asked to stop gets its signal at any moment, in the middle of a system call of the line too.
TEST_P(Wire, ASignalIsNotTakenForAPulledPlug) {
  const auto open = open_line(line(), server->path());
  const SignalsTo signals(pthread_self());
  const auto use_for_a_while = [&] {
    while (signals.sent() < 20000) {
      open->write("?");
      open->read(0.001);
    }
  };
  EXPECT_NO_THROW(use_for_a_while());
}

TEST_P(Wire, ItIsTakenForOneProgramAlone) {
  const auto open = open_line(line(), server->path());
  EXPECT_THAT(refusal([this] { open_line(line(), server->path()); }), HasSubstr("used by another program; close"));
}

// Whatever program is behind a pseudo-terminal: only what threadstation itself starts is known to be simulated.
TEST(PtyLine, IsCalledAPseudoTerminalAndNotWhatMayBeBehindIt) {
  Rig rig(Protocol::grbl);
  const auto server = rig::serve_on_pty(rig.port);
  const auto open = rig::open_pty_line(server->path());
  const std::string used = refusal([&] { rig::open_pty_line(server->path()); });
  const std::string missing = refusal([] { rig::open_pty_line("/dev/pts/none"); });
  const std::string full = refusal([&] { open->write(std::string(1 << 20, '?')); });
  rig.port->unplug();
  const std::string gone = refusal([&] {
    while (true) open->read(3600);
  });
  for (const std::string& said : {used, missing, full, gone}) {
    EXPECT_THAT(said, HasSubstr("pseudo-terminal /dev/pts/"));
    EXPECT_THAT(said, testing::Not(HasSubstr("the simulated turntable")));
  }
}

TEST_P(Wire, APlugPulledInTheMiddleOfAMoveIsSaidAndAnotherPortIsFoundForHoming) {
  const auto table = rig.make_turntable();
  table->home();
  rig.clock.plan(0.5, [this] { rig.port->unplug(); });  // 15 deg on the way
  EXPECT_THAT(refusal([&] { table->move_to(350 * kDegree); }), HasSubstr("was unplugged"));
  EXPECT_EQ(table->state(), rig::TurntableState::unknown_position);
  EXPECT_THAT(refusal([&] { table->home(); }), testing::AnyOf(HasSubstr("plug"), HasSubstr("start")));
  table->stop();  // nothing is there to be stopped, and nothing fails
  rig.power_on_another();
  server = rig::serve_on_pty(rig.port);
  table->home();
  table->move_to(30 * kDegree);
  EXPECT_NEAR(rig.true_angle_rad(), 30 * kDegree, 1e-12);
}

TEST_P(Wire, SilenceInTheMiddleOfAMoveIsATimeoutAndNoPulledPlug) {
  const auto home_by = protocol() == Protocol::zaber ? rig::HomeBy::home_switch : rig::HomeBy::here;
  Rig silent(protocol(), home_by, {{.at_operation = 60, .fault = rig::LineFault::silence}});
  silent.setup.reply_timeout_s = 2;  // is waited for
  silent.open_line = [this] { return open_line(line(), server->path()); };
  server = rig::serve_on_pty(silent.port);
  const auto table = silent.make_turntable();
  table->home();
  EXPECT_THAT(refusal([&] { table->move_to(300 * kDegree); }), HasSubstr("did not answer"));
  EXPECT_EQ(table->state(), rig::TurntableState::unknown_position);
  server.reset();  // before the rig that it serves
}

TEST_P(Wire, AStopFromAnotherThreadReachesTheMotorWhileTheMoverSleeps) {
  const auto table = rig.make_turntable();
  table->home();
  rig.clock.plan(1, [&] { std::thread([&] { table->stop(); }).join(); });  // 30 deg on the way
  EXPECT_THAT(refusal([&] { table->move_to(350 * kDegree); }), HasSubstr("was stopped at"));
  EXPECT_LT(rig.true_angle_rad(), 340 * kDegree);
  EXPECT_NEAR(table->angle_rad(), rig.true_angle_rad(), 1e-12);
}

TEST(SerialLine, SaysBothNamesOfAPortThatIsALink) {
  const FolderOfLinks links;
  const std::string nowhere = links.make("by-path", "../../ttyUSB7");
  EXPECT_THAT(refusal([&] { rig::open_serial_line({.port = nowhere, .usb_serial = ""}); }),
              testing::AllOf(HasSubstr("the port " + nowhere + " is a link to ../../ttyUSB7, which is not there; plug"),
                             testing::Not(HasSubstr("\n"))));
  const std::string no_port = links.make("null", "/dev/null");
  EXPECT_THAT(refusal([&] { rig::open_serial_line({.port = no_port, .usb_serial = ""}); }),
              HasSubstr("there is no port " + no_port + " (/dev/null); plug"));
}

TEST(SerialLine, SaysThatAPortIsNotThere) {
  EXPECT_THAT(refusal([] { rig::open_serial_line({.port = "/dev/ttyNONE7", .usb_serial = ""}); }),
              testing::AllOf(HasSubstr("there is no port /dev/ttyNONE7"), HasSubstr("threadstation devices")));
  EXPECT_THAT(refusal([] { rig::open_serial_line({.port = "", .usb_serial = "A50285BI"}); }),
              HasSubstr("serial number A50285BI is not plugged in"));
}
