#include "station/thread/validate/photographed_spool.h"

#include <stdexcept>

#include "renderer/picture/image_file.h"
#include "station/bench/spool_fibers.h"
#include "station/documents/reader.h"
#include "station/output/interrupt.h"
#include "station/thread/validate/seeds.h"
#include "station/thread/validate/synthetic_views.h"

namespace station {
namespace {

// A text of everything that the pictures depend on.
std::string made_from(const SpoolPhotographs& request, const SimulatedFibers& fibers) {
  return read_json_file(request.rig_file).dump() + read_json_file(request.spool_file).dump() +
         std::to_string(request.samples_per_pixel) + "/" + std::to_string(request.seed) + "/" +
         std::to_string(fibers.seed);
}

}  // namespace

PhotographedSpool photograph_spool(const RigFile& rig, const Spool& spool, const SpoolPhotographs& request,
                                   const std::function<void(const std::string&, double)>& step) {
  const std::vector<renderer::CurveSet> fibers = spool_fibers(spool);
  const std::string origin = made_from(request, *spool.simulation);
  PhotographedSpool made{.views = synthetic_views(rig, spool.wrapping, kPooledWidth_px, kPooledHeight_px),
                         .pictures = {}};
  std::filesystem::create_directories(request.folder);
  for (std::size_t i = 0; i < made.views.size(); ++i) {
    inversion::View& view = made.views[i];
    PictureHalves pictures;
    for (std::size_t half = 0; half < 2; ++half) {
      if (interrupted())
        throw std::runtime_error(
            "the validation was interrupted; the same command goes on with the photographs it has");
      step("photograph " + view.id,
           (static_cast<double>(2 * i + half)) / (2.0 * static_cast<double>(made.views.size())));
      const std::uint64_t seed = request.seed * kPictureSeeds + 2 * i + half;
      const std::filesystem::path file = request.folder / (view.id + (half ? "-b.exr" : "-a.exr"));
      renderer::ImageHeader header;
      cv::Mat3f radiance;
      if (std::filesystem::exists(file)) radiance = renderer::read_exr(file, &header);
      if (header["threadstation/made_from"] != origin) {
        radiance = photograph(view, spool.wrapping, fibers,
                              {.samples_per_pixel = request.samples_per_pixel, .seed = seed, .progress = [](double) {
                                 return !interrupted();
                               }});
        renderer::write_exr(file, radiance, {{"threadstation/made_from", origin}});
      }
      pictures[half] =
          with_sensor_noise(radiance, view.mask, rig.simulation->truth.sensor, kPhotographLevel, seed).radiance;
    }
    view.image = 0.5 * (pictures[0] + pictures[1]);
    made.pictures.push_back(std::move(pictures));
  }
  return made;
}

}  // namespace station
