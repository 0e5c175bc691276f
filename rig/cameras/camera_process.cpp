#include "rig/cameras/camera_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include "rig/cameras/camera_frames.h"

extern char** environ;

namespace rig {
namespace {

using nlohmann::json;

constexpr int kProcessSocket = 3;
// How often one question may make the process end, hang or lose the camera. A process that ends is quickly replaced,
// one that hangs costs its whole time-out.
constexpr int kMostEnded = 3, kMostHung = 2, kMostLost = 2;

// The process is gone or does not answer and has to be started again.
struct ProcessLost : std::runtime_error {
  explicit ProcessLost(const std::string& how, bool hangs = false) : std::runtime_error(how), hung(hangs) {}
  bool hung;
};

void send_all(int socket, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) throw ProcessLost("its process ended");
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

// One process with its socket. The process is ended when this object is destroyed.
class Process {
 public:
  explicit Process(const std::vector<std::string>& command) {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
      throw std::runtime_error(std::string("no socket for the camera process (") + std::strerror(errno) +
                               "); close other programs and try again");
    }
    socket_ = ends[0];
    std::vector<char*> arguments;
    for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], kProcessSocket);
    // libgphoto2 prints on standard output and standard error, which belong to the program's own lines.
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    // The process gets its own group, so that ctrl-C at the terminal reaches only the program, which then ends it.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    const int failed = posix_spawn(&process_, arguments[0], &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    if (failed != 0) {
      ::close(socket_);
      throw std::runtime_error("the camera process \"" + command.front() + "\" could not be started (" +
                               std::strerror(failed) + "); install the program again");
    }
  }
  ~Process() {
    ::close(socket_);
    if (lives()) {
      ::kill(process_, SIGKILL);
      ::waitpid(process_, nullptr, 0);
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  bool lives() {
    ended_ = ended_ || ::waitpid(process_, nullptr, WNOHANG) == process_;
    return !ended_;
  }

  CameraFrame ask(const CameraFrame& question, double timeout_s) {
    send_all(socket_, encode_frame(question));
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
    CameraFrame answer;
    while (!frames_.next(answer)) {
      const double left_s = std::chrono::duration<double>(deadline - std::chrono::steady_clock::now()).count();
      pollfd watched{.fd = socket_, .events = POLLIN, .revents = 0};
      const int ready = left_s > 0 ? ::poll(&watched, 1, static_cast<int>(std::ceil(left_s * 1e3))) : 0;
      if (ready < 0 && errno == EINTR) continue;
      std::array<char, 1 << 16> piece{};
      const ssize_t got = ready > 0 ? ::recv(socket_, piece.data(), piece.size(), 0) : -1;
      if (ready <= 0)
        throw ProcessLost("it did not answer within " + std::to_string(std::lround(timeout_s)) + " s", true);
      if (got <= 0) throw ProcessLost("its process ended");
      frames_.add({piece.data(), static_cast<std::size_t>(got)});
    }
    return answer;
  }

 private:
  int socket_ = -1;
  pid_t process_ = -1;
  bool ended_ = false;  // once true, the process number may belong to another process
  CameraFrames frames_;
};

CameraIdentity identity_from_json(const json& document) {
  return {.make = document.at("make"),
          .model = document.at("model"),
          .serial = document.at("serial"),
          .width_px = document.at("width_px"),
          .height_px = document.at("height_px")};
}

class ProcessCamera final : public Camera {
 public:
  explicit ProcessCamera(CameraProcessSetup setup) : setup_(std::move(setup)) {
    with_process("be connected", [] {});
  }

  CameraIdentity identity() override { return identity_; }
  std::vector<double> shutter_times_s() override { return shutter_times_s_; }

  CameraSettings configure(const CameraSettings& wanted) override {
    if (!std::isfinite(wanted.exposure_s) || !std::isfinite(wanted.f_number)) {
      throw std::runtime_error("an exposure of " + std::to_string(wanted.exposure_s) + " s at f/" +
                               std::to_string(wanted.f_number) + " was asked; both must be positive numbers");
    }
    wanted_.reset();
    CameraSettings found;
    with_process("set its exposure", [&] { found = configure_there(wanted); });
    wanted_ = wanted;
    return found;
  }

  Picture capture() override {
    Picture picture;
    with_process("take a picture", [&] {
      const double exposure_s = wanted_ ? std::max(0.0, wanted_->exposure_s) : 0;
      CameraFrame answer = ask({{"ask", "capture"}}, exposure_s);
      picture = {.bytes = std::move(answer.bytes),
                 .extension = answer.text.at("extension"),
                 .settings = settings_from_json(answer.text.at("settings")),
                 .utc = answer.text.at("utc")};
    });
    return picture;
  }

  std::vector<std::byte> preview() override {
    std::vector<std::byte> jpeg;
    with_process("show what it sees", [&] { jpeg = ask({{"ask", "preview"}}, 0).bytes; });
    return jpeg;
  }

 private:
  // Does `work` with a running process, started again when it is lost. When the camera itself refuses, the question is
  // not repeated: its message goes to the person, and the camera is connected anew for the next question.
  template <typename Work>
  void with_process(const std::string& asked, const Work& work) {
    std::string why;
    if (process_ && !process_->lives()) process_.reset();  // it died while nothing was asked: not counted
    int ended = 0, hung = 0, lost = 0;
    while (ended < kMostEnded && hung < kMostHung) {
      try {
        if (!process_) start();
        work();
        return;
      } catch (const ProcessLost& gone) {
        why = gone.what();
        ++(gone.hung ? hung : ended);
        process_.reset();
      } catch (const CameraLost&) {
        process_.reset();
        if (++lost == kMostLost) throw;
      } catch (const json::exception&) {
        why = "its process answered something else";
        ++ended;
        process_.reset();
      } catch (...) {
        process_.reset();
        throw;
      }
    }
    throw std::runtime_error("the camera was to " + asked + " and " + why + ", " + std::to_string(ended + hung) +
                             " times; switch the camera off and on, check its cable, then resume");
  }

  void start() {
    process_ = std::make_unique<Process>(setup_.command);
    const CameraFrame answer = ask({{"ask", "connect"},
                                    {"port", setup_.camera.port},
                                    {"width_px", setup_.camera.width_px},
                                    {"height_px", setup_.camera.height_px},
                                    {"shortest_shutter_s", setup_.camera.shortest_shutter_s},
                                    {"least_battery_percent", setup_.camera.least_battery_percent}},
                                   0);
    const CameraIdentity found = identity_from_json(answer.text.at("identity"));
    if (!identity_.serial.empty() && found.serial != identity_.serial) {
      throw std::runtime_error("the camera came back as another one (serial number " + found.serial + ", it was " +
                               identity_.serial + "); connect the first one, then resume");
    }
    identity_ = found;
    shutter_times_s_ = answer.text.at("shutter_times_s").get<std::vector<double>>();
    if (wanted_) configure_there(*wanted_);
  }

  CameraSettings configure_there(const CameraSettings& wanted) {
    const CameraFrame answer = ask({{"ask", "configure"}, {"settings", settings_to_json(wanted)}}, 0);
    return settings_from_json(answer.text.at("settings"));
  }

  CameraFrame ask(const json& question, double exposure_s) {
    CameraFrame answer = process_->ask({.text = question, .bytes = {}}, setup_.answer_timeout_s + exposure_s);
    if (const auto error = answer.text.find("error"); error != answer.text.end()) {
      if (answer.text.value("lost", false)) throw CameraLost(error->get<std::string>());
      throw std::runtime_error(error->get<std::string>());
    }
    return answer;
  }

  CameraProcessSetup setup_;
  std::unique_ptr<Process> process_;
  CameraIdentity identity_;
  std::vector<double> shutter_times_s_;
  std::optional<CameraSettings> wanted_;
};

GphotoSetup setup_from_json(const json& document) {
  return {.port = document.at("port"),
          .width_px = document.at("width_px"),
          .height_px = document.at("height_px"),
          .shortest_shutter_s = document.at("shortest_shutter_s"),
          .least_battery_percent = document.at("least_battery_percent")};
}

CameraFrame answer_to(const json& question, std::unique_ptr<Camera>& camera,
                      const std::function<std::unique_ptr<Camera>(const GphotoSetup&)>& open_camera) {
  const std::string asked = question.at("ask");
  if (asked == "connect") {
    camera = open_camera(setup_from_json(question));
    const CameraIdentity found = camera->identity();
    return {.text = {{"identity",
                      {{"make", found.make},
                       {"model", found.model},
                       {"serial", found.serial},
                       {"width_px", found.width_px},
                       {"height_px", found.height_px}}},
                     {"shutter_times_s", camera->shutter_times_s()}},
            .bytes = {}};
  }
  if (!camera) throw std::runtime_error("the camera process was asked to " + asked + " before it was connected");
  if (asked == "configure") {
    const CameraSettings found = camera->configure(settings_from_json(question.at("settings")));
    return {.text = {{"settings", settings_to_json(found)}}, .bytes = {}};
  }
  if (asked == "capture") {
    Picture picture = camera->capture();
    return {.text = {{"settings", settings_to_json(picture.settings)},
                     {"extension", picture.extension},
                     {"utc", picture.utc}},
            .bytes = std::move(picture.bytes)};
  }
  if (asked == "preview") return {.text = json::object(), .bytes = camera->preview()};
  throw std::runtime_error("the camera process was asked to \"" + asked + "\", which it cannot");
}

}  // namespace

std::unique_ptr<Camera> make_process_camera(const CameraProcessSetup& setup) {
  return std::make_unique<ProcessCamera>(setup);
}

int run_camera_process(int socket, const std::function<std::unique_ptr<Camera>(const GphotoSetup&)>& open_camera) {
  ::signal(SIGPIPE, SIG_IGN);  // libgphoto2 writes to broken connections
  std::unique_ptr<Camera> camera;
  CameraFrames frames;
  std::array<char, 1 << 12> piece{};
  try {
    for (ssize_t got = 0; (got = ::recv(socket, piece.data(), piece.size(), 0)) > 0;) {
      frames.add({piece.data(), static_cast<std::size_t>(got)});
      for (CameraFrame question; frames.next(question);) {
        CameraFrame answer;
        try {
          answer = answer_to(question.text, camera, open_camera);
        } catch (const CameraLost& error) {
          answer = {.text = {{"error", error.what()}, {"lost", true}}, .bytes = {}};
        } catch (const std::exception& error) {
          answer = {.text = {{"error", error.what()}, {"lost", false}}, .bytes = {}};
        }
        send_all(socket, encode_frame(answer));
      }
    }
  } catch (const std::exception&) {
    return 1;  // the program is gone, and nobody reads why
  }
  return 0;
}

}  // namespace rig
