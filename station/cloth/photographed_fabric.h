// A photographed cloth and what it is said to be woven of.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "renderer/weave/draft.h"
#include "station/documents/session_file.h"
#include "station/documents/views_file.h"

namespace station {

struct SaidFabric {
  std::filesystem::path session;   // a developed session of a cloth on the cylinder
  std::filesystem::path fabric{};  // fabric file of the weave; empty: the session's own
  // What its warp and weft are digitized as, both or neither: sessions with a fitted `model`, or model files. Empty:
  // the weave's own threads, which are a thread model's.
  std::filesystem::path warp{}, weft{};
  std::string model = "thread";  // or "bundle", "fiber", "yarn": of the sessions
};

// Which threads of the draft scatter how.
struct WovenModels {
  renderer::Draft draft;
  std::vector<renderer::ScatteringModel> threads;
};

// Errors of both: std::runtime_error for a session of a wrapped thread, one that is not developed, a fabric without a
// weave, threads that are not fitted so, or another model than a thread's without warp and weft.
WovenModels woven_models(const SaidFabric& said, const Spool& photographed);
DevelopedViews pictures_of_fabric(const std::filesystem::path& session);

// The cloth as the view's camera sees it under the view's lamp: linear camera RGB, 0 outside the view's mask. What an
// interrupt has stopped is not whole.
cv::Mat3f predicted_picture(const Fabric& photographed, const renderer::YarnPatch& patch,
                            const std::vector<renderer::ScatteringModel>& threads, const inversion::View& view,
                            int samples_per_pixel, std::uint64_t seed);

}  // namespace station
