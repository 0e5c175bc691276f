#include "station/cloth/export/pbr_maps.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "renderer/picture/image_file.h"

namespace station {
namespace {

using Eigen::Array3d;

Array3d linear(const cv::Vec3b& srgb) {
  const cv::Vec3f decoded = renderer::linear_of_srgb(srgb);
  return {decoded[0], decoded[1], decoded[2]};
}

unsigned char byte_of(double share) {
  return cv::saturate_cast<unsigned char>(255 * share);
}

// Fills holes with the colours of the nearest yarns; otherwise a viewer that blends neighbouring texels would darken
// the yarns' rims.
void fill_holes(cv::Mat3f& color, const cv::Mat1f& opacity) {
  cv::Mat1b empty;
  cv::compare(opacity, 0, empty, cv::CMP_LE);
  for (int reach = 1; cv::countNonZero(empty) > 0 && reach < std::max(color.rows, color.cols); reach *= 2) {
    cv::Mat1f weight = opacity.clone();
    weight.setTo(1, empty == 0);
    weight.setTo(0, empty);
    cv::Mat3f weighted;
    cv::Mat weights3;
    cv::merge(std::vector<cv::Mat>{weight, weight, weight}, weights3);
    cv::multiply(color, weights3, weighted);
    const auto around = [&](const cv::Mat& picture) {
      cv::Mat wide;
      cv::copyMakeBorder(picture, wide, reach, reach, reach, reach, cv::BORDER_WRAP);
      cv::blur(wide, wide, {2 * reach + 1, 2 * reach + 1});
      return cv::Mat(wide({reach, reach, picture.cols, picture.rows}).clone());
    };
    const cv::Mat3f sums = around(weighted);
    const cv::Mat1f totals = around(weight);
    for (int row = 0; row < color.rows; ++row)
      for (int column = 0; column < color.cols; ++column) {
        if (empty(row, column) == 0 || totals(row, column) < 1e-6f) continue;
        color(row, column) = sums(row, column) / totals(row, column);
        empty(row, column) = 0;
      }
  }
}

// A texel's diffuse colours in glTF's terms. The share is the least that lets all of the light through, so that a
// viewer without the extension shows the cloth hardly brighter than it is.
struct DiffuseParts {
  Array3d base, transmitted;
  double share;
};

DiffuseParts parts_of(const DiffuseColors& diffuse) {
  const double share = std::min(0.95, diffuse.transmitted.maxCoeff());
  return {(diffuse.reflected / (1 - share)).min(1), share > 0 ? Array3d(diffuse.transmitted / share) : Array3d::Ones(),
          share};
}

// The normal as the map has it; a scale that leaves nothing of the map's normals is taken for 1.
Eigen::Vector3d unscaled_normal(const Eigen::Vector3d& shaded, double scale) {
  const double by = scale > 0.01 ? scale : 1;
  return Eigen::Vector3d(shaded.x() / by, shaded.y() / by, shaded.z()).normalized();
}

cv::Mat3b times_linear(const cv::Mat3b& srgb, double factor) {
  cv::Mat3f product(srgb.size());
  for (int row = 0; row < srgb.rows; ++row)
    for (int column = 0; column < srgb.cols; ++column)
      product(row, column) = color_of(factor * linear(srgb(row, column)));
  return renderer::encode_srgb(product, 1);
}

}  // namespace

PbrMaps maps_of(const BakedSide& side, const GltfShader& shader) {
  const cv::Size size = side.opacity.size();
  const std::vector<PbrTexel> texels = texels_of(side, shader, std::max(size.width, size.height));
  cv::Mat3f base(size), transmitted(size), specular(size), sheen(size);
  cv::Mat1f share(size);
  PbrMaps maps{
      .gloss = cv::Mat1b(size), .opacity = cv::Mat1b(size), .normal = cv::Mat3b(size), .transmission = cv::Mat1b(size)};
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column) {
      const PbrTexel& texel = texels[static_cast<std::size_t>(row) * static_cast<std::size_t>(size.width) +
                                     static_cast<std::size_t>(column)];
      const DiffuseParts parts = parts_of(texel.diffuse);
      base(row, column) = color_of(parts.base);
      transmitted(row, column) = color_of(parts.transmitted);
      share(row, column) = static_cast<float>(parts.share);
      maps.gloss(row, column) = byte_of(texel.gloss.strength);
      specular(row, column) = color_of(texel.gloss.specular_color);
      sheen(row, column) = color_of(texel.gloss.strength * texel.gloss.sheen_color);
      maps.opacity(row, column) = byte_of(texel.opacity);
      const Eigen::Vector3d normal = unscaled_normal(texel.normal, shader.material().normal_scale);
      for (int c = 0; c < 3; ++c) maps.normal(row, column)[c] = byte_of((normal[c] + 1) / 2);
    }
  for (cv::Mat3f* color : {&base, &transmitted, &specular, &sheen}) fill_holes(*color, side.opacity);
  cv::minMaxLoc(share, nullptr, &maps.transmission_factor);
  share.convertTo(maps.transmission, CV_8U, 255 / std::max(1e-6, maps.transmission_factor));
  maps.base_color = renderer::encode_srgb(base, 1);
  maps.transmission_color = renderer::encode_srgb(transmitted, 1);
  maps.specular_color = renderer::encode_srgb(specular, 1);
  maps.sheen_color = renderer::encode_srgb(sheen, 1);
  return maps;
}

PbrTexel texel_of(const PbrMaps& maps, int row, int column, double normal_scale) {
  const cv::Vec3b& n = maps.normal(row, column);
  const cv::Vec3f normal(static_cast<float>(n[0]) / 127.5f - 1, static_cast<float>(n[1]) / 127.5f - 1,
                         static_cast<float>(n[2]) / 127.5f - 1);
  const double share = maps.transmission_factor * maps.transmission(row, column) / 255.0,
               strength = maps.gloss(row, column) / 255.0;
  return {.normal = scaled_normal(normal, normal_scale),
          .opacity = maps.opacity(row, column) / 255.0,
          .gloss = {.strength = strength,
                    .specular_color = linear(maps.specular_color(row, column)),
                    .sheen_color = linear(maps.sheen_color(row, column)) / std::max(strength, 1.0 / 255)},
          .diffuse = {(1 - share) * linear(maps.base_color(row, column)),
                      share * linear(maps.transmission_color(row, column))}};
}

std::vector<PbrTexel> texels_of(const PbrMaps& maps, double normal_scale) {
  std::vector<PbrTexel> texels;
  for (int row = 0; row < maps.opacity.rows; ++row)
    for (int column = 0; column < maps.opacity.cols; ++column)
      texels.push_back(texel_of(maps, row, column, normal_scale));
  return texels;
}

Array3d mean_color(const cv::Mat3b& srgb) {
  Array3d sum = Array3d::Zero();
  for (const cv::Vec3b& pixel : srgb) sum += linear(pixel);
  return sum / static_cast<double>(srgb.total());
}

cv::Mat4b with_alpha(const cv::Mat3b& rgb, const cv::Mat1b& alpha) {
  cv::Mat4b both;
  cv::merge(std::vector<cv::Mat>{rgb, alpha}, both);
  return both;
}

void write_texture_set(const std::filesystem::path& folder, const PbrMaps& maps, const GltfMaterial& material) {
  const cv::Size size = maps.opacity.size();
  const auto grey = [&](double value) { return cv::Mat1b(size, byte_of(value)); };
  const auto scaled = [](const cv::Mat1b& map, double factor) {
    cv::Mat1b product;
    map.convertTo(product, CV_8U, factor);
    return product;
  };
  renderer::write_png(folder / "base_color.png", maps.base_color);
  renderer::write_png(folder / "opacity.png", maps.opacity);
  renderer::write_png(folder / "normal.png", maps.normal);
  renderer::write_png(folder / "transmission.png", scaled(maps.transmission, maps.transmission_factor));
  renderer::write_png(folder / "transmission_color.png", maps.transmission_color);
  renderer::write_png(folder / "roughness.png", grey(material.roughness));
  renderer::write_png(folder / "specular.png", scaled(maps.gloss, material.specular));
  renderer::write_png(folder / "specular_color.png", maps.specular_color);
  renderer::write_png(folder / "sheen_color.png", times_linear(maps.sheen_color, material.sheen));
  renderer::write_png(folder / "sheen_roughness.png", grey(material.sheen_roughness));
}

}  // namespace station
