// A film: what a rendering has gathered so far, pixel by pixel, enough to show it, to go on with it and to know its
// noise.
//
// Samples of a pixel are numbered from 0 and are always added in that order, so that the sums are the same bit for bit
// whoever draws them, in however many passes. The noise is judged by the spread of the means of batches of kBatch
// neighbouring samples. Each batch is a small low-discrepancy set of its own (sampler.h), so that the spread shows what
// even spacing gains within batches. It does not show what even spacing gains beyond a batch, so that the true error is
// rather smaller than the stated one.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace renderer {

inline constexpr int kTile = 16;   // pixels along a side of a tile, which one thread draws at a time
inline constexpr int kBatch = 16;  // samples of a pixel

struct Film {
  cv::Mat_<cv::Vec3d> sums;  // of the samples' radiance (RGB), height x width
  cv::Mat1d squares;         // sum over batches of |sum of the batch|^2 / samples of the batch
  cv::Mat1i counts;          // samples
  cv::Mat1i goals;           // per tile, by rows: samples that its pixels have when the pass under way is over
};

Film empty_film(int width, int height);

// The tiles into which a picture is cut, by rows; one of them; and the number of a pixel's tile among them.
std::vector<cv::Rect> tiles_of(const cv::Size& picture);
cv::Rect tile_of(const cv::Size& picture, int number);
int tile_at(const cv::Size& picture, int column, int row);

// The mean radiance, RGB; black where there is no sample.
cv::Mat3f mean_radiance(const Film& film);
// The variance of that mean as the batches' spread tells it, of the three colours together; an empty plane where a
// pixel has a single batch.
cv::Mat1f variance_of_mean(const Film& film);
std::uint64_t samples_in(const Film& film);
std::size_t bytes_of(const Film& film);

// The standard error of a pixel's mean radiance, as root mean square over the given pixels with the three colours
// together as one vector, relative to the pixels' mean brightness |RGB|, or to `least_brightness` where they are
// darker. Pixels without samples are left out. The error is infinite where a pixel has a single batch, whose spread is
// unknown.
double relative_error(const Film& film, const cv::Rect& pixels, double least_brightness = 0);
// The relative errors of all tiles. A tile that is darker than a twentieth of the picture's mean brightness is judged
// as if it had that brightness.
std::vector<double> relative_errors_of_tiles(const Film& film);

// Sets the goals of the next pass, none above `most_samples`. Returns false when there is no next pass, because every
// tile has reached what it is to have: all samples or, where `noise` is above 0, a relative error of `noise`. The
// samples of a pixel double from pass to pass, so that a first picture is there soon.
//
// No tile is judged before it has kLeastJudged samples per pixel, and all pixels of a tile get the same number. To stop
// because of what the samples themselves show favours samples that happened to be even; the more samples are judged
// together, the smaller is this bias.
inline constexpr int kLeastJudged = 4 * kBatch;
bool raise_goals(Film& film, int most_samples, double noise = 0);

// The number of samples that these tiles will have when the picture is finished, as far as the film can tell now.
double expected_samples(const Film& film, const std::vector<int>& tiles, int most_samples, double noise = 0);
// The number that they have.
std::uint64_t samples_in(const Film& film, const std::vector<int>& tiles);

}  // namespace renderer
