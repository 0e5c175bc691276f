#include "tests/rig/simulated/raw_reader.h"

#include <libraw/libraw.h>

#include <stdexcept>

ReadRaw read_raw(const std::vector<std::byte>& bytes) {
  LibRaw reader;
  if (reader.open_buffer(const_cast<std::byte*>(bytes.data()), bytes.size()) != LIBRAW_SUCCESS ||
      reader.unpack() != LIBRAW_SUCCESS || reader.imgdata.rawdata.raw_image == nullptr)
    throw std::runtime_error("LibRaw does not read the file as a mosaic");
  const libraw_data_t& data = reader.imgdata;
  ReadRaw raw;
  cv::Mat1w(data.sizes.raw_height, data.sizes.raw_width, data.rawdata.raw_image, data.sizes.raw_pitch)
      .copyTo(raw.mosaic);
  raw.make = data.idata.make;
  raw.model = data.idata.model;
  raw.serial = data.shootinginfo.BodySerial;
  for (const auto& [row, column] : {std::pair{0, 0}, std::pair{0, 1}, std::pair{1, 0}, std::pair{1, 1}})
    raw.filters += data.idata.cdesc[reader.COLOR(row, column)];
  raw.black_dn = data.color.black;
  raw.maximum_dn = data.color.maximum;
  raw.exposure_s = static_cast<double>(data.other.shutter);
  raw.iso = static_cast<double>(data.other.iso_speed);
  raw.f_number = static_cast<double>(data.other.aperture);
  raw.unix_s = static_cast<long>(data.other.timestamp);
  return raw;
}
