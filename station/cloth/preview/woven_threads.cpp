#include "station/cloth/preview/woven_threads.h"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "station/cloth/cloth_colour.h"
#include "station/cloth/draft_of_one_thread.h"
#include "station/cloth/patch_picture.h"
#include "station/cloth/uneven_threads.h"
#include "station/documents/bundle_file.h"
#include "station/documents/draft_file.h"
#include "station/documents/patch_file.h"
#include "station/documents/reader.h"
#include "station/documents/thread_file.h"
#include "station/output/watched_work.h"

namespace station {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr int kWarp = 0, kWeft = 1;  // threads of the draft

bool is_bundle_file(const fs::path& file) {
  return read_json_file(file).value("format", "") == "threadstation/bundle";
}

// The threads of warp and weft, in this order.
using Systems = std::array<fs::path, 2>;
constexpr std::array<const char*, 2> kSystems{"warp", "weft"};

// Writes the threads of systems that are coloured, and copies where they are asked for; returns the thread files of
// warp and weft as the scenes name them.
std::array<std::string, 2> write_threads(const ThreadsToWeave& wanted, const Systems& own,
                                         const renderer::YarnPatch& patch, ProgressStyle progress_style,
                                         json& made_of) {
  std::array<std::string, 2> files;
  ProgressDisplay progress("cloth", progress_style);
  std::optional<ClothColours> colours;
  fs::path of;  // the thread whose colours these are
  for (std::size_t k = 0; k < kSystems.size(); ++k) {
    const std::string system = kSystems.at(k);
    const std::optional<Srgb8>& colour = k == kWarp ? wanted.warp_colour : wanted.weft_colour;
    if (colour) {
      if (is_bundle_file(own.at(k)))
        throw std::runtime_error("colours were given for a bundle, " + own.at(k).string() +
                                 ", and only a thread's absorption can be changed; leave them out, or take its thread");
      const ThreadFile thread = read_thread(own.at(k));
      if (of != own.at(k)) {
        constexpr int kParts = 100;
        colours.emplace(thread, patch, [&](double done) {
          progress.show(static_cast<int>(kParts * done), kParts, "what absorption makes of the cloth");
        });
        of = own.at(k);
      }
      const ColouredThread coloured = colours->thread_of(*colour);
      ThreadFile made = thread;
      made.name += ", coloured as " + system;
      made.parameters = coloured.parameters;
      made.fit = json::object();  // it was never photographed
      files.at(k) = system + "_thread.json";
      write_json_file(wanted.out / files.at(k), to_json(made));
      made_of[system] = {{"srgb", *colour}, {"delta_e_2000", coloured.delta_e_2000}};
    } else if (wanted.with_threads) {
      files.at(k) = system + "_thread.json";
      write_json_file(wanted.out / files.at(k), read_json_file(own.at(k)));
    } else {
      files.at(k) = fs::absolute(own.at(k)).lexically_relative(fs::absolute(wanted.out)).generic_string();
    }
  }
  if (colours) progress.finish("colours found");
  return files;
}

std::array<ThreadIrregularity, 2> irregularities_of(const Systems& own) {
  std::array<ThreadIrregularity, 2> found;
  for (std::size_t k = 0; k < own.size(); ++k) {
    if (is_bundle_file(own.at(k)))
      throw std::runtime_error("uneven yarns are for threads, and " + own.at(k).string() +
                               " is a bundle; leave --uneven out, or take its thread");
    found.at(k) = irregularity_of(read_thread(own.at(k)), own.at(k));
  }
  return found;
}

// Writes each system's thread in its shades; returns their files.
std::vector<std::string> write_shades(const fs::path& folder, const std::array<std::string, 2>& threads,
                                      const std::array<ThreadIrregularity, 2>& uneven) {
  std::vector<std::string> files;
  for (std::size_t k = 0; k < threads.size(); ++k)
    for (const ThreadFile& shade : shades_of(read_thread(folder / threads.at(k)), uneven.at(k).shade)) {
      files.push_back(std::string(kSystems.at(k)) + "_shade_" + std::to_string(files.size() % kThreadShades + 1) +
                      ".json");
      write_json_file(folder / files.back(), to_json(shade));
    }
  return files;
}

// Each system of the draft as thick as its thread.
renderer::Draft draft_of_threads(const fs::path& file, double warp_mm, double weft_mm) {
  renderer::Draft draft = draft_of_one_thread(read_draft(file), warp_mm);
  draft.warp.threads = {kWarp}, draft.weft.threads = {kWeft};
  if (warp_mm == weft_mm) return draft;
  const double scale = weft_mm / draft.weft.diameter_mm;
  draft.weft.diameter_mm *= scale;
  draft.weft.pitch_mm *= scale;
  return draft;
}

// Each calibration of a camera has a matrix of its own, which differs by little.
void require_one_camera(const Systems& own, const ClothThread& warp, const ClothThread& weft) {
  constexpr double kSame = 0.1;
  for (std::size_t i = 0; i < warp.linear_srgb_from_camera.size(); ++i)
    if (std::abs(warp.linear_srgb_from_camera.at(i) - weft.linear_srgb_from_camera.at(i)) > kSame)
      throw std::runtime_error("the colours of " + own[0].string() + " and " + own[1].string() +
                               " are those of two cameras, and one cloth is rendered in one camera's colours; take "
                               "threads that were digitized with the same camera");
}

}  // namespace

WovenThreads weave_threads(const ThreadsToWeave& wanted, ProgressStyle progress_style) {
  const Systems own{wanted.thread, wanted.weft_thread.empty() ? wanted.thread : wanted.weft_thread};
  const ClothThread thread = read_cloth_thread(own[kWarp]), weft = read_cloth_thread(own[kWeft]);
  require_one_camera(own, thread, weft);
  const fs::path& folder = wanted.out;
  std::error_code code;
  fs::create_directories(folder, code);
  if (code)
    throw std::runtime_error("cannot make " + folder.string() + ": " + code.message() +
                             "; is the folder that it is in writable?");
  renderer::Draft draft = draft_of_threads(wanted.draft, thread.diameter_mm, weft.diameter_mm);
  std::array<ThreadIrregularity, 2> irregularities;
  if (wanted.uneven) {
    irregularities = irregularities_of(own);
    draft = uneven_draft(draft, irregularities[kWarp], irregularities[kWeft]);
  }
  ProgressDisplay progress("cloth", progress_style);
  const renderer::YarnPatch patch = weave_watched(draft, progress).patch;
  write_json_file(folder / "draft.json", to_json(draft));
  write_json_file(folder / "patch.json", to_json(patch));
  WovenThreads woven{.linear_srgb_from_camera = thread.linear_srgb_from_camera, .fibers = wanted.fibers};
  woven.made_of = {{"draft", draft.name}, {"warp", nullptr}, {"weft", nullptr}};
  woven.made_of["model"] = is_bundle_file(own[kWarp]) ? "bundle" : "thread";
  if (!wanted.fibers.empty()) woven.made_of["fibers"] = wanted.fibers;
  woven.made_of["threads"] = {read_json_file(own[kWarp]).value("name", ""),
                              read_json_file(own[kWeft]).value("name", "")};
  const std::array<std::string, 2> files = write_threads(wanted, own, patch, progress_style, woven.made_of);
  woven.files = {files.begin(), files.end()};
  if (wanted.uneven) {
    woven.files = write_shades(folder, files, irregularities);
    for (std::size_t k = 0; k < kSystems.size(); ++k)
      woven.made_of["uneven"][kSystems.at(k)] = {{"shade", irregularities.at(k).shade},
                                                 {"diameter", irregularities.at(k).diameter},
                                                 {"length_mm", irregularities.at(k).length_mm}};
  }
  ThreadColours colours = colours_of_threads({own[kWarp], own[kWeft]});
  for (const auto& [colour, system] : {std::pair{wanted.warp_colour, kWarp}, {wanted.weft_colour, kWeft}})
    if (colour) colours[system] = {(*colour)[0], (*colour)[1], (*colour)[2]};
  write_text_file(folder / "drawing.svg", draw_draft_svg(draft, colours));
  return woven;
}

}  // namespace station
