// The blocks of a view, over whose masked pixels it is averaged. The thread model has no detail below a thread,
// photographs do, so that pictures are compared where a block covers several threads.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "inversion/view/view.h"
#include "inversion/view/wrapped_spool.h"

namespace inversion {

struct Block {
  std::vector<cv::Point> pixels;  // the masked ones
};

// The square blocks of `side_px` over the mask, row by row; blocks without masked pixels are left out.
std::vector<Block> mask_blocks(const cv::Mat1b& mask, int side_px);

// The number of the photograph's pixels, per side, that make one pooled pixel: as many as cover two thread pitches in
// every view.
int pooled_px(const WrappedSpool& spool, const std::vector<View>& views);
inline constexpr double kPooledPitches = 2;
// Blocks of the fit and of its agreement are kBlock_pooled x kBlock_pooled pooled pixels.
inline constexpr int kBlock_pooled = 8;

// The mean of a picture over the block's masked pixels, RGB.
Eigen::Array3d block_mean(const Block& block, const cv::Mat3f& picture);

}  // namespace inversion
