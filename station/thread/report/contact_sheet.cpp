#include "station/thread/report/contact_sheet.h"

#include <opencv2/imgproc.hpp>

#include "station/thread/report/fitted_twins.h"

namespace station {
namespace {

constexpr int kTileWidth_px = 210, kGap_px = 4, kViewsPerRow = 3;

void place(cv::Mat3b& sheet, const cv::Mat3b& picture, int column, int row, int tile_height) {
  cv::Mat3b tile;
  cv::resize(picture, tile, {kTileWidth_px, tile_height}, 0, 0, cv::INTER_AREA);
  tile.copyTo(sheet(cv::Rect(kGap_px + column * (kTileWidth_px + kGap_px), kGap_px + row * (tile_height + kGap_px),
                             kTileWidth_px, tile_height)));
}

}  // namespace

cv::Mat3b contact_sheet(const DevelopedViews& developed) {
  const auto count = static_cast<int>(developed.views.size());
  if (count == 0) return {};
  const cv::Mat3f& first = developed.views.front().view.image;
  const int tile_height = kTileWidth_px * first.rows / first.cols;
  const int rows = (count + kViewsPerRow - 1) / kViewsPerRow;
  cv::Mat3b sheet(kGap_px + rows * (tile_height + kGap_px), kGap_px + 2 * kViewsPerRow * (kTileWidth_px + kGap_px),
                  cv::Vec3b(255, 255, 255));
  for (int i = 0; i < count; ++i) {
    const inversion::View& view = developed.views[static_cast<std::size_t>(i)].view;
    const cv::Rect box = threads_box(view.mask);
    const cv::Mat3b picture = display(view.image, exposure_of(view), developed.linear_srgb_from_camera);
    cv::Mat3b outlined = picture.clone();
    draw_outline(outlined, view.mask);
    place(sheet, picture(box), 2 * (i % kViewsPerRow), i / kViewsPerRow, tile_height);
    place(sheet, outlined(box), 2 * (i % kViewsPerRow) + 1, i / kViewsPerRow, tile_height);
  }
  return sheet;
}

}  // namespace station
