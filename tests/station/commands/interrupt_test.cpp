#include "station/output/interrupt.h"

#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <future>
#include <stdexcept>

TEST(StopOnInterrupt, CallsTheStopWhileTheRestOfTheProgramWaits) {
  station::watch_interrupts();
  std::promise<void> stopped;
  const station::StopOnInterrupt watch([&] { stopped.set_value(); });
  std::raise(SIGINT);
  stopped.get_future().wait();  // this thread does nothing else, as a program that hangs
  EXPECT_TRUE(station::interrupted());
  station::watch_interrupts();
}

TEST(StopOnInterrupt, StopsAgainWhatWasBegunAtTheSameMoment) {
  station::watch_interrupts();
  std::atomic<int> stops = 0;
  std::promise<void> stopped_again;
  const station::StopOnInterrupt watch([&] {
    if (++stops == 3) stopped_again.set_value();
  });
  std::raise(SIGINT);
  stopped_again.get_future().wait();
  station::watch_interrupts();
}

TEST(StopOnInterrupt, DoesNothingWithoutASignalAndForgetsTheOneOfARunBefore) {
  station::watch_interrupts();
  std::raise(SIGTERM);
  station::watch_interrupts();
  std::atomic<int> stops = 0;
  {
    const station::StopOnInterrupt watch([&] { ++stops; });
  }
  EXPECT_EQ(stops, 0);
  EXPECT_FALSE(station::interrupted());
}

TEST(StopOnInterrupt, AStopThatFailsDoesNotEndTheProgram) {
  station::watch_interrupts();
  std::promise<void> asked;
  const station::StopOnInterrupt watch([&] {
    asked.set_value();
    throw std::runtime_error("the cable is out");
  });
  std::raise(SIGINT);
  asked.get_future().wait();
  station::watch_interrupts();
}

TEST(StopOnInterrupt, TheSecondSignalCallsTheOtherStopWhileTheFirstIsDone) {
  station::watch_interrupts(2);
  std::promise<void> paused, stopped;
  {
    const station::StopOnInterrupt watch([&] { paused.set_value(); }, [&] { stopped.set_value(); });
    std::raise(SIGINT);
    paused.get_future().wait();
    EXPECT_EQ(station::interrupts(), 1);
    std::raise(SIGINT);
    stopped.get_future().wait();
    EXPECT_EQ(station::interrupts(), 2);
  }
  station::watch_interrupts();
}
