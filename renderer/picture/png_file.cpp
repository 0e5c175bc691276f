// PNG files by libpng.
#include <png.h>

#include <csetjmp>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "renderer/picture/decoded_picture.h"
#include "renderer/picture/image_file.h"
#include "renderer/picture/picture_bytes.h"

namespace renderer {
namespace {

namespace fs = std::filesystem;

struct PngImage : png_image {
  PngImage() : png_image{} { version = PNG_IMAGE_VERSION; }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
  ~PngImage() { png_image_free(this); }
};

std::string encoded(const cv::Mat& pixels) {
  PngImage png;
  png.width = static_cast<png_uint_32>(pixels.cols), png.height = static_cast<png_uint_32>(pixels.rows);
  png.format = pixels.channels() == 1 ? PNG_FORMAT_GRAY : pixels.channels() == 3 ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(png), '\0');
  png_alloc_size_t size = bytes.size();
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, pixels.data, static_cast<png_int_32>(pixels.step),
                                 nullptr))
    refuse_picture("encoding a PNG picture", png.message, "check its size");
  bytes.resize(size);
  return bytes;
}

void begin_reading(PngImage& png, const std::string& bytes, const fs::path& file) {
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size())) refuse_damaged_picture(file, png.message);
  check_size(file, png.width, png.height);
}

cv::Mat finish_reading(PngImage& png, const fs::path& file, int type) {
  cv::Mat pixels(static_cast<int>(png.height), static_cast<int>(png.width), type);
  if (!png_image_finish_read(&png, nullptr, pixels.data, static_cast<png_int_32>(pixels.step1()), nullptr))
    refuse_damaged_picture(file, std::string("it is not a complete PNG file (") + png.message + ")");
  return pixels;
}

struct Unread {
  const char* next;
  std::size_t size;
};

void read_on(png_struct* png, unsigned char* to, std::size_t size) {
  auto* unread = static_cast<Unread*>(png_get_io_ptr(png));
  if (size > unread->size) png_error(png, "it breaks off");
  std::memcpy(to, unread->next, size);
  unread->next += size, unread->size -= size;
}

// Both would go to standard error.
[[noreturn]] void give_up(png_struct* png, const char* /*error*/) {
  png_longjmp(png, 1);
}
void go_on(png_struct* /*png*/, const char* /*warning*/) {}

// 16-bit RGBA as stored: what libpng makes of 16 bits in one call follows a curve that is not quite that of sRGB.
// libpng leaves this function by a jump, over which nothing with a destructor may lie.
bool read_deep(png_struct* png, png_info* info, Unread* unread, cv::Mat4w* pixels) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_read_fn(png, unread, read_on);
  png_read_info(png, info);
  png_set_gray_to_rgb(png);
  png_set_tRNS_to_alpha(png);
  png_set_add_alpha(png, 0xffff, PNG_FILLER_AFTER);
  png_set_swap(png);
  const int passes = png_set_interlace_handling(png);
  png_read_update_info(png, info);
  for (int pass = 0; pass < passes; ++pass)
    for (int row = 0; row < pixels->rows; ++row) png_read_row(png, pixels->ptr(row), nullptr);
  png_read_end(png, nullptr);
  return true;
}

cv::Mat4w deep_pixels(const std::string& bytes, const cv::Size& size, const fs::path& file) {
  cv::Mat4w pixels(size, cv::Vec4w::all(0));
  Unread unread{bytes.data(), bytes.size()};
  png_struct* png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, give_up, go_on);
  png_info* info = png ? png_create_info_struct(png) : nullptr;
  const bool whole = info && read_deep(png, info, &unread, &pixels);
  png_destroy_read_struct(&png, &info, nullptr);
  if (!whole) refuse_damaged_picture(file, "it is not a complete PNG file");
  return pixels;
}

}  // namespace

void write_png(const fs::path& file, const cv::Mat1b& grey) {
  store_picture(file, encoded(grey));
}
void write_png(const fs::path& file, const cv::Mat3b& rgb) {
  store_picture(file, encoded(rgb));
}
void write_png(const fs::path& file, const cv::Mat4b& rgba) {
  store_picture(file, encoded(rgba));
}

std::string encode_png(const cv::Mat3b& rgb) {
  return encoded(rgb);
}

cv::Mat1b read_png_grey(const fs::path& file) {
  const std::string bytes = bytes_of_picture(file);
  PngImage png;
  begin_reading(png, bytes, file);
  const bool grey = (png.format & PNG_FORMAT_FLAG_COLOR) == 0;
  png.format = grey ? PNG_FORMAT_GRAY : PNG_FORMAT_RGB;
  cv::Mat1b first;
  cv::extractChannel(finish_reading(png, file, grey ? CV_8UC1 : CV_8UC3), first, 0);
  return first;
}

cv::Mat3b decode_png(const std::string& bytes) {
  PngImage png;
  begin_reading(png, bytes, "in memory");
  png.format = PNG_FORMAT_RGB;
  return finish_reading(png, "in memory", CV_8UC3);
}

cv::Mat3f linear_of_png(const std::string& bytes, const fs::path& file) {
  PngImage png;
  begin_reading(png, bytes, file);
  if ((png.format & PNG_FORMAT_FLAG_LINEAR) != 0)
    return linear_over_white(deep_pixels(bytes, {static_cast<int>(png.width), static_cast<int>(png.height)}, file));
  png.format = PNG_FORMAT_RGBA;
  return linear_over_white(cv::Mat4b(finish_reading(png, file, CV_8UC4)));
}

}  // namespace renderer
