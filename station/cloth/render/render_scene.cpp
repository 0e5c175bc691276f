#include "station/cloth/render/render_scene.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "renderer/picture/denoise.h"
#include "renderer/picture/image_file.h"
#include "renderer/trace/path_tracer.h"
#include "station/cloth/render/checkpoint.h"
#include "station/cloth/render/render_channels.h"
#include "station/cloth/render/render_progress.h"
#include "station/cloth/render/white_card.h"
#include "station/documents/disk/reserved_space.h"
#include "station/documents/number_text.h"
#include "station/documents/session_file.h"
#include "station/output/display.h"
#include "station/output/interrupt.h"
#include "station/output/picture_destination.h"
#include "station/output/progress.h"

namespace station {
namespace {

using Clock = std::chrono::steady_clock;

void check_destination(const RenderRequest& request) {
  check_picture_destination(request.out);
  if (request.out.extension() != ".exr" && (request.layers || request.half))
    throw std::runtime_error("cannot write " + request.out.string() +
                             ": --layers and --half are for EXR files; give --out a name that ends in .exr");
}

// How PNG pictures are exposed where somebody says so. Errors: std::runtime_error, one line, for a card in the dark.
std::optional<Exposure> given_exposure(const RenderRequest& request, const SceneFile& scene) {
  if (const auto brightness = request.brightness ? request.brightness : scene.brightness)
    return Exposure{.white = {1 / *brightness, 1 / *brightness, 1 / *brightness}};
  if (!scene.white_card) return std::nullopt;
  const Exposure exposure{.white = radiance_of_white_card(scene, *scene.white_card)};
  if (!(*std::ranges::min_element(exposure.white) > 0))
    throw std::runtime_error(scene.source +
                             ": key \"white_card\": no light reaches its face; turn its normal to a lamp");
  return exposure;
}

constexpr const char* kRenderingAttribute = "threadstation/rendering";

// All that decides what stands in an EXR file.
std::string rendering_of(const RenderRequest& request, const RenderIdentity& identity) {
  nlohmann::json rendering = to_json(identity);
  rendering["layers"] = request.layers;
  rendering["half"] = request.half;
  return rendering.dump();
}

std::filesystem::path png_beside(const std::filesystem::path& picture) {
  std::filesystem::path png = picture;
  return png.replace_extension(".png");
}

// What is written with the picture.
std::vector<std::filesystem::path> pictures_beside(const RenderRequest& request) {
  std::vector<std::filesystem::path> beside;
  if (request.png) beside.push_back(png_beside(request.out));
  if (request.denoise) beside.push_back(denoised_of(request.out));
  if (request.png && request.denoise) beside.push_back(png_beside(denoised_of(request.out)));
  return beside;
}

bool is_finished(const RenderRequest& request, const RenderIdentity& identity) {
  std::error_code ignored;
  if (request.out.extension() != ".exr" || !std::filesystem::exists(request.out, ignored)) return false;
  for (const std::filesystem::path& beside : pictures_beside(request))
    if (!std::filesystem::exists(beside, ignored)) return false;
  try {
    renderer::ImageHeader header;
    renderer::read_exr(request.out, &header);
    return header[kRenderingAttribute] == rendering_of(request, identity);
  } catch (const std::runtime_error&) {
    return false;  // a file that is damaged is made again
  }
}

struct Rendering {
  RenderRanks& ranks;
  const RenderRequest& request;
  const SceneFile& scene;
  const std::vector<BuiltCloth>& cloths;
  const RenderIdentity& identity;
  const std::optional<Exposure> given_exposure;

  Exposure exposure(const cv::Mat3f& image) const {
    const double white = given_exposure ? 0 : 1 / display_scale(image);
    return given_exposure.value_or(Exposure{.white = {white, white, white}});
  }
};

// The same for the picture and for what is made of it.
renderer::ImageHeader header_of(const Rendering& rendering) {
  const RenderIdentity& identity = rendering.identity;
  return {{"threadstation/scene", rendering.scene.name},
          {"threadstation/software", identity.software},
          {"threadstation/samples_per_pixel", std::to_string(identity.samples_per_pixel)},
          {"threadstation/noise", std::to_string(identity.noise)},
          {"threadstation/seed", std::to_string(identity.seed)}};
}

void write_exr(const Rendering& rendering, const renderer::PictureLayers* layers, const cv::Mat3f& image) {
  const RenderRequest& request = rendering.request;
  renderer::ImageHeader header = header_of(rendering);
  header[kRenderingAttribute] = rendering_of(request, rendering.identity);
  header["threadstation/content"] = "linear camera RGB, radiance; not white-balanced";
  renderer::write_exr(request.out, render_channels(image, layers, rendering.scene, rendering.cloths, request.half),
                      header);
}

void write_denoised(const Rendering& rendering, const renderer::PictureLayers& layers, const renderer::Film& film,
                    const Exposure& exposure) {
  const RenderRequest& request = rendering.request;
  const std::filesystem::path out = denoised_of(request.out);
  renderer::NoisyPicture noisy = renderer::noisy_picture(film);
  noisy.features = renderer::features_of(layers);
  const cv::Mat3f image = renderer::denoised(noisy);
  if (out.extension() != ".exr" || request.png)
    renderer::write_png(png_beside(out), display(image, exposure, rendering.scene.linear_srgb_from_camera));
  if (out.extension() != ".exr") return;
  renderer::ImageHeader header = header_of(rendering);
  header["threadstation/content"] = "linear camera RGB, denoised for looking at it; measure in the picture beside it";
  renderer::write_exr(out, render_channels(image, nullptr, rendering.scene, rendering.cloths, request.half), header);
}

void write_pictures(const Rendering& rendering, const renderer::PathTracer& tracer, const renderer::Film& film,
                    RenderReport& report) {
  const auto& [ranks, request, scene, cloths, identity, given] = rendering;
  const cv::Mat3f image = renderer::mean_radiance(film);
  const bool is_exr = request.out.extension() == ".exr";
  std::optional<renderer::PictureLayers> layers;
  if (request.layers || request.denoise)
    layers = tracer.layers(
        scene.camera,
        {.samples_per_pixel = identity.samples_per_pixel, .seed = identity.seed, .threads = request.threads});
  Exposure exposure;
  if (!is_exr || request.png) {
    exposure = rendering.exposure(image);
    report.brightness = 1 / exposure.white[1];
    renderer::write_png(png_beside(request.out), display(image, exposure, scene.linear_srgb_from_camera));
  }
  if (request.denoise) write_denoised(rendering, *layers, film, exposure);
  if (is_exr) write_exr(rendering, request.layers ? &*layers : nullptr, image);
}

// Room on the picture's disk for its checkpoint, held until the end: then the picture, which mostly takes less, is
// written into it, or the checkpoint where that fails.
class Room {
 public:
  Room(const RenderRequest& request, const renderer::Film& film, const RenderRanks& ranks)
      : held_(reserve_space(request.out.parent_path(), room_of(film, ranks) + kHead)) {}
  void release() { held_ = OpenFile(); }

 private:
  static constexpr std::size_t kHead = std::size_t{64} << 10U;  // of a checkpoint, at most
  static std::size_t room_of(const renderer::Film& film, const RenderRanks& ranks) {
    const std::size_t all = renderer::bytes_of(film), goals = film.goals.total() * film.goals.elemSize();
    if (ranks.alone()) return all;
    const std::size_t part =
        goals + sizeof(renderer::TileRecord) * renderer::tiles_in(ranks.share(), film.goals.cols).size();
    return ranks.first() ? std::max(all, part) : part;  // the first writes the picture
  }
  OpenFile held_;
};

// A checkpoint to go on from; one of several ranks stores its part of it.
void keep(const Rendering& rendering, const renderer::Film& film) {
  const renderer::TileShare& share = rendering.ranks.share();
  if (rendering.ranks.alone())
    store_checkpoint(checkpoint_of(rendering.request.out), rendering.identity, film);
  else
    store_part(part_of(rendering.request.out, share), rendering.identity, film, share);
}

// A checkpoint to go on from, and a picture of it to look at. Where the disk is full the rendering goes on without one
// as long as nobody stops it.
void leave_behind(const Rendering& rendering, Room& room, const renderer::Film& film, ProgressDisplay& progress) {
  try {
    keep(rendering, film);
    if (!rendering.ranks.first()) return;
    const cv::Mat3f image = renderer::mean_radiance(film);
    renderer::write_png(preview_of(rendering.request.out),
                        display(image, rendering.exposure(image), rendering.scene.linear_srgb_from_camera));
  } catch (const std::runtime_error& problem) {
    if (!interrupted()) {
      progress.note(std::string(problem.what()) + " (the rendering goes on)");
      return;
    }
    room.release();
    keep(rendering, film);
  }
}

// Writes the picture into the room that was held for it; where that fails its film stays as a checkpoint, and the
// message says so.
void finish(const Rendering& rendering, const renderer::PathTracer& tracer, Room& room, const renderer::Film& film,
            RenderReport& report) {
  room.release();
  try {
    write_pictures(rendering, tracer, film, report);
  } catch (const std::runtime_error& problem) {
    store_checkpoint(checkpoint_of(rendering.request.out), rendering.identity, film);
    throw std::runtime_error(std::string(problem.what()) +
                             "; nothing is lost: " + checkpoint_of(rendering.request.out).string() +
                             " has the whole rendering, and the same command then writes the picture");
  }
}

void remove_what_was_left(const std::filesystem::path& out) {
  std::error_code ignored;
  std::filesystem::remove(checkpoint_of(out), ignored);
  std::filesystem::remove(preview_of(out), ignored);
  remove_parts(out);
}

// What is there of the picture already: read by the first rank, for all. Parts are made one checkpoint, because who
// drew them may not be there this time.
renderer::Film film_to_begin_with(const RenderRequest& request, const RenderIdentity& identity, const cv::Size& size,
                                  RenderRanks& ranks) {
  std::optional<renderer::Film> film;
  if (ranks.first()) {
    if (request.fresh) remove_what_was_left(request.out);
    try {
      film = read_checkpoint(request.out, identity, size);
    } catch (const std::runtime_error&) {
      if (!request.only_this) throw;
      remove_what_was_left(request.out);
    }
    if (film && has_parts(request.out)) {
      store_checkpoint(checkpoint_of(request.out), identity, *film);
      remove_parts(request.out);
    }
  }
  const bool goes_on = ranks.of_first(film.has_value());
  if (!film) film = renderer::empty_film(size.width, size.height);
  if (goes_on) ranks.of_first(*film);
  return *film;
}

// Goes on with the film until it is finished. Errors: as render_scene.
renderer::RenderStatistics gather(const Rendering& rendering, const renderer::PathTracer& tracer, Room& room,
                                  RenderProgress& progress, renderer::Film& film) {
  Clock::time_point stored = Clock::now();
  double finished = 0;
  RenderRanks& ranks = rendering.ranks;
  const RenderIdentity& identity = rendering.identity;
  const auto go_on = [&](double fraction) {
    finished = fraction;
    progress.show(ranks.tell(fraction));
    return !interrupted() && seconds_since(stored) < rendering.request.checkpoint_every_s;
  };
  const auto end_pass = [&](renderer::Film& all) {
    return ranks.end_pass(all, identity.samples_per_pixel, identity.noise, [&] { return go_on(finished); });
  };
  renderer::RenderStatistics sum, part;
  const renderer::RenderOptions options{.samples_per_pixel = identity.samples_per_pixel,
                                        .noise = identity.noise,
                                        .seed = identity.seed,
                                        .threads = ranks.threads(rendering.request.threads),
                                        .progress = go_on,
                                        .statistics = &part,
                                        .share = ranks.share(),
                                        .end_pass = end_pass};
  for (bool all = false; !all;) {
    all = tracer.refine(rendering.scene.camera, options, film);
    sum.samples += part.samples, sum.rays += part.rays;
    if (all) break;
    leave_behind(rendering, room, film, progress.display());
    if (interrupted()) ranks.wait_for_parts();
    if (interrupted() && !ranks.first()) throw EndsWithOthers();
    if (interrupted())
      throw std::runtime_error("rendering was stopped on request at " +
                               std::to_string(static_cast<int>(100 * finished)) +
                               " %; the same command goes on with it, and " +
                               preview_of(rendering.request.out).string() + " shows what is there");
    stored = Clock::now();
  }
  return ranks.sum_of(sum);
}

// What weaving has computed, as bytes: computers with other libraries may round otherwise.
std::string numbers_of(const std::vector<BuiltCloth>& cloths) {
  std::string bytes;
  const auto append = [&bytes](const std::vector<Eigen::Vector3d>& points) {
    bytes.append(reinterpret_cast<const char*>(points.data()), points.size() * sizeof(Eigen::Vector3d));
  };
  for (const auto& [patch, shape] : cloths) {
    for (const renderer::Yarn& yarn : patch.yarns) append(yarn.control_points);
    if (const auto* garment = std::get_if<renderer::MeshShape>(&shape)) append(garment->mesh->vertices);
  }
  return bytes;
}

RenderIdentity identity_of(const RenderRequest& request, const SceneFile& scene) {
  return {.scene_sha256 = sha256_of_scene(request.scene),
          .software = software_version(),
          .seed = request.seed,
          .samples_per_pixel =
              request.samples_per_pixel.value_or(request.noise > 0 ? kMostSamples : scene.samples_per_pixel),
          .noise = request.noise};
}

void report_noise(const renderer::Film& film, double asked, RenderReport& report) {
  double squares = 0, noisy = 0;
  const std::vector<double> errors = renderer::relative_errors_of_tiles(film);
  for (const double error : errors) {
    squares += error * error;
    if (error > asked) ++noisy;
  }
  report.noise = std::sqrt(squares / static_cast<double>(errors.size()));
  report.noisy = asked > 0 ? noisy / static_cast<double>(errors.size()) : 0.0;
}

}  // namespace

std::optional<double> parse_noise(const std::string& text) {
  constexpr double kLeast = 1e-4, kMost = 1;
  std::istringstream in(text);
  double value = 0;
  std::string unit;
  if (in >> value) {
    in >> unit;
    if (unit == "%") value /= 100;
    if ((unit.empty() || unit == "%") && value >= kLeast && value <= kMost) return value;
  }
  return std::nullopt;
}

std::filesystem::path preview_of(const std::filesystem::path& picture) {
  std::filesystem::path preview = picture;
  return preview.replace_extension(".preview.png");
}

std::filesystem::path denoised_of(const std::filesystem::path& picture) {
  std::filesystem::path denoised = picture;
  return denoised.replace_extension(".denoised" + picture.extension().string());
}

bool is_kept(const RenderRequest& request, const SceneFile& scene) {
  return request.keep_finished && is_finished(request, identity_of(request, scene));
}

RenderReport render_scene(const RenderRequest& request, std::vector<BuiltCloth> cloths) {
  RenderRanks alone;
  return render_scene(request, alone, std::move(cloths));
}

RenderReport render_scene(const RenderRequest& request, RenderRanks& ranks, std::vector<BuiltCloth> cloths) {
  watch_interrupts();
  if (ranks.first()) check_destination(request);
  const Clock::time_point start = Clock::now();
  const SceneFile scene = read_scene(request.scene);
  const RenderIdentity identity = identity_of(request, scene);
  if (request.denoise && identity.samples_per_pixel <= renderer::kBatch)
    throw std::runtime_error("cannot denoise " + request.out.string() + " from " +
                             std::to_string(identity.samples_per_pixel) +
                             " samples per pixel, whose noise is not known; give --spp 32 or more");
  if (ranks.of_first(request.keep_finished && ranks.first() && is_finished(request, identity)))
    return {.image = request.out.string(), .kept = true};
  const std::optional<Exposure> exposure = given_exposure(request, scene);
  ranks.must_agree(to_json(identity).dump(), "scene");
  renderer::Film film = film_to_begin_with(request, identity, {scene.camera.width, scene.camera.height}, ranks);
  Room room(request, film, ranks);
  RenderProgress progress(request.task, ranks.first() ? request.progress : ProgressStyle::quiet);
  if (cloths.empty()) cloths = build_cloths(scene, progress.display());
  if (!ranks.alone()) ranks.must_agree(numbers_of(cloths), "cloth woven from the same draft");
  const renderer::PathTracer tracer(build_scene(scene, cloths));
  RenderReport report{.image = request.out.string(),
                      .width = scene.camera.width,
                      .height = scene.camera.height,
                      .samples_per_pixel = identity.samples_per_pixel,
                      .build_s = seconds_since(start),
                      .samples_before = renderer::samples_in(film)};
  const Rendering rendering{ranks, request, scene, cloths, identity, exposure};
  const Clock::time_point render_start = Clock::now();
  const renderer::RenderStatistics statistics = gather(rendering, tracer, room, progress, film);
  report.render_s = seconds_since(render_start);
  if (!ranks.first()) return report;
  report.samples = statistics.samples;
  report.rays = statistics.rays;
  report_noise(film, request.noise, report);
  finish(rendering, tracer, room, film, report);
  report.memory = memory_of(scene, cloths, tracer.memory(), film);
  remove_what_was_left(request.out);
  progress.display().finish("wrote " + report.image);
  return report;
}

nlohmann::json to_json(const RenderReport& report) {
  if (report.kept) return {{"image", report.image}, {"kept", true}};
  nlohmann::json document{{"image", report.image},         {"width_px", report.width},
                          {"height_px", report.height},    {"samples_per_pixel", report.samples_per_pixel},
                          {"exposure", report.brightness}, {"build_s", report.build_s},
                          {"render_s", report.render_s},   {"samples", report.samples},
                          {"rays", report.rays},           {"samples_before", report.samples_before},
                          {"noisy", report.noisy},         {"memory", to_json(report.memory)}};
  if (std::isfinite(report.noise)) document["noise"] = report.noise;  // a single batch of samples tells nothing of it
  return document;
}

std::string describe_times(const RenderReport& report) {
  const double seconds = std::max(report.render_s, 1e-9);
  return formatted("read and built in %.2f s\nrendered in %.2f s: %.4g samples/s, %.4g rays, %.4g rays/s\n",
                   report.build_s, report.render_s, static_cast<double>(report.samples) / seconds,
                   static_cast<double>(report.rays), static_cast<double>(report.rays) / seconds);
}

std::string describe_noise(const RenderReport& report) {
  if (!std::isfinite(report.noise)) return "too few samples to tell the noise\n";
  return formatted(
      "noise %.2f %% of the brightness after %.1f samples per pixel, missed in %.1f %%\n", 100 * report.noise,
      static_cast<double>(report.samples + report.samples_before) / report.width / report.height, 100 * report.noisy);
}

}  // namespace station
