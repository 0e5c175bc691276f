#include "renderer/picture/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace renderer {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<unsigned char>;

[[noreturn]] void fail(const std::string& asked, const std::string& found, const std::string& remedy) {
  std::string line = asked + ": " + found + "; " + remedy;
  std::replace(line.begin(), line.end(), '\n', ' ');
  throw std::runtime_error(line);
}

// A file that is deleted again unless rename_to() keeps it.
class TemporaryFile {
 public:
  explicit TemporaryFile(fs::path path) : path_(std::move(path)) {
    descriptor_ = ::open(path_.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0666);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!kept_) ::unlink(path_.c_str());
  }

  bool is_open() const { return descriptor_ >= 0; }
  bool write_and_flush(const Bytes& bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t n = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
      if (n < 0 && errno != EINTR) return false;
      if (n > 0) done += static_cast<std::size_t>(n);
    }
    return ::fsync(descriptor_) == 0;
  }
  bool rename_to(const fs::path& target) {
    kept_ = ::rename(path_.c_str(), target.c_str()) == 0;
    return kept_;
  }

 private:
  fs::path path_;
  int descriptor_ = -1;
  bool kept_ = false;
};

void flush_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

void write_atomically(const fs::path& file, const Bytes& bytes) {
  const std::string asked = "writing picture " + file.string();
  const std::string remedy = "check that the folder exists, is writable and has space";
  TemporaryFile temporary(file.string() + "." + std::to_string(::getpid()) + ".partial");
  if (!temporary.is_open() || !temporary.write_and_flush(bytes) || !temporary.rename_to(file))
    fail(asked, std::strerror(errno), remedy);
  flush_folder(file.parent_path());
}

// The bytes of a picture file, made in memory so that every failure of the disk is seen by write_atomically.
// `native`: the pixels' channels are of the types that the specification has for each.
Bytes encode(const std::string& format, const OIIO::ImageSpec& spec, const void* pixels, std::size_t row_stride,
             bool native = false) {
  const auto output = OIIO::ImageOutput::create(format);
  if (!output) fail("encoding a " + format + " picture", OIIO::geterror(), "reinstall OpenImageIO with that format");
  Bytes bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  if (!output->set_ioproxy(&memory) || !output->open("memory." + format, spec) ||
      !output->write_image(native ? OIIO::TypeDesc() : spec.format, pixels, OIIO::AutoStride,
                           static_cast<OIIO::stride_t>(row_stride)) ||
      !output->close())
    fail("encoding a " + format + " picture", output->geterror(), "check its size");
  return bytes;
}

template <class Pixel>
Bytes encode_png_pixels(const cv::Mat_<Pixel>& image) {
  OIIO::ImageSpec spec(image.cols, image.rows, image.channels(), OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("oiio:UnassociatedAlpha", 1);
  return encode("png", spec, image.data, image.step);
}

std::unique_ptr<OIIO::ImageInput> open_picture(const fs::path& file) {
  const std::string asked = "reading picture " + file.string();
  std::error_code error;
  if (!fs::exists(file, error)) fail(asked, "there is no such file", "check the name");
  auto input = OIIO::ImageInput::open(file.string());
  if (!input) fail(asked, OIIO::geterror(), "it is damaged, cut short or not a picture: make it again");
  return input;
}

// OpenImageIO leaks, and libpng writes to standard error, when a PNG file ends early; so its end is looked at first.
void check_png_is_complete(const fs::path& file) {
  static constexpr std::array<unsigned char, 8> kEnd{'I', 'E', 'N', 'D', 0xae, 0x42, 0x60, 0x82};
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(-static_cast<std::streamoff>(kEnd.size()), std::ios::end);
  std::array<char, kEnd.size()> end{};
  stream.read(end.data(), end.size());
  if (!stream || std::memcmp(end.data(), kEnd.data(), kEnd.size()) != 0)
    fail("reading picture " + file.string(), "it is not a complete PNG file", "make it again");
}

template <class Pixel>
cv::Mat_<Pixel> read_pixels(OIIO::ImageInput& input, const fs::path& file, OIIO::TypeDesc type) {
  const OIIO::ImageSpec& spec = input.spec();
  cv::Mat_<Pixel> image(spec.height, spec.width);
  const int channels = image.channels();
  if (spec.nchannels < channels) {
    fail("reading picture " + file.string(),
         "it has " + std::to_string(spec.nchannels) + " channels, not " + std::to_string(channels),
         "give another file");
  }
  if (!input.read_image(0, 0, 0, channels, type, image.data))
    fail("reading picture " + file.string(), input.geterror(), "it is damaged or cut short: make it again");
  return image;
}

void set_attributes(OIIO::ImageSpec& spec, const ImageHeader& header) {
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", "    :  :     :  :  ");  // unknown; the time of writing would make equal pictures differ
  for (const auto& [name, text] : header) spec.attribute(name, text);
}

constexpr double kMostHalf = 65504;

OIIO::TypeDesc stored_type(const ExrChannel& channel) {
  if (channel.plane.depth() == CV_32S) return OIIO::TypeDesc::UINT32;
  return channel.half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT;
}

float srgb_encoded(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

float srgb_decoded(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

// The file's format by its first bytes, as OpenImageIO names it; so none of OpenImageIO's other readers is let near the
// file.
std::string picture_format(const fs::path& file) {
  const std::string asked = "reading picture " + file.string();
  std::error_code error;
  if (!fs::is_regular_file(file, error)) fail(asked, "there is no such file", "check the name");
  std::array<char, 4> begin{};
  std::ifstream(file, std::ios::binary).read(begin.data(), begin.size());
  const std::string_view bytes(begin.data(), begin.size());
  if (bytes == "\x89PNG") return "png";
  if (bytes.substr(0, 3) == "\xff\xd8\xff") return "jpeg";
  if (bytes == "\x76\x2f\x31\x01") return "openexr";
  fail(asked, "it is none of PNG, JPEG and EXR", "give one of these");
}

// One pixel of `channels` values (grey or colour, with or without alpha, which comes last) as linear sRGB over white.
cv::Vec3f linear_srgb_of(const float* pixel, int channels, bool encoded) {
  const bool grey = channels <= 2, transparent = channels == 2 || channels == 4;
  const float alpha = transparent ? std::clamp(pixel[channels - 1], 0.0f, 1.0f) : 1.0f;
  cv::Vec3f linear;
  for (int c = 0; c < 3; ++c) {
    const float value = pixel[grey ? 0 : c];
    linear[c] = alpha * (encoded ? srgb_decoded(value) : value) + (1 - alpha);
  }
  return linear;
}

}  // namespace

void write_exr(const fs::path& file, const cv::Mat3f& linear, const ImageHeader& header) {
  OIIO::ImageSpec spec(linear.cols, linear.rows, 3, OIIO::TypeDesc::FLOAT);
  set_attributes(spec, header);
  write_atomically(file, encode("exr", spec, linear.data, linear.step));
}

void write_exr(const fs::path& file, const std::vector<ExrChannel>& channels, const ImageHeader& header) {
  if (channels.empty()) fail("writing picture " + file.string(), "there is no channel", "give one");
  const cv::Size size = channels.front().plane.size();
  OIIO::ImageSpec spec(size.width, size.height, static_cast<int>(channels.size()), OIIO::TypeDesc::FLOAT);
  spec.channelnames.clear();
  for (const ExrChannel& channel : channels) {
    spec.channelnames.push_back(channel.name);
    spec.channelformats.push_back(stored_type(channel));
  }
  set_attributes(spec, header);
  // Pixels are read as the file has them: one pixel's channels after the other, each in its own type.
  const std::size_t pixel_bytes = spec.pixel_bytes(true);
  Bytes pixels(static_cast<std::size_t>(size.area()) * pixel_bytes);
  std::size_t offset = 0;
  for (const ExrChannel& channel : channels) {
    if (channel.plane.size() != size || channel.plane.channels() != 1)
      fail("writing picture " + file.string(), "channel " + channel.name + " has another size", "make them equal");
    const cv::Mat values =
        channel.half ? cv::Mat(cv::min(cv::max(channel.plane, -kMostHalf), kMostHalf)) : channel.plane;
    const OIIO::TypeDesc stored = stored_type(channel);
    unsigned char* to = pixels.data() + offset;
    for (int row = 0; row < size.height; ++row)
      for (int column = 0; column < size.width; ++column, to += pixel_bytes)
        OIIO::convert_pixel_values(channel.half ? OIIO::TypeDesc::FLOAT : stored,
                                   values.ptr(row) + 4 * static_cast<std::size_t>(column), stored, to);
    offset += stored.size();
  }
  const bool mixed = std::any_of(spec.channelformats.begin(), spec.channelformats.end(),
                                 [&](OIIO::TypeDesc type) { return type != spec.channelformats.front(); });
  if (!mixed) spec.set_format(spec.channelformats.front());
  write_atomically(file, encode("exr", spec, pixels.data(), pixel_bytes * static_cast<std::size_t>(size.width), mixed));
}

std::vector<ExrChannel> read_exr_channels(const fs::path& file) {
  const auto input = open_picture(file);
  const OIIO::ImageSpec spec = input->spec();
  std::vector<ExrChannel> channels;
  for (int c = 0; c < spec.nchannels; ++c) {
    const OIIO::TypeDesc stored = spec.channelformat(c);
    const bool integer = stored == OIIO::TypeDesc::UINT32;
    ExrChannel channel{.name = spec.channel_name(c),
                       .plane = cv::Mat(spec.height, spec.width, integer ? CV_32S : CV_32F),
                       .half = stored == OIIO::TypeDesc::HALF};
    if (!input->read_image(0, 0, c, c + 1, integer ? OIIO::TypeDesc::UINT32 : OIIO::TypeDesc::FLOAT,
                           channel.plane.data))
      fail("reading picture " + file.string(), input->geterror(), "it is damaged or cut short: make it again");
    channels.push_back(channel);
  }
  return channels;
}

cv::Mat3f read_exr(const fs::path& file, ImageHeader* header) {
  const auto input = open_picture(file);
  cv::Mat3f image = read_pixels<cv::Vec3f>(*input, file, OIIO::TypeDesc::FLOAT);
  if (header) {
    header->clear();
    for (const auto& attribute : input->spec().extra_attribs)
      if (attribute.type() == OIIO::TypeDesc::STRING) (*header)[attribute.name().string()] = attribute.get_string();
  }
  return image;
}

cv::Mat3f read_linear_srgb(const fs::path& file) {
  const std::string asked = "reading picture " + file.string();
  const std::string format = picture_format(file);
  if (format == "png") check_png_is_complete(file);
  OIIO::ImageSpec as_stored;
  as_stored.attribute("oiio:UnassociatedAlpha", 1);
  const auto input = OIIO::ImageInput::create(format);
  OIIO::ImageSpec found;
  if (!input || !input->open(file.string(), found, as_stored))
    fail(asked, input ? input->geterror() : OIIO::geterror(), "it is damaged or cut short: make it again");
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.nchannels < 1 || spec.nchannels > 4)
    fail(asked, "it has " + std::to_string(spec.nchannels) + " channels", "give a grey or colour picture");
  if (static_cast<double>(spec.width) * spec.height > kMostPicturePixels)
    fail(asked, "it has " + std::to_string(spec.width) + " x " + std::to_string(spec.height) + " pixels",
         "give one of at most 100 million");
  const auto width = static_cast<std::size_t>(spec.width), channels = static_cast<std::size_t>(spec.nchannels);
  std::vector<float> values(width * static_cast<std::size_t>(spec.height) * channels);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()))
    fail(asked, input->geterror(), "it is damaged or cut short: make it again");
  if (!std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); }))
    fail(asked, "it has values that are no numbers", "make it again");
  cv::Mat3f linear(spec.height, spec.width);
  linear.forEach([&](cv::Vec3f& pixel, const int* at) {
    const std::size_t first = (static_cast<std::size_t>(at[0]) * width + static_cast<std::size_t>(at[1])) * channels;
    pixel = linear_srgb_of(values.data() + first, spec.nchannels, format != "openexr");
  });
  return linear;
}

void write_png(const fs::path& file, const cv::Mat1b& grey) {
  write_atomically(file, encode_png_pixels(grey));
}
void write_png(const fs::path& file, const cv::Mat3b& rgb) {
  write_atomically(file, encode_png_pixels(rgb));
}
void write_png(const fs::path& file, const cv::Mat4b& rgba) {
  write_atomically(file, encode_png_pixels(rgba));
}

cv::Mat1b read_png_grey(const fs::path& file) {
  const auto input = open_picture(file);
  check_png_is_complete(file);
  return read_pixels<uchar>(*input, file, OIIO::TypeDesc::UINT8);
}

std::string encode_png(const cv::Mat3b& rgb) {
  const Bytes bytes = encode_png_pixels(rgb);
  return {bytes.begin(), bytes.end()};
}

cv::Mat3b encode_srgb(const cv::Mat3f& linear, double scale, const cv::Matx33f& linear_srgb_from_camera) {
  cv::Mat3b encoded(linear.size());
  const cv::Matx33f matrix = linear_srgb_from_camera * static_cast<float>(scale);
  encoded.forEach([&](cv::Vec3b& pixel, const int* position) {
    const cv::Vec3f value = matrix * linear(position[0], position[1]);
    for (int c = 0; c < 3; ++c) {
      const float clipped = std::isnan(value[c]) ? 0.0f : std::clamp(value[c], 0.0f, 1.0f);
      pixel[c] = static_cast<uchar>(std::lround(255 * srgb_encoded(clipped)));
    }
  });
  return encoded;
}

cv::Vec3f linear_of_srgb(const cv::Vec3b& shown) {
  cv::Vec3f linear;
  for (int c = 0; c < 3; ++c) linear[c] = srgb_decoded(static_cast<float>(shown[c]) / 255);
  return linear;
}

}  // namespace renderer
