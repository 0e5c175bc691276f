#include "station/bench/live_view.h"

#include <chrono>
#include <thread>

#include "station/bench/rig_devices.h"
#include "station/documents/disk/file_system.h"
#include "station/documents/disk/stored_file.h"
#include "station/output/interrupt.h"

namespace station {

int live_view(const LiveViewRequest& request) {
  constexpr auto kBetweenFrames = std::chrono::milliseconds(400);
  watch_interrupts();
  const RigFile rig = read_rig(request.rig);
  ProgressDisplay progress("live view", request.progress_style);
  const RigDevices devices = open_rig(rig, std::nullopt, request.asked);
  if (devices.bench) rig::make_simulated_operator(*devices.bench)->arrange({.room_light = true});
  FileSystem disk;
  int frames = 0;
  while (frames < request.frames && !interrupted()) {
    store_file(disk, request.out, devices.camera->preview());
    progress.show(++frames, request.frames, "frame");
    std::this_thread::sleep_for(kBetweenFrames);
  }
  progress.finish("ended");
  return frames;
}

}  // namespace station
