// EXR files by OpenEXR.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <utility>

#include "renderer/picture/image_file.h"
#include "renderer/picture/picture_bytes.h"

namespace renderer {
namespace {

namespace fs = std::filesystem;

constexpr float kMostHalf = 65504;

// A file that grows in memory, so that every failure of the disk is seen by store_picture.
class MemoryOutput final : public Imf::OStream {
 public:
  MemoryOutput() : OStream("memory") {}
  void write(const char* bytes, int count) override {
    const auto n = static_cast<std::size_t>(count);
    if (bytes_.size() < at_ + n) bytes_.resize(at_ + n);
    std::memcpy(bytes_.data() + at_, bytes, n);
    at_ += n;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = at; }
  std::string taken() { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

Imf::PixelType stored_type(const ExrChannel& channel) {
  if (channel.plane.depth() == CV_32S) return Imf::UINT;
  return channel.half ? Imf::HALF : Imf::FLOAT;
}

// A channel of `pixels`, floats or ints, the `first` of each pixel, as OpenEXR reads and writes it.
Imf::Slice slice_of(const cv::Mat& pixels, int first, const Imath::Box2i& window) {
  auto* base = reinterpret_cast<char*>(const_cast<uchar*>(pixels.data)) + 4 * static_cast<std::ptrdiff_t>(first);
  const std::size_t x_stride = pixels.elemSize(), y_stride = pixels.step;
  base -= static_cast<std::ptrdiff_t>(x_stride) * window.min.x + static_cast<std::ptrdiff_t>(y_stride) * window.min.y;
  return {pixels.depth() == CV_32S ? Imf::UINT : Imf::FLOAT, base, x_stride, y_stride};
}

cv::Mat1w halves_of(const cv::Mat& plane) {
  cv::Mat1w halves(plane.size());
  for (int row = 0; row < plane.rows; ++row)
    std::transform(plane.ptr<float>(row), plane.ptr<float>(row) + plane.cols, halves[row],
                   [](float value) { return half(std::clamp(value, -kMostHalf, kMostHalf)).bits(); });
  return halves;
}

std::string encoded(const std::vector<ExrChannel>& channels, const ImageHeader& attributes,
                    ExrCompression compression) {
  const cv::Size size = channels.front().plane.size();
  Imf::Header header(size.width, size.height);
  header.compression() = compression == ExrCompression::zip ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION;
  for (const auto& [name, text] : attributes) header.insert(name, Imf::StringAttribute(text));
  Imf::FrameBuffer pixels;
  std::vector<cv::Mat1w> halves;  // outlive the frame buffer
  for (const ExrChannel& channel : channels) {
    header.channels().insert(channel.name, Imf::Channel(stored_type(channel)));
    if (stored_type(channel) != Imf::HALF) {
      pixels.insert(channel.name, slice_of(channel.plane, 0, header.dataWindow()));
      continue;
    }
    halves.push_back(halves_of(channel.plane));
    const cv::Mat1w& plane = halves.back();
    pixels.insert(channel.name, {Imf::HALF, reinterpret_cast<char*>(plane.data), plane.elemSize(), plane.step});
  }
  MemoryOutput memory;
  {
    Imf::OutputFile file(memory, header);
    file.setFrameBuffer(pixels);
    file.writePixels(size.height);
  }  // which writes where the rows lie
  return memory.taken();
}

// Opens `file` and calls `read(Imf::InputFile&)`; whatever OpenEXR says of it becomes one line.
template <class Read>
auto with_exr(const fs::path& file, const Read& read) {
  std::error_code error;
  if (!fs::exists(file, error))
    refuse_picture("reading picture " + file.string(), "there is no such file", "check the name");
  try {
    Imf::InputFile input(file.c_str());
    const Imath::Box2i window = input.header().dataWindow();
    const double width = 1.0 + window.max.x - window.min.x, height = 1.0 + window.max.y - window.min.y;
    if (!(width > 0 && height > 0) || width * height > kMostPicturePixels)
      throw std::length_error("it has " + std::to_string(static_cast<long long>(width)) + " x " +
                              std::to_string(static_cast<long long>(height)) + " pixels");
    return read(input);
  } catch (const std::exception& problem) {
    refuse_damaged_picture(file, problem.what());
  }
}

cv::Size size_of(const Imf::InputFile& input) {
  const Imath::Box2i window = input.header().dataWindow();
  return {window.max.x - window.min.x + 1, window.max.y - window.min.y + 1};
}

void read_into(Imf::InputFile& input, const Imf::FrameBuffer& pixels) {
  const Imath::Box2i window = input.header().dataWindow();
  input.setFrameBuffer(pixels);
  input.readPixels(window.min.y, window.max.y);
}

}  // namespace

void write_exr(const fs::path& file, const cv::Mat3f& linear, const ImageHeader& header, ExrCompression compression) {
  cv::Mat planes[3];
  cv::split(linear, planes);
  write_exr(file, std::vector<ExrChannel>{{"R", planes[0]}, {"G", planes[1]}, {"B", planes[2]}}, header, compression);
}

void write_exr(const fs::path& file, const std::vector<ExrChannel>& channels, const ImageHeader& header,
               ExrCompression compression) {
  const std::string asked = "writing picture " + file.string();
  if (channels.empty()) refuse_picture(asked, "there is no channel", "give one");
  for (const ExrChannel& channel : channels)
    if (channel.plane.size() != channels.front().plane.size() || channel.plane.channels() != 1)
      refuse_picture(asked, "channel " + channel.name + " has another size", "make them equal");
  store_picture(file, encoded(channels, header, compression));
}

std::vector<ExrChannel> read_exr_channels(const fs::path& file) {
  return with_exr(file, [](Imf::InputFile& input) {
    std::vector<ExrChannel> channels;
    Imf::FrameBuffer pixels;
    const Imf::ChannelList& stored = input.header().channels();
    for (auto channel = stored.begin(); channel != stored.end(); ++channel) {
      const Imf::PixelType type = channel.channel().type;
      channels.push_back({.name = channel.name(),
                          .plane = cv::Mat(size_of(input), type == Imf::UINT ? CV_32S : CV_32F),
                          .half = type == Imf::HALF});
      pixels.insert(channel.name(), slice_of(channels.back().plane, 0, input.header().dataWindow()));
    }
    read_into(input, pixels);
    return channels;
  });
}

cv::Mat3f read_exr(const fs::path& file, ImageHeader* header) {
  return with_exr(file, [header](Imf::InputFile& input) {
    cv::Mat3f image(size_of(input));
    Imf::FrameBuffer pixels;
    const Imf::ChannelList& stored = input.header().channels();
    for (const auto& [channel, name] : {std::pair{0, "R"}, {1, "G"}, {2, "B"}}) {
      if (!stored.findChannel(name)) throw std::invalid_argument(std::string("it has no channel ") + name);
      pixels.insert(name, slice_of(image, channel, input.header().dataWindow()));
    }
    read_into(input, pixels);
    if (header) {
      header->clear();
      for (auto attribute = input.header().begin(); attribute != input.header().end(); ++attribute)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute()))
          (*header)[attribute.name()] = text->value();
    }
    return image;
  });
}

}  // namespace renderer
