#include "calibration/geometry/tags.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "calibration/geometry/tag_corners.h"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
}

namespace calibration {
namespace {

// Building the decoder's table takes milliseconds, so each thread keeps one detector.
class Detector {
 public:
  Detector() : family_(tag36h11_create()), detector_(apriltag_detector_create()) {
    apriltag_detector_add_family_bits(detector_, family_, 1);
    detector_->nthreads = 1;
    detector_->refine_edges = true;
  }
  ~Detector() {
    apriltag_detector_destroy(detector_);
    tag36h11_destroy(family_);
  }
  Detector(const Detector&) = delete;
  Detector& operator=(const Detector&) = delete;

  TagObservation detect(const cv::Mat1b& picture) {
    // Tags of 35 px need every pixel. In pictures of many megapixels, where tags are wider, every other pixel each way
    // finds the same tags in a third of the time; corners are refined in the full picture.
    detector_->quad_decimate = picture.cols > 3000 ? 2.0F : 1.0F;
    image_u8_t image{picture.cols, picture.rows, static_cast<int>(picture.step[0]), picture.data};
    using Detections = std::unique_ptr<zarray_t, decltype(&apriltag_detections_destroy)>;
    const Detections found(apriltag_detector_detect(detector_, &image), &apriltag_detections_destroy);
    TagObservation tags;
    for (int i = 0; i < zarray_size(found.get()); ++i) {
      apriltag_detection_t* detection = nullptr;
      zarray_get(found.get(), i, static_cast<void*>(&detection));
      TagDetection tag{.id = detection->id, .corners_px = {}};
      for (std::size_t c = 0; c < 4; ++c) {
        // AprilTag 3.3 puts the centre of the first pixel at (0.5, 0.5).
        tag.corners_px[c] = Eigen::Vector2d(detection->p[c][0] - 0.5, detection->p[c][1] - 0.5);
      }
      tags.push_back(tag);
    }
    return tags;
  }

 private:
  apriltag_family_t* family_;
  apriltag_detector_t* detector_;
};

// A percentile of the values, in large pictures of every few pixels only, which is exact enough for a brightness.
float percentile(const cv::Mat1f& grey, double fraction) {
  constexpr int kMost = 1 << 20;
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(grey.total()) / kMost)));
  std::vector<float> values;
  values.reserve(grey.total() / static_cast<std::size_t>(step * step) + 1);
  for (int row = 0; row < grey.rows; row += step)
    for (int column = 0; column < grey.cols; column += step) values.push_back(grey(row, column));
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

constexpr int kReach = 31;  // blocks

// The brightest value, at most `limit`, within a sixteenth of the picture (31 px at least), smoothed. That is wider
// than a code cell, so that every neighbourhood holds some paper. A pixel of the result stands for a block of the
// picture.
cv::Mat1f white_of_surroundings(const cv::Mat1f& grey, int block, float limit) {
  cv::Mat1f white((grey.rows + block - 1) / block, (grey.cols + block - 1) / block, 0.F);
  cv::parallel_for_({0, white.rows}, [&](const cv::Range& rows) {
    for (int row = rows.start * block; row < std::min(rows.end * block, grey.rows); ++row) {
      const float* values = grey[row];
      float* brightest = white[row / block];
      for (int left = 0; left < grey.cols; left += block, ++brightest)
        for (int column = left; column < std::min(left + block, grey.cols); ++column)
          *brightest = std::max(*brightest, std::min(values[column], limit));
    }
  });
  cv::dilate(white, white, cv::Mat1b::ones(2 * kReach + 1, 2 * kReach + 1));
  cv::blur(white, white, {2 * kReach + 1, 2 * kReach + 1});
  return white;
}

// The picture in 8 bits, proportional to the radiance within any neighbourhood of a tag's size: each value is divided
// by the white of its surroundings, so that a board lit from one side keeps its contrast. A display curve (sRGB) was
// tried and refused: it is steeper in the dark, so blurred edges move into the black square, by 0.2 px for pixel-sharp
// pictures and 0.45 px at a blur of 0.7 px, where proportional values leave 0.01 px.
cv::Mat1b encode(const cv::Mat1f& grey) {
  const float white = percentile(grey, 0.995);
  if (!(white > 0.0F)) return cv::Mat1b(grey.size(), uchar{0});
  constexpr float kDarkestPaper = 0.04F;  // part of the picture's white; tags on darker paper are not looked for
  const int block = std::max(1, std::min(grey.rows, grey.cols) / (16 * kReach));
  const cv::Mat1f of_blocks = white_of_surroundings(grey, block, white);
  cv::Mat1b encoded(grey.size());
  cv::parallel_for_({0, of_blocks.rows}, [&](const cv::Range& blocks) {
    cv::Mat1f local_white;
    for (int from = blocks.start; from < blocks.end; ++from) {
      cv::resize(of_blocks.row(from), local_white, {grey.cols, 1}, 0, 0, cv::INTER_LINEAR);
      for (int row = from * block; row < std::min((from + 1) * block, grey.rows); ++row)
        for (int column = 0; column < grey.cols; ++column)
          encoded(row, column) = cv::saturate_cast<uchar>(230.F * std::min(grey(row, column), white) /
                                                          std::max(local_white(0, column), kDarkestPaper * white));
    }
  });
  return encoded;
}

// Whether the tag is clear of the picture's border: there the detector prolongs cut edges, and corners are a pixel or
// two off.
bool inside(const TagDetection& tag, const cv::Size& size) {
  constexpr double kMargin_px = 3.0;
  return std::all_of(tag.corners_px.begin(), tag.corners_px.end(), [&](const Eigen::Vector2d& corner) {
    return corner.minCoeff() >= kMargin_px && corner.x() <= size.width - 1 - kMargin_px &&
           corner.y() <= size.height - 1 - kMargin_px;
  });
}

}  // namespace

TagLayout make_tag_board(const std::string& name, int rows, int columns, double tag_mm, double pitch_mm, int first_id) {
  if (rows < 1 || columns < 1 || !(tag_mm > 0.0) || !(pitch_mm > tag_mm)) {
    throw std::runtime_error("tag board \"" + name +
                             "\": needs rows and columns of at least 1 and a pitch above the tag's size");
  }
  TagLayout layout{.name = name, .tags = {}};
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      Tag tag{.id = first_id + row * columns + column, .size_mm = tag_mm};
      tag.object_from_tag.translation() << pitch_mm * (column - 0.5 * (columns - 1)),
          pitch_mm * (0.5 * (rows - 1) - row), 0.0;
      layout.tags.push_back(tag);
    }
  }
  return layout;
}

long tags_seen(const TagLayout& layout, const TagObservation& seen) {
  return std::count_if(seen.begin(), seen.end(), [&](const TagDetection& one) {
    return std::any_of(layout.tags.begin(), layout.tags.end(), [&](const Tag& tag) { return tag.id == one.id; });
  });
}

std::array<Eigen::Vector3d, 4> corners_in_object(const Tag& tag) {
  const double h = 0.5 * tag.size_mm;
  return {tag.object_from_tag * Eigen::Vector3d(-h, -h, 0.0), tag.object_from_tag * Eigen::Vector3d(h, -h, 0.0),
          tag.object_from_tag * Eigen::Vector3d(h, h, 0.0), tag.object_from_tag * Eigen::Vector3d(-h, h, 0.0)};
}

TagsSeen see_tags(const cv::Mat1f& grey) {
  if (grey.empty()) return {};
  thread_local Detector detector;
  const TagObservation found = detector.detect(encode(grey));
  std::map<int, int> times_seen;
  for (const TagDetection& tag : found) ++times_seen[tag.id];
  TagsSeen seen;
  for (const TagDetection& tag : found)
    if (times_seen[tag.id] == 1 && inside(tag, grey.size()))
      seen.tags.push_back({.id = tag.id, .corners_px = refined_corners(grey, tag.corners_px)});
  std::sort(seen.tags.begin(), seen.tags.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  for (const auto& [id, times] : times_seen)
    if (times > 1) seen.repeated.push_back(id);
  return seen;
}

TagObservation detect_tags(const cv::Mat1f& grey) {
  return see_tags(grey).tags;
}

cv::Mat1b tag_bitmap(int id) {
  using Family = std::unique_ptr<apriltag_family_t, decltype(&tag36h11_destroy)>;
  const Family family(tag36h11_create(), &tag36h11_destroy);
  if (id < 0 || id >= static_cast<int>(family->ncodes)) {
    throw std::runtime_error("tag " + std::to_string(id) + " was asked for, tag36h11 has 0 to " +
                             std::to_string(family->ncodes - 1) + ": choose another id");
  }
  // Debian's library does not export image_u8_destroy: the two allocations are released here.
  image_u8_t* image = apriltag_to_image(family.get(), id);
  const cv::Mat1b bitmap =
      cv::Mat1b(image->height, image->width, image->buf, static_cast<std::size_t>(image->stride)).clone();
  std::free(image->buf);
  std::free(image);
  return bitmap;
}

}  // namespace calibration
