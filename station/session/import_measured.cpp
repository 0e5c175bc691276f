#include "station/session/import_measured.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <vector>

#include "renderer/picture/image_file.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/session/capture/recorder.h"
#include "station/session/develop/develop_session.h"
#include "station/session/measured_file.h"

namespace station {
namespace {

namespace fs = std::filesystem;

std::string extension_of(const fs::path& file) {
  std::string extension = file.extension().string().substr(1);
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension;
}

// Reads each picture, for its size: all that could be wrong with one is found before the session is made.
void set_cameras(MeasuredFile& measured) {
  for (DevelopedView& developed : measured.views.views) {
    const cv::Size size = renderer::read_linear(developed.image_file).size();
    renderer::Camera& camera = developed.view.camera;
    camera.width = size.width, camera.height = size.height;
    const Eigen::Vector2d middle((size.width - 1) / 2.0, (size.height - 1) / 2.0);
    const Eigen::Vector2d principal = measured.principal_point_px.value_or(middle);
    camera.cx = principal.x(), camera.cy = principal.y();
    if (developed.mask_file.empty()) continue;
    if (const cv::Size of_mask = renderer::read_png_grey(developed.mask_file).size(); of_mask != size)
      throw std::runtime_error(developed.mask_file + " has " + std::to_string(of_mask.width) + " x " +
                               std::to_string(of_mask.height) + " pixels and its picture " +
                               std::to_string(size.width) + " x " + std::to_string(size.height) +
                               "; give a mask of the same size");
  }
}

Plan plan_of(const DevelopedViews& views) {
  Plan plan;
  for (const DevelopedView& developed : views.views)
    plan.steps.push_back({.id = developed.view.id,
                          .kind = StepKind::view,
                          .mounting = developed.mounting,
                          .lamp = developed.view.transmission ? rig::Lamp::back : rig::Lamp::front,
                          .platform_angle_rad = developed.platform_angle_rad});
  if (const auto problem = check_plan(plan)) throw std::runtime_error(*problem);
  return plan;
}

// An import of the same views that was interrupted, to go on with it.
SessionFolder begun_session(const fs::path& session, const DevelopedViews& views, rig::Clock& clock, FileSystem& disk) {
  const nlohmann::json document = read_json_file(session / "session.json");
  if (document.value("measured", nlohmann::json()) != to_json(views))
    throw std::runtime_error(session.string() + " is a session of other pictures already; choose another folder");
  return SessionFolder::open(session, clock, disk);
}

}  // namespace

void import_measured(const fs::path& list, const fs::path& session, ProgressStyle progress_style) {
  MeasuredFile measured = read_measured_file(list);
  const nlohmann::json spool_document = read_spool_document(measured.spool);
  if (parse_spool(spool_document, measured.spool.string()).fabric)
    throw std::runtime_error(measured.spool.string() + " is a cloth; measured views are those of a wrapped thread");
  set_cameras(measured);
  const Plan plan = plan_of(measured.views);
  std::vector<fs::path> pictures;
  CalibrationFiles masks;
  for (DevelopedView& developed : measured.views.views) {
    pictures.emplace_back(developed.image_file);
    developed.image_file = "raw/" + developed.view.id + "." + extension_of(pictures.back());
    if (developed.mask_file.empty()) continue;
    const std::string name = developed.view.id + "-mask.png";
    masks[name] = bytes_of_file(developed.mask_file);
    developed.mask_file = "calibration/" + name;
  }
  rig::SystemClock clock;
  FileSystem disk;
  {
    SessionFolder folder =
        is_session(session)
            ? begun_session(session, measured.views, clock, disk)
            : SessionFolder::create(
                  session, make_measured_document(clock.utc(), spool_document, plan, measured.views, measured.person),
                  masks, clock, disk);
    Recorder recorder(folder);
    recorder.begin(plan);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      const PlanStep& step = plan.steps[i];
      if (recorder.taken().contains(step.id)) continue;
      recorder.keep({.step = step.id,
                     .kind = step.kind,
                     .mounting = step.mounting,
                     .lamp = step.lamp,
                     .asked_angle_rad = step.platform_angle_rad,
                     .read_angle_rad = step.platform_angle_rad},
                    {.bytes = bytes_of_file(pictures[i]), .extension = extension_of(pictures[i]), .utc = clock.utc()});
    }
    recorder.stop(RunState::complete);
  }
  develop_session(session, progress_style);
}

}  // namespace station
