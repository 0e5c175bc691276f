#include "station/documents/srgb.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <regex>
#include <stdexcept>

#include "calibration/light/colour_chart.h"
#include "renderer/picture/srgb.h"
#include "station/documents/disk/shown_text.h"

namespace station {
namespace {

std::optional<Eigen::Vector3d> lab_colour(const std::string& text) {
  static const std::string number = R"(([-+]?\d+\.?\d*))", comma = R"((?:\s*,\s*|\s+))";
  static const std::regex written(R"(lab\(\s*)" + number + comma + number + comma + number + R"(\s*\))");
  constexpr std::size_t kMostText = 60;  // so that each number is one
  std::smatch found;
  if (text.size() > kMostText || !std::regex_match(text, found, written)) return std::nullopt;
  return Eigen::Vector3d(std::stod(found[1]), std::stod(found[2]), std::stod(found[3]));
}

Srgb8 srgb_of_lab(const std::string& text, const Eigen::Vector3d& lab) {
  constexpr double kRounding = 0.004;  // of linear light: that of Lab's last digits
  const Eigen::Vector3d linear = calibration::linear_srgb_of_lab(lab);
  const Srgb8 nearest = srgb_of_linear(linear);
  if (linear.minCoeff() < -kRounding || linear.maxCoeff() > 1 + kRounding)
    throw std::runtime_error("found the colour \"" + text + "\", which sRGB does not hold; near it is " +
                             hex_text(nearest));
  return nearest;
}

}  // namespace

Srgb8 srgb_of_linear(const Eigen::Vector3d& linear) {
  Srgb8 colour{};
  for (std::size_t c = 0; c < colour.size(); ++c) {
    const auto clipped = static_cast<float>(std::clamp(linear[static_cast<Eigen::Index>(c)], 0.0, 1.0));
    colour.at(c) = static_cast<unsigned char>(std::lround(255 * renderer::srgb_encoded(clipped)));
  }
  return colour;
}

std::string hex_text(const Srgb8& colour) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", colour[0], colour[1], colour[2]);
  return text.data();
}

std::optional<Srgb8> hex_colour(const std::string& text) {
  const char* end = text.data() + text.size();
  unsigned int rgb = 0;
  if (text.size() != 7 || text[0] != '#' || std::from_chars(text.data() + 1, end, rgb, 16).ptr != end)
    return std::nullopt;
  return Srgb8{static_cast<unsigned char>(rgb >> 16), static_cast<unsigned char>(rgb >> 8 & 255),
               static_cast<unsigned char>(rgb & 255)};
}

Srgb8 parse_colour(const std::string& text) {
  if (const auto colour = hex_colour(text)) return *colour;
  if (const auto colour = named_colour(text)) return *colour;
  if (const auto lab = lab_colour(text)) return srgb_of_lab(text, *lab);
  throw std::runtime_error("found the colour \"" + shown_text(text) +
                           "\", expected one like \"#c01830\", a name like crimson, or \"lab(40 60 30)\"");
}

}  // namespace station
