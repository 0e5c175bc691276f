#include "station/cloth/export/cloth_brdf.h"

#include <cstdio>
#include <stdexcept>

#include "station/cloth/draft_of_one_thread.h"
#include "station/cloth/export/fiber_export.h"
#include "station/cloth/export/merl_file.h"
#include "station/documents/draft_file.h"
#include "station/output/interrupt.h"
#include "station/output/watched_work.h"

namespace station {
namespace {

void refuse_anisotropic(const ClothBrdfRequest& request, double anisotropy) {
  char text[256];
  std::snprintf(
      text, sizeof text,
      ": its BRDF changes by %.0f %% when the cloth is turned, and a MERL table has no turn (limit %.0f %%); give "
      "--allow-anisotropic for the mean over all turns, or another --draft",
      100 * anisotropy, 100 * kMostAnisotropy);
  throw std::runtime_error("cannot export the cloth of " + request.draft.string() + text);
}

}  // namespace

ClothBrdf cloth_brdf(const ThreadFile& thread, const ClothBrdfRequest& request, ProgressDisplay& progress) {
  const Eigen::Matrix3d colours = srgb_scattering_from_camera(thread);
  const renderer::YarnPatch patch =
      weave_watched(draft_of_one_thread(read_draft(request.draft), thread.diameter_mm), progress).patch;
  const renderer::ClothReflectance cloth(patch, {thread.parameters});
  ClothBrdf brdf{.draft = patch.name, .anisotropy = renderer::anisotropy(cloth, request.seed), .cover = patch.cover};
  if (brdf.anisotropy > kMostAnisotropy && !request.allow_anisotropic) refuse_anisotropic(request, brdf.anisotropy);
  const renderer::MerlGrid grid =
      renderer::measure_merl(cloth, request.samples_per_cell, request.seed, [&](double done) {
        progress.show(static_cast<int>(100 * done), 100, "the cloth's BRDF");
        return !interrupted();
      });
  brdf.noise = grid.noise;
  brdf.merl = merl_bytes(grid, colours);
  return brdf;
}

}  // namespace station
