// What a rendering has gathered so far, pixel by pixel: enough to show it, to go on with it and to know its noise.
//
// Samples of a pixel are numbered from 0 and are always added in that order, so that the sums are the same bit for bit
// whoever draws them, in however many passes. The noise is judged by batches of kBatch neighbouring samples, each a
// small low-discrepancy set of its own (sampler.h): the spread of their means knows what their even spacing has gained.
// What is gained beyond a batch it leaves out, so the error is rather smaller than it says.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace renderer {

inline constexpr int kTile = 16;   // pixels along a side of what is drawn by one thread at a time
inline constexpr int kBatch = 16;  // samples

struct Film {
  cv::Mat_<cv::Vec3d> sums;  // of the samples' radiance (RGB), height x width
  cv::Mat1d squares;         // sum over batches of |sum of the batch|^2 / samples of the batch
  cv::Mat1i counts;          // samples
  cv::Mat1i goals;           // per tile, by rows: samples that its pixels have when the pass under way is over
};

Film empty_film(int width, int height);

// A picture cut into tiles, by rows; and the number of a pixel's tile among them.
std::vector<cv::Rect> tiles_of(const cv::Size& picture);
int tile_at(const cv::Size& picture, int column, int row);

// Mean radiance; black where there is no sample.
cv::Mat3f mean_radiance(const Film& film);
std::uint64_t samples_in(const Film& film);
std::size_t bytes_of(const Film& film);

// Standard error of a pixel's mean radiance, root mean square over the given pixels and with the three colours together
// as one vector, over the pixels' mean brightness |RGB|, but over `least_brightness` where they are darker. Pixels
// without samples are left out; infinite where one has a single batch, which says nothing of itself.
double relative_error(const Film& film, const cv::Rect& pixels, double least_brightness = 0);
// A tile that is darker than a twentieth of the picture is judged as if it had that brightness.
std::vector<double> relative_errors_of_tiles(const Film& film);

// Sets goals of the next pass, none above `most_samples`; false when there is none, because every tile has reached what
// it is to have: all samples or, where `noise` is above 0, a relative error of `noise`. The samples of a pixel double
// from pass to pass, so that a first picture is there soon.
//
// No tile is judged before it has kLeastJudged samples per pixel, and all pixels of a tile get the same number: to stop
// because of what the samples themselves show favours those that happened to be even, and that is the less, the more of
// them are judged together.
inline constexpr int kLeastJudged = 4 * kBatch;
bool raise_goals(Film& film, int most_samples, double noise = 0);

// Of the whole picture when it is finished, as far as the film can tell now.
double expected_samples(const Film& film, int most_samples, double noise = 0);

}  // namespace renderer
