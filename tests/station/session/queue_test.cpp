// Tables of spools, the names of their sessions, and which faults a queue goes on after.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>

#include "station/bench/bench_fault.h"
#include "station/output/interrupt.h"
#include "station/session/spool_queue.h"
#include "tests/places.h"
#include "tests/station/session/capture/fakes.h"

namespace station {
namespace {

using testing::HasSubstr;

struct Queue : testing::Test {
  std::vector<QueuedSpool> read(const std::string& text) {
    write_text(folder / "spools.csv", text);
    return read_queue(folder / "spools.csv");
  }
  std::string refusal(const std::string& text) {
    return message_of([&] { read(text); });
  }
  TemporaryFolder folder;
};

TEST_F(Queue, ARowIsASpoolWithItsNamesAndTheSettingsOfTheRowAboveWhereItHasNone) {
  const auto queue = read(
      "barcode,name,lot,material,colour,note,spool\n4711,blue silk,A 12,silk,blue,\"dry, cool\",silk.json\n"
      "4712,,,,,,\n,red silk,,silk,red,,other.json\n");
  ASSERT_EQ(queue.size(), 3U);
  EXPECT_EQ(queue[0].session, "4711-A-12");
  EXPECT_EQ(queue[0].sample.note, "dry, cool");
  EXPECT_EQ(queue[1].session, "4712");
  EXPECT_EQ(queue[1].spool.filename(), "silk.json") << "same settings as last";
  EXPECT_EQ(queue[2].session, "red-silk");
  EXPECT_EQ(queue[2].spool.filename(), "other.json");
}

TEST_F(Queue, TheDocumentedTableIsRead) {
  const auto queue = read_queue(std::filesystem::path(DATA_DIR) / "queues/two_silks.csv");
  ASSERT_EQ(queue.size(), 2U);
  EXPECT_EQ(queue[0].session, "4006381333931-A-12");
  for (const QueuedSpool& spool : queue) EXPECT_TRUE(std::filesystem::exists(spool.spool)) << spool.spool;
}

TEST_F(Queue, WhatSpreadsheetsWriteIsReadOrRefusedAndNeverMisread) {
  EXPECT_EQ(read("\xEF\xBB\xBF"
                 "barcode,spool\r\n1,a.json\r\n2,\r\n")
                .size(),
            2U)
      << "a mark and CR LF";
  EXPECT_THAT(refusal("barcode;spool\n1;a.json\n"), HasSubstr("semicolons"));
  EXPECT_THAT(refusal("barcode,spool\n1,a.json,7\n"), HasSubstr("3 cells"));
  EXPECT_THAT(refusal("barcode,spool\n\"1,a.json\n"), HasSubstr("quote"));
  EXPECT_THAT(refusal("barcode,spool\n\xFF,a.json\n"), HasSubstr("UTF-8"));
  EXPECT_THAT(refusal("barcode,colours,spool\n"), HasSubstr("\"colours\" is not known"));
  EXPECT_THAT(refusal("barcode,spool,spool\n"), HasSubstr("twice"));
  EXPECT_THAT(refusal("barcode,spool\n"), HasSubstr("no rows"));
  EXPECT_THAT(refusal("barcode,spool\n1,\n"), HasSubstr("no row above"));
  EXPECT_THAT(refusal("barcode,name,spool\n,,a.json\n"), HasSubstr("neither barcode nor name"));
  for (const std::string& bad : {refusal("barcode,spool\n1,\n"), refusal("barcode;spool\n")})
    EXPECT_EQ(bad.find('\n'), std::string::npos);
}

TEST_F(Queue, ASpoolThatStandsThereTwiceIsNoticed) {
  EXPECT_THAT(refusal("barcode,spool\n7,a.json\n8,\n7,\n"), HasSubstr("line 4: the spool \"7\" stands in line 2"));
  EXPECT_THAT(refusal("name,spool\na b,a.json\na/b,\n"), HasSubstr("stands in line 2")) << "one folder for both";
  EXPECT_EQ(read("barcode,lot,spool\n7,1,a.json\n7,2,\n").size(), 2U) << "two lots of one thread";
}

TEST_F(Queue, NamesOfWhichNoFolderCanBeMadeAreRefused) {
  EXPECT_THAT(refusal("name,spool\nCON,a.json\n"), HasSubstr("Windows"));
  EXPECT_THAT(refusal("name,spool\n...,a.json\n"), HasSubstr("empty"));
  EXPECT_THAT(refusal("name,spool\n" + std::string(300, 'x') + ",a.json\n"), HasSubstr("300 characters"));
}

// A queue of three spools on fake devices; what goes wrong is the test's.
struct FakeQueue : Queue {
  FakeQueue() {
    write_text(folder / "spools.csv", "barcode,spool\n4711,a.json\n4712,\n4713,\n");
    std::filesystem::create_directory(folder / "lab");
  }
  // Every spool is asked for, and captured with `on_move` on its turntable.
  std::vector<QueueResult> run(const std::function<void(const std::string& session)>& on_move) {
    asked.clear();
    const auto next = [&](const QueuedSpool& spool) {
      asked.push_back(spool.session);
      return true;
    };
    const auto capture = [&](const CaptureRequest& request) {
      FakeStation station;
      station.turntable.on_move = [&](double) { on_move(request.session.filename()); };
      return station.run(request.session, small_plan());
    };
    const CaptureRequest request{.session = folder / "lab", .new_session = NewSession{}};
    return capture_queue(folder / "spools.csv", request, next, capture);
  }
  static std::vector<QueueOutcome> outcomes(const std::vector<QueueResult>& results) {
    std::vector<QueueOutcome> found;
    std::ranges::transform(results, std::back_inserter(found), &QueueResult::outcome);
    return found;
  }
  std::vector<std::string> asked;
};

TEST_F(FakeQueue, AFaultOfTheBenchAsksForNoFurtherSpoolAndTheSameCallGoesOnFromThere) {
  using enum QueueOutcome;
  const auto lost = run([](const std::string& session) {
    if (session == "4712") throw BenchFault("the turntable was unplugged; plug it in");
  });
  EXPECT_THAT(asked, testing::ElementsAre("4711", "4712"));
  EXPECT_THAT(outcomes(lost), testing::ElementsAre(captured, bench_fault, waiting));
  EXPECT_EQ(
      pause_line(lost).value_or(""),
      "the queue is paused by a fault of the bench: the turntable was unplugged; plug it in; done: 4711; waiting: "
      "4712, 4713; when the bench is put right, the same command goes on from here");
  const auto plugged_in = run([](const std::string&) {});
  EXPECT_THAT(asked, testing::ElementsAre("4712", "4713"));
  EXPECT_THAT(outcomes(plugged_in), testing::ElementsAre(kept, resumed, captured));
  EXPECT_FALSE(pause_line(plugged_in));
}

TEST_F(FakeQueue, WhatIsCompleteAlreadyDoesNotWaitForTheBench) {
  using enum QueueOutcome;
  run([](const std::string& session) {
    if (session != "4713") throw std::runtime_error("the picture is out of focus");
  });
  const auto lost = run([](const std::string&) { throw BenchFault("the camera is gone"); });
  EXPECT_THAT(outcomes(lost), testing::ElementsAre(bench_fault, waiting, kept));
  EXPECT_THAT(pause_line(lost).value_or(""), HasSubstr("done: 4713; waiting: 4711, 4712;"));
}

TEST_F(FakeQueue, CtrlCAsksForNoFurtherSpoolWhateverItEnds) {
  using enum QueueOutcome;
  watch_interrupts();
  const auto complete = run([](const std::string&) {
    if (!interrupted()) std::raise(SIGINT);
  });
  EXPECT_THAT(outcomes(complete), testing::ElementsAre(captured));
  watch_interrupts();
  const auto failed_then = run([](const std::string&) {
    std::raise(SIGINT);
    throw std::runtime_error("the platform was stopped");
  });
  EXPECT_THAT(outcomes(failed_then), testing::ElementsAre(kept, failed));
  EXPECT_THAT(asked, testing::ElementsAre("4712"));
  watch_interrupts();
}

TEST_F(FakeQueue, AFaultOfOneSpoolHoldsUpNoOther) {
  using enum QueueOutcome;
  const auto one_refused = run([](const std::string& session) {
    if (session == "4711") throw std::runtime_error("the picture is out of focus");
    if (session == "4712") throw rig::Declined("the person declined");
  });
  EXPECT_THAT(asked, testing::ElementsAre("4711", "4712", "4713"));
  EXPECT_THAT(outcomes(one_refused), testing::ElementsAre(failed, failed, captured));
  EXPECT_FALSE(pause_line(one_refused));
}

}  // namespace
}  // namespace station
