#include "station/output/compare/compare_files.h"

#include "renderer/picture/image_file.h"
#include "station/documents/calibration_file.h"

namespace station {

Comparison compare_files(const CompareRequest& request) {
  const cv::Mat3f photograph = renderer::read_exr(request.photograph),
                  rendering = renderer::read_exr(request.rendering);
  const cv::Mat1b mask = request.mask.empty() ? cv::Mat1b() : renderer::read_png_grey(request.mask);
  CompareOptions options = request.options;
  if (!request.calibration.empty())
    options.linear_srgb_from_camera = read_calibration(request.calibration).linear_srgb_from_camera;
  const Comparison found = compare_pictures(photograph, rendering, mask, options);
  if (!request.picture.empty())
    renderer::write_png(request.picture, comparison_picture(photograph, rendering, mask, options));
  return found;
}

}  // namespace station
