#include "station/cloth/export/export_cloth.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "renderer/picture/image_file.h"
#include "rig/devices/clock.h"
#include "station/cloth/export/gltf_file.h"
#include "station/cloth/export/u3m_file.h"
#include "station/cloth/render/render_progress.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A new folder under a temporary name, which disappears again unless keep() gives it its final name.
class NewFolder {
 public:
  explicit NewFolder(fs::path final_name) : final_(std::move(final_name)) {
    if (!final_.has_filename()) final_ = final_.parent_path();  // written with a slash at its end
    if (final_.empty()) throw std::runtime_error("--out is empty; give it the name of a folder");
    std::error_code ignored;
    if (fs::exists(fs::symlink_status(final_, ignored)))
      throw std::runtime_error(final_.string() + " is there already; give --out a new name, or remove it");
    temporary_ = final_.string() + "." + std::to_string(::getpid()) + ".partial";
    make_folder(temporary_);
  }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;
  ~NewFolder() {
    std::error_code ignored;
    fs::remove_all(temporary_, ignored);
  }
  const fs::path& path() const { return temporary_; }
  fs::path subfolder(const char* name) const {
    make_folder(temporary_ / name);
    return temporary_ / name;
  }
  void keep() { FileSystem().rename(temporary_, final_); }

 private:
  fs::path final_, temporary_;
};

ClothSample read_cloth(const ExportClothRequest& request, ProgressDisplay& progress) {
  return request.scene.empty() ? cloth_of_draft(request.draft, request.warp, request.weft, progress)
                               : cloth_of_scene(request.scene, progress);
}

void check_memory(const ExportClothRequest& request, const cv::Size& size) {
  const double most = request.most_bytes > 0 ? request.most_bytes
                                             : 0.5 * static_cast<double>(::sysconf(_SC_PHYS_PAGES)) *
                                                   static_cast<double>(::sysconf(_SC_PAGESIZE));
  const double needed = bake_bytes(size);
  if (needed <= most) return;
  char text[160];
  std::snprintf(
      text, sizeof text,
      "textures of %d x %d pixels would take %.1f GB of memory and %.1f GB may be used; give a smaller --size",
      size.width, size.height, needed / 1e9, most / 1e9);
  throw std::runtime_error(text);
}

// The samples of the far field and of the sheet, in proportion to those of a texel.
struct Quality {
  int per_pair, sheet;
};

Quality quality_of(const ExportClothRequest& request) {
  return {256 * request.samples_per_texel, std::max(1, request.samples_per_texel / 2)};
}

// The progress of the whole work, in stages whose shares are the paths that they trace.
class Stages {
 public:
  explicit Stages(ProgressStyle style) : progress_("export cloth", style) {}
  PartProgress stage(double share) {
    const double begin = begun_;
    begun_ += share;
    return [this, begin, share](double part) {
      progress_.show(begin + share * part);
      return !interrupted();
    };
  }
  ProgressDisplay& display() { return progress_.display(); }
  void finish(const std::string& text) { progress_.display().finish(text); }

 private:
  RenderProgress progress_;
  double begun_ = 0;
};

Eigen::Array3d mean_of(const cv::Mat3f& picture) {
  const cv::Scalar mean = cv::mean(picture);
  return {mean[0], mean[1], mean[2]};
}

EvenLight::Seen mean_seen(const std::vector<PbrTexel>& texels, const GltfShader& shader) {
  const EvenLight even(shader);
  EvenLight::Seen mean{Eigen::Array3d::Zero(), Eigen::Array3d::Zero()};
  for (const PbrTexel& texel : texels) {
    const EvenLight::Seen seen = even.seen(texel);
    mean.reflectance += texel.opacity * seen.reflectance / static_cast<double>(texels.size());
    mean.transmittance += texel.opacity * seen.transmittance / static_cast<double>(texels.size());
  }
  return mean;
}

json list(const Eigen::Array3d& color) {
  return {color[0], color[1], color[2]};
}

json agreement_json(const ExportClothReport& report) {
  return {{"light_from_the_front", to_json(report.front_light)}, {"light_from_behind", to_json(report.back_light)}};
}

json weave_json(const renderer::YarnPatch& patch) {
  int ends = 0, picks = 0;
  for (const renderer::Yarn& yarn : patch.yarns) ++(yarn.warp ? ends : picks);
  return {{"name", patch.name},
          {"ends", ends},
          {"picks", picks},
          {"period_mm", {patch.period_x_mm, patch.period_y_mm}},
          {"crimp_warp", patch.crimp_warp},
          {"crimp_weft", patch.crimp_weft},
          {"cover", patch.cover}};
}

std::string error_text(const ExportClothReport& report) {
  return formatted(
      "seen from afar it is a CIEDE2000 of %.1f off in light from the front (95 %% of directions below %.1f)",
      report.front_light.mean_delta_e, report.front_light.delta_e_95);
}

struct Made {
  const ClothSample& cloth;
  const BakedCloth& baked;
  const GltfShader& shader;
  const PbrMaps& front;
  const ClothSheet& sheet;
};

void write_formats(const NewFolder& folder, const ExportClothRequest& request, const Made& made,
                   const ExportClothReport& report) {
  const GltfMaterial& material = made.shader.material();
  if (request.formats.contains(ClothExport::textures))
    write_texture_set(folder.subfolder("textures"), made.front, material);
  if (request.formats.contains(ClothExport::gltf))
    write_gltf(folder.subfolder("gltf"), {.name = made.cloth.name,
                                          .period_x_mm = made.baked.width_mm,
                                          .period_y_mm = made.baked.height_mm,
                                          .maps = made.front,
                                          .material = material,
                                          .extras = {{"far_field", agreement_json(report)}}});
  if (request.formats.contains(ClothExport::u3m)) {
    const PbrMaps back = maps_of(made.baked.back, made.shader);
    write_u3m(folder.subfolder("u3m"),
              {.name = made.cloth.name,
               .description = "Baked by " + software_version() + " from digitized threads as a glTF material; " +
                              error_text(report) + ". The principled shader is a nearest equivalent of that one.",
               .utc = rig::SystemClock().utc(),
               .patch = made.cloth.patch,
               .front = made.front,
               .back = back,
               .material = material,
               .preview = made.sheet.preview,
               .preview_periods = kSheetPeriods,
               .custom = {{"threadstation",
                           {{"weave", weave_json(made.cloth.patch)}, {"gltf_far_field", agreement_json(report)}}}}});
  }
}

}  // namespace

ExportClothReport export_cloth(const ExportClothRequest& request) {
  watch_interrupts();
  Stages stages(request.progress);
  const ClothSample cloth = read_cloth(request, stages.display());
  const cv::Size size = bake_size(cloth, request.size_px);
  check_memory(request, size);
  NewFolder folder(request.out);
  const std::vector<DirectionPair> pairs = standard_pairs();
  const Quality quality = quality_of(request);
  const double bake_samples = 4.0 * size.area() * request.samples_per_texel,
               far_samples = static_cast<double>(pairs.size()) * quality.per_pair,
               sheet_samples =
                   paths_of_sheet(cloth, {.samples_per_pixel = quality.sheet, .samples_per_pair = quality.per_pair}),
               all_samples = bake_samples + far_samples + sheet_samples;
  const BakedCloth baked = bake_cloth(cloth, {.size_px = size,
                                              .samples_per_texel = request.samples_per_texel,
                                              .seed = request.seed,
                                              .progress = stages.stage(bake_samples / all_samples)});
  const std::vector<Eigen::Array3d> measured = far_field(cloth, pairs,
                                                         {.samples_per_pair = quality.per_pair,
                                                          .seed = request.seed,
                                                          .progress = stages.stage(far_samples / all_samples)});
  const PbrFit fit = fit_material(baked.front, pairs, measured);
  const GltfShader shader(fit.material);
  const PbrMaps front = maps_of(baked.front, shader);
  const std::vector<PbrTexel> texels = texels_of(front, fit.material.normal_scale);
  ExportClothReport report{.name = cloth.name,
                           .folder = request.out.string(),
                           .size_px = size,
                           .width_mm = baked.width_mm,
                           .height_mm = baked.height_mm,
                           .material = fit.material,
                           .converged = fit.converged,
                           .even_cloth = {mean_of(baked.front.reflectance), mean_of(baked.front.transmittance)},
                           .even_export = mean_seen(texels, shader),
                           .pairs = far_field_errors(texels, shader, pairs, measured)};
  report.front_light = agreement(report.pairs, true);
  report.back_light = agreement(report.pairs, false);
  const ClothSheet sheet = draw_sheet(cloth, front, shader,
                                      {.samples_per_pixel = quality.sheet,
                                       .samples_per_pair = quality.per_pair,
                                       .seed = request.seed,
                                       .progress = stages.stage(sheet_samples / all_samples)});
  report.views = sheet.views;
  renderer::write_png(folder.path() / "comparison.png", sheet.picture);
  write_formats(folder, request, {cloth, baked, shader, front, sheet}, report);
  write_json_file(folder.path() / "export.json", to_json(report));
  folder.keep();
  stages.finish("wrote " + report.folder);
  return report;
}

json to_json(const ExportClothReport& report) {
  json document{{"name", report.name},
                {"folder", report.folder},
                {"size_px", {report.size_px.width, report.size_px.height}},
                {"period_mm", {report.width_mm, report.height_mm}},
                {"material", to_json(report.material)},
                {"converged", report.converged},
                {"even_light",
                 {{"reflectance_cloth", list(report.even_cloth.reflectance)},
                  {"reflectance_export", list(report.even_export.reflectance)},
                  {"transmittance_cloth", list(report.even_cloth.transmittance)},
                  {"transmittance_export", list(report.even_export.transmittance)}}},
                {"far_field", agreement_json(report)}};
  for (const ComparedView& view : report.views) document["views"].push_back(to_json(view));
  for (const FarFieldError& error : report.pairs) document["pairs"].push_back(to_json(error));
  return document;
}

std::string describe(const ExportClothReport& report) {
  char text[600];
  std::snprintf(text, sizeof text,
                "%s: %d x %d pixels for %.3f x %.3f mm\n"
                "roughness %.2f, specular %.2f, sheen %.2f of roughness %.2f, normals x %.2f\n"
                "seen from afar, light in front: %.0f %% RMS, CIEDE2000 %.1f, 95 %% below %.1f\n"
                "seen from afar, light behind: %.0f %% RMS, CIEDE2000 %.1f, 95 %% below %.1f\n",
                report.folder.c_str(), report.size_px.width, report.size_px.height, report.width_mm, report.height_mm,
                report.material.roughness, report.material.specular, report.material.sheen,
                report.material.sheen_roughness, report.material.normal_scale, 100 * report.front_light.relative_rms,
                report.front_light.mean_delta_e, report.front_light.delta_e_95, 100 * report.back_light.relative_rms,
                report.back_light.mean_delta_e, report.back_light.delta_e_95);
  std::string all = text;
  for (const ComparedView& view : report.views) {
    std::snprintf(text, sizeof text, "%s: CIEDE2000 %.1f\n", view.name.c_str(), view.mean_delta_e);
    all += text;
  }
  if (!report.converged) all += "note: the material's fit did not settle; its errors are as stated\n";
  return all;
}

}  // namespace station
