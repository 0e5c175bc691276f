#include "inversion/view/blocks.h"

#include <algorithm>
#include <cmath>

namespace inversion {

std::vector<Block> mask_blocks(const cv::Mat1b& mask, int side_px) {
  std::vector<Block> blocks;
  for (int row = 0; row < mask.rows; row += side_px)
    for (int column = 0; column < mask.cols; column += side_px) {
      Block block;
      for (int y = row; y < std::min(row + side_px, mask.rows); ++y)
        for (int x = column; x < std::min(column + side_px, mask.cols); ++x)
          if (mask(y, x)) block.pixels.emplace_back(x, y);
      if (!block.pixels.empty()) blocks.push_back(std::move(block));
    }
  return blocks;
}

int pooled_px(const WrappedSpool& spool, const std::vector<View>& views) {
  double side = 1;
  for (const View& view : views) side = std::max(side, kPooledPitches * spool.thread_diameter_mm * px_per_mm(view));
  return static_cast<int>(std::ceil(side));
}

Eigen::Array3d block_mean(const Block& block, const cv::Mat3f& picture) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (const cv::Point& at : block.pixels) {
    const cv::Vec3f& pixel = picture(at);
    sum += Eigen::Array3d(pixel[0], pixel[1], pixel[2]);
  }
  return sum / static_cast<double>(block.pixels.size());
}

}  // namespace inversion
