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
  EXPECT_GE(stops, 3);
  EXPECT_EQ(station::interrupts(), 1) << "one ctrl-C, however often it stops";
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
  std::atomic<int> asked = 0;
  std::promise<void> asked_again;
  const station::StopOnInterrupt watch([&] {
    if (++asked == 2) asked_again.set_value();
    throw std::runtime_error("the cable is out");
  });
  std::raise(SIGINT);
  asked_again.get_future().wait();
  EXPECT_GE(asked, 2) << "it is asked again though it failed";
  EXPECT_TRUE(station::interrupted());
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

TEST(Interrupts, EndTheProgramAgainWhereNothingIsLostByIt) {
  station::watch_interrupts();
  station::let_interrupts_end();
  EXPECT_EXIT(std::raise(SIGINT), testing::KilledBySignal(SIGINT), "");
  station::watch_more_interrupts(2);  // as the next part of a command does
  std::raise(SIGINT);
  std::raise(SIGINT);
  EXPECT_EQ(station::interrupts(), 2);
  station::watch_interrupts();
}
