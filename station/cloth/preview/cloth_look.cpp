#include "station/cloth/preview/cloth_look.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <functional>
#include <iostream>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "renderer/picture/denoise.h"
#include "renderer/picture/image_file.h"
#include "renderer/trace/path_tracer.h"
#include "station/cloth/preview/cloth_stage.h"
#include "station/cloth/render/build_scene.h"
#include "station/cloth/render/white_card.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/scene_file.h"
#include "station/output/display.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

struct AskedLook {
  int number = 0;
  ClothView view{};
};

AskedLook look_of(const std::string& line) {
  const json document = json::parse(line, nullptr, false);
  if (!document.is_object() || !document.contains("look") || !document["look"].is_number_integer())
    throw std::runtime_error("a look was asked for by '" + line.substr(0, 80) +
                             "', which is no view; give a line such as {\"look\": 1, \"turn_deg\": 30}");
  const AskedLook asked{document["look"].get<int>(), cloth_view_of(document)};
  if (const auto problem = problem_of(asked.view)) throw std::runtime_error(*problem);
  return asked;
}

// The lines of whoever looks, of which only the last one counts.
class Looks {
 public:
  explicit Looks(int descriptor) : descriptor_(descriptor) {}

  // Waits at most so long for a line. True when there is one that next() has not taken, or ctrl-C came.
  bool wait(int longest_ms) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(longest_ms);
    while (!asked_ && !interrupted() && !closed_) {
      pollfd one{.fd = descriptor_, .events = POLLIN, .revents = 0};
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
      if (poll(&one, 1, std::max(0, static_cast<int>(left.count()))) <= 0) break;
      read_more();
    }
    return asked_ || interrupted();
  }
  // The line that came last.
  std::optional<AskedLook> next() { return std::exchange(asked_, std::nullopt); }

 private:
  void read_more() {
    std::array<char, 4096> bytes{};
    const ssize_t count = read(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) return;
    if (count <= 0) {
      closed_ = true;
      return;
    }
    open_.append(bytes.data(), static_cast<std::size_t>(count));
    for (std::size_t end = 0; (end = open_.find('\n')) != std::string::npos; open_.erase(0, end + 1))
      asked_ = look_of(open_.substr(0, end));
  }

  int descriptor_;
  bool closed_ = false;
  std::string open_;
  std::optional<AskedLook> asked_;
};

// The cloth and its shape, which stay; lamps and camera go with the view.
class Studio {
 public:
  Studio(const ClothLookRequest& request, const ClothStage& stage)
      : folder_(request.cloth.out),
        stage_(stage),
        scale_(request.size_px > 0 ? scale_to(stage, request.size_px) : 1),
        woven_(weave_threads(request.cloth, request.progress_style)) {
    ProgressDisplay progress("look", request.progress_style);
    const SceneFile scene = scene_of({});
    cloths_ = build_cloths(scene, progress);
    exposure_.white = radiance_of_white_card(scene, scene.white_card.value());
  }

  void turn(const ClothView& view) {
    const bool same_light = view.light_turn_deg == view_.light_turn_deg && view.light_tilt_deg == view_.light_tilt_deg;
    scene_ = scene_of(view);
    view_ = view;
    if (!tracer_ || !same_light) tracer_.emplace(build_scene(scene_, cloths_));
  }

  const renderer::PathTracer& tracer() const { return *tracer_; }
  const renderer::Camera& camera() const { return scene_.camera; }
  cv::Size size() const { return {scene_.camera.width, scene_.camera.height}; }
  cv::Mat3b shown(const cv::Mat3f& linear) const { return display(linear, exposure_, woven_.linear_srgb_from_camera); }

 private:
  SceneFile scene_of(const ClothView& view) const {
    return parse_scene(scene_on_stage(stage_, {woven_.files, woven_.fibers}, view, scale_), stage_.scene, folder_);
  }

  fs::path folder_;
  const ClothStage& stage_;
  double scale_;
  WovenThreads woven_;
  ClothView view_;
  SceneFile scene_;
  std::vector<BuiltCloth> cloths_;
  Exposure exposure_;
  std::optional<renderer::PathTracer> tracer_;
};

renderer::Camera coarse(renderer::Camera camera, int times) {
  const double scale = 1.0 / times;
  camera.width = std::max(1, camera.width / times), camera.height = std::max(1, camera.height / times);
  camera.fx *= scale, camera.fy *= scale;
  camera.cx = (camera.cx + 0.5) * scale - 0.5, camera.cy = (camera.cy + 0.5) * scale - 0.5;
  return camera;
}

class Look {
 public:
  Look(const ClothLookRequest& request, Looks& looks)
      : request_(request), looks_(looks), studio_(request, cloth_stage(request.shape)) {}

  // Shows it until another view is asked for, or this one is as good as it gets.
  void show(const AskedLook& asked) {
    asked_ = asked;
    studio_.turn(asked.view);
    struct Pass {
      int times, samples;  // coarser than the picture; in all, of each pixel
    };
    std::vector<Pass> passes{{6, 4}, {2, 4}};
    for (int samples = 2; samples < request_.samples_per_pixel; samples *= 2) passes.push_back({1, samples});
    passes.push_back({1, request_.samples_per_pixel});
    std::optional<TwoFilms> films;
    for (const auto& [times, samples] : passes) {
      if (!films || times != films->times) films.emplace(coarse(studio_.camera(), times), times);
      if (!draw(samples, *films)) return;
      cv::Mat3f picture = renderer::denoised(films->picture);
      if (looks_.wait(0)) return;
      if (times > 1) cv::resize(cv::Mat3f(picture), picture, studio_.size(), 0, 0, cv::INTER_LINEAR);
      put(picture, times > 1 ? 0 : samples);
    }
  }

 private:
  // A picture that is drawn twice, each time with half the samples, so that its noise is known from the beginning.
  struct TwoFilms {
    TwoFilms(const renderer::Camera& seen, int coarser)
        : camera(seen),
          times(coarser),
          one(renderer::empty_film(seen.width, seen.height)),
          other(renderer::empty_film(seen.width, seen.height)) {}
    renderer::Camera camera;
    int times;
    renderer::Film one, other;
    renderer::NoisyPicture picture{};
    int samples_of_features = 0;
  };

  // False when another view was asked for before all samples were there.
  bool draw(int samples, TwoFilms& films) {
    constexpr int kOfFeatures = 16;
    const renderer::PathTracer& tracer = studio_.tracer();
    const int half = std::max(1, samples / 2), of_features = std::min(samples, kOfFeatures);
    for (auto [seed, film] : {std::pair{1, &films.one}, {2, &films.other}})
      if (!tracer.refine(
              films.camera,
              {.samples_per_pixel = half, .seed = static_cast<std::uint64_t>(seed), .progress = undisturbed()}, *film))
        return false;
    std::vector<cv::Mat1f> features = std::move(films.picture.features);
    if (films.samples_of_features < of_features)
      features = renderer::features_of(tracer.layers(films.camera, {.samples_per_pixel = of_features}));
    films.samples_of_features = of_features;
    films.picture = renderer::noisy_picture(films.one, films.other);
    films.picture.features = std::move(features);
    return !looks_.wait(0);
  }

  std::function<bool(double)> undisturbed() {
    return [this](double) { return !looks_.wait(0); };
  }

  void put(const cv::Mat3f& linear, int samples) {
    const std::string png = renderer::encode_png(studio_.shown(linear));
    FileSystem disk;
    store_file(disk, request_.cloth.out / kLookPicture, std::as_bytes(std::span(png)));
    std::cout << json{{"shown",
                       {{"look", asked_.number},
                        {"picture", ++pictures_},
                        {"samples", samples},
                        {"of", request_.samples_per_pixel}}}}
                     .dump()
              << std::endl;
  }

  const ClothLookRequest& request_;
  Looks& looks_;
  Studio studio_;
  AskedLook asked_;
  int pictures_ = 0;
};

}  // namespace

void look_at_cloth(const ClothLookRequest& request) {
  constexpr int kLongest_ms = 3'600'000;
  watch_interrupts();
  Looks looks(request.input);
  Look look(request, looks);
  for (std::optional<AskedLook> asked = AskedLook{}; asked && !interrupted(); asked = looks.next()) {
    look.show(*asked);
    looks.wait(kLongest_ms);
  }
}

}  // namespace station
