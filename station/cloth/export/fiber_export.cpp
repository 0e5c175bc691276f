#include "station/cloth/export/fiber_export.h"

#include <Eigen/LU>
#include <stdexcept>

#include "station/documents/matrix_rows.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"

namespace station {
namespace {

std::string of_channels(const char* what, const Eigen::Array3d& thread, const Eigen::Array3d& fiber) {
  const Eigen::Array3d error = 100 * (fiber / thread - 1);
  return formatted("%s R G B: thread %.4f %.4f %.4f, fiber %.4f %.4f %.4f, errors %+.1f %+.1f %+.1f %%", what,
                   thread[0], thread[1], thread[2], fiber[0], fiber[1], fiber[2], error[0], error[1], error[2]);
}

}  // namespace

Eigen::Matrix3d srgb_scattering_from_camera(const ThreadFile& thread) {
  const Eigen::Matrix3d srgb_from_camera = matrix_of(thread.linear_srgb_from_camera);
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(srgb_from_camera);
  if (!lu.isInvertible())
    throw std::runtime_error(
        "thread \"" + thread.name +
        "\": linear_srgb_from_camera has no inverse, so that its colours cannot be told; invert its "
        "session again with a calibrated camera");
  const Eigen::Vector3d white = lu.solve(Eigen::Vector3d::Ones());
  return srgb_from_camera * white.asDiagonal();
}

FiberExport fiber_export(const ThreadFile& thread) {
  return {.thread = thread.name,
          .diameter_mm = thread.diameter_mm,
          .nearest = inversion::nearest_fiber(thread.parameters, srgb_scattering_from_camera(thread)),
          .wanders = thread.parameters.exit != renderer::ThreadExit::entry_point};
}

std::vector<std::string> approximation(const FiberExport& fiber) {
  const inversion::FiberAgreement& found = fiber.nearest.agreement;
  std::vector<std::string> lines{
      "The single fiber nearest to the thread " + nlohmann::json(fiber.thread).dump() + " (" +
          formatted("%.4g", fiber.diameter_mm) + " mm), by " + software_version() + "; an approximation:",
      formatted("error of f cos: %.1f %% (root mean square, relative), averaged over the thread's width %.1f %%",
                100 * found.rms, 100 * found.rms_far),
      of_channels("albedo", found.thread_albedo, found.fiber_albedo),
      of_channels("light sent back", found.thread_back, found.fiber_back)};
  if (fiber.nearest.fiber.eta > 0.999 * inversion::kMostFiberIndex)
    lines.push_back("its refractive index is as high as was allowed: the thread reflects more than fibers do");
  if (fiber.wanders)
    lines.push_back("light wanders inside the thread, the fiber sends it on from where it came in: cloth differs more");
  if (!fiber.nearest.converged) lines.push_back("the search for it ended before it had settled");
  return lines;
}

nlohmann::json to_json(const inversion::FiberAgreement& agreement) {
  return {{"rms", agreement.rms},
          {"rms_far", agreement.rms_far},
          {"thread_albedo", to_json(Eigen::Vector3d(agreement.thread_albedo))},
          {"fiber_albedo", to_json(Eigen::Vector3d(agreement.fiber_albedo))},
          {"thread_back", to_json(Eigen::Vector3d(agreement.thread_back))},
          {"fiber_back", to_json(Eigen::Vector3d(agreement.fiber_back))}};
}

}  // namespace station
