// Each fault at each operation of a short piece of work with the camera: the work ends right, or with a message and a
// camera that works again once the person has put it right. It never ends with a wrong picture.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <future>
#include <iostream>
#include <mutex>
#include <set>
#include <vector>

#include "tests/rig/cameras/gphoto_camera_fixture.h"

namespace {

using testing::AllOf;
using testing::Each;
using testing::HasSubstr;

constexpr int kAtOnce = 12;  // most of the time is libgphoto2's waiting for an answer that does not come

const rig::CameraSettings kFirst{.exposure_s = 0.25, .iso = 100, .f_number = 8};
const rig::CameraSettings kSecond{.exposure_s = 0.5, .iso = 200, .f_number = 5.6};

// Two pictures with different settings; what is delivered must be what was made last, and with those settings.
void take_pictures(rig::Camera& camera, const WiredCamera& wired) {
  for (const rig::CameraSettings& wanted : {kFirst, kSecond}) {
    const rig::CameraSettings set = camera.configure(wanted);
    EXPECT_DOUBLE_EQ(set.exposure_s, wanted.exposure_s);
    const rig::Picture picture = camera.capture();
    const rig::Picture made = wired.recorded.last();
    EXPECT_TRUE(picture.bytes == made.bytes);
    EXPECT_DOUBLE_EQ(made.settings.exposure_s, wanted.exposure_s);
    EXPECT_EQ(made.settings.iso, wanted.iso);
    EXPECT_EQ(made.settings.f_number, wanted.f_number);
  }
}

// The port stands in the command as well: the process of one camera is told from the others' by it.
std::unique_ptr<rig::Camera> open_camera(const WiredCamera& wired) {
  return rig::make_process_camera({.command = {"/proc/self/exe", "camera-process", wired.port()},
                                   .camera = {.port = wired.port(), .width_px = 60, .height_px = 40},
                                   .answer_timeout_s = 40 * kPatience});
}

void crash_process_of(const std::string& port) {
  for (const pid_t child : children()) {
    std::ifstream file("/proc/" + std::to_string(child) + "/cmdline");
    if (std::string(std::istreambuf_iterator<char>(file), {}).find(port) != std::string::npos) kill(child, SIGSEGV);
  }
}

// Ports differ from run to run.
std::string without_port(std::string message, const WiredCamera& wired) {
  if (const std::size_t begin = message.find(wired.port()); begin != std::string::npos)
    message.replace(begin, wired.port().size(), "ptpip:...");
  return message;
}

// What was said; nothing when the work was done.
std::string try_work(WiredCamera& wired) {
  std::unique_ptr<rig::Camera> camera;
  const std::string said = refusal([&] {
    camera = open_camera(wired);
    take_pictures(*camera, wired);
  });
  if (said == "(accepted)") return {};
  wired.body->set_condition({});
  wired.server->plug_in();
  EXPECT_EQ(refusal([&] {
              if (!camera) camera = open_camera(wired);
              take_pictures(*camera, wired);
            }),
            "(accepted)")
      << "after: " << said;
  return without_port(said, wired);
}

int operations_of_the_work() {
  static const int operations = [] {
    WiredCamera sound;
    EXPECT_EQ(try_work(sound), "");
    return sound.server->operations();
  }();
  return operations;
}

// One piece of work for each operation of the work without faults, several at once; returns what was said.
std::set<std::string> at_each_operation(const std::function<std::string(int)>& work) {
  const int operations = operations_of_the_work();
  EXPECT_GT(operations, 30);
  std::set<std::string> said;
  int next = 1, failed = 0;
  std::mutex mutex;
  const auto worker = [&] {
    for (;;) {
      int at = 0;
      {
        const std::lock_guard hold(mutex);
        if (next > operations) return;
        at = next++;
      }
      SCOPED_TRACE("at operation " + std::to_string(at));
      const std::string message = work(at);
      const std::lock_guard hold(mutex);
      if (!message.empty()) {
        ++failed;
        said.insert(message);
      }
    }
  };
  std::vector<std::future<void>> workers;
  for (int i = 0; i < kAtOnce; ++i) workers.push_back(std::async(std::launch::async, worker));
  for (auto& one : workers) one.get();
  std::cout << operations << " operations, " << failed << " ended with a message:\n";
  for (const std::string& message : said) std::cout << "  " << message << "\n";
  return said;
}

std::set<std::string> sweep(rig::CameraFault fault) {
  return at_each_operation([fault](int at) {
    WiredCamera wired({{.at_operation = at, .fault = fault}});
    return try_work(wired);
  });
}

}  // namespace

TEST(CameraFaults, AQuestionThatIsNotHeardCostsNoPicture) {
  EXPECT_THAT(sweep(rig::CameraFault::silence), testing::IsEmpty());
}

TEST(CameraFaults, ALostAnswerCostsNoPictureAndWhatWasTakenMeanwhileIsNotTakenForTheNext) {
  EXPECT_THAT(sweep(rig::CameraFault::lost_answer), testing::IsEmpty());
}

TEST(CameraFaults, AnAnswerThatBreaksOffCostsNoPicture) {
  EXPECT_THAT(sweep(rig::CameraFault::cut), testing::IsEmpty());
}

TEST(CameraFaults, NoiseInTheAnswerCostsNoPicture) {
  EXPECT_THAT(sweep(rig::CameraFault::garbage), testing::IsEmpty());
}

// The library's process dies right when the camera hears its Nth question.
TEST(CameraFaults, AProcessThatCrashesAtAnyQuestionCostsNoPicture) {
  const auto said = at_each_operation([](int at) {
    std::atomic<int> heard = 0;
    std::promise<std::string> port;  // is known when the server has begun
    const auto before_answer = [&, known = port.get_future().share()] {
      if (++heard == at) crash_process_of(known.get());
    };
    WiredCamera wired({}, before_answer);
    port.set_value(wired.port());
    const std::string message = try_work(wired);
    EXPECT_GE(heard, at);
    return message;
  });
  EXPECT_THAT(said, testing::IsEmpty());
}

// Fault 15: another program (a file manager) holds the camera when the Nth question of the first one is answered; the
// first one is not disturbed, the second is told what to close, and gets the camera when the first has let it go.
TEST(CameraFaults, ACameraThatAnotherProgramHoldsIsSaidWithWhatToClose) {
  WiredCamera wired;
  std::set<std::string> said;
  {
    const auto first = open_camera(wired);
    for (int picture = 0; picture < 3; ++picture) {
      take_pictures(*first, wired);
      said.insert(without_port(refusal([&] { open_camera(wired); }), wired));
    }
    take_pictures(*first, wired);
  }
  for (const std::string& message : said) std::cout << "  " << message << "\n";
  EXPECT_THAT(said, testing::ElementsAre(HasSubstr("another program holds the camera; close")));
  EXPECT_EQ(try_work(wired), "");
}

TEST(CameraFaults, ACameraThatGoesAwayIsSaidAndTheNextPictureComesWhenItIsBack) {
  const auto said = sweep(rig::CameraFault::unplug);
  EXPECT_THAT(said, testing::Not(testing::IsEmpty()));
  EXPECT_THAT(said, Each(HasSubstr("check its cable and battery")));
}

// Fault 20, setting by setting.
TEST(CameraFaults, ASettingThatIsAcceptedAndNotDoneIsSeen) {
  const std::array<std::pair<rig::CameraFault, const char*>, 3> settings{
      {{rig::CameraFault::refused_shutter, "set its shutterspeed to "},
       {rig::CameraFault::refused_iso, "set its iso to "},
       {rig::CameraFault::refused_f_number, "set its f-number to "}}};
  for (const auto& [fault, words] : settings) {
    const auto said = sweep(fault);
    EXPECT_THAT(said, testing::Not(testing::IsEmpty())) << words;
    EXPECT_THAT(said, Each(AllOf(HasSubstr(words), HasSubstr("and stays at"), HasSubstr("dial to M"))));
  }
}

// Somebody left the camera at JPEG.
TEST(CameraFaults, AQualityThatIsAcceptedAndNotDoneIsSeen) {
  const auto said = at_each_operation([](int at) {
    WiredCamera wired({{.at_operation = at, .fault = rig::CameraFault::refused_quality}});
    wired.body->handle({.code = 0x9205, .parameters = {0x5004}, .data = "\3"});
    return try_work(wired);
  });
  EXPECT_THAT(said, testing::ElementsAre(HasSubstr("has to be \"RAW\"; set MENU > Image Quality > RAW")));
}

// Never a picture with another setting than was asked; what the library mends itself ends without a message.
TEST(CameraFaults, ASettingThatGoesTooFarIsSeen) {
  EXPECT_THAT(sweep(rig::CameraFault::overstepped), Each(AllOf(HasSubstr("and stays at"), HasSubstr("dial to M"))));
}

TEST(CameraFaults, AStaleOrRepeatedPictureIsRefused) {
  const auto said = sweep(rig::CameraFault::stale_picture);
  EXPECT_THAT(said, testing::Not(testing::IsEmpty()));
  EXPECT_THAT(said, Each(AllOf(HasSubstr("delivered before"), HasSubstr("forgets old ones"))));
}

TEST(CameraFaults, AFullCardIsSaidWithWhatToDo) {
  const auto said = sweep(rig::CameraFault::store_full);
  EXPECT_THAT(said, testing::Not(testing::IsEmpty()));
  EXPECT_THAT(said, Each(HasSubstr("empty the card")));
}

TEST(CameraFaults, AnEmptyBatteryIsSaidBeforeAnythingBegins) {
  const auto said = sweep(rig::CameraFault::battery_empty);
  EXPECT_THAT(said, testing::ElementsAre(HasSubstr("battery is at 1 %; charge it")));
}

TEST(CameraFaults, AModeDialThatIsNotAtMIsNamedBeforeAnythingBegins) {
  const auto said = sweep(rig::CameraFault::dial_turned);
  EXPECT_THAT(said, testing::ElementsAre(HasSubstr("set the mode dial on its top to M")));
}
