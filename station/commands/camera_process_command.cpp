#include "rig/cameras/camera_process.h"
#include "station/bench/rig_devices.h"
#include "station/commands/commands.h"

namespace station {
namespace {

constexpr int kSocket = 3;  // where rig/cameras/camera_process.cpp puts it

}  // namespace

// This command is for the program itself, so it is not listed.
void add_camera_process_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(kCameraProcess, "")->group("");
  command->callback([] {
    if (rig::run_camera_process(kSocket, rig::make_gphoto_camera) != 0)
      throw std::runtime_error(
          "the camera process has no program that it answers; it is started by threadstation alone");
  });
}

}  // namespace station
