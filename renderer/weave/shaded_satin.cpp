#include "renderer/weave/shaded_satin.h"

#include <stdexcept>

namespace renderer {

std::vector<std::vector<bool>> shaded_structure(const cv::Mat1b& shades) {
  std::vector<std::vector<bool>> warp_over;
  for (int pick = 0; pick < shades.rows; ++pick) {
    std::vector<bool> row;
    for (int end = 0; end < shades.cols; ++end) {
      const int shade = shades(shades.rows - 1 - pick, end);
      if (shade < 1 || shade > kShades) throw std::invalid_argument("shaded_structure: a shade is 1 to 7");
      const int begin = pick * kSatinStep % kSatinEnds;
      row.push_back((end % kSatinEnds - begin + kSatinEnds) % kSatinEnds < shade);
    }
    warp_over.push_back(row);
  }
  return warp_over;
}

}  // namespace renderer
