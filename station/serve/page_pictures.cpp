#include "station/serve/page_pictures.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <map>
#include <opencv2/imgproc.hpp>

#include "renderer/picture/image_file.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/draft_drawing.h"
#include "station/documents/draft_file.h"
#include "station/documents/scene_file.h"
#include "station/documents/thread_file.h"
#include "station/documents/views_file.h"
#include "station/output/display.h"
#include "station/serve/job_command.h"
#include "station/serve/page_answers.h"
#include "station/session/record/picture_record.h"
#include "station/session/results.h"
#include "station/session/shown_cloth.h"
#include "station/thread/invert/invert_session.h"
#include "station/thread/report/fitted_twins.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kTile_px = 320;

struct Asked {
  const HttpRequest& request;
  const Workspace& workspace;

  std::string word(const char* key) const {
    const auto found = request.query.find(key);
    return found == request.query.end() ? std::string() : found->second;
  }
  std::string name(const char* key) const { return checked_name(word(key)); }
  // How much brighter than with a white card at the screen's white.
  int stops() const {
    constexpr int kMost = 8;
    const std::string asked = word("stops");
    int found = 0;
    const auto [end, error] = std::from_chars(asked.data(), asked.data() + asked.size(), found);
    if (!asked.empty() && (error != std::errc() || end != asked.data() + asked.size() || std::abs(found) > kMost))
      throw Refused(400, "stops are a whole number from -8 to 8");
    return found;
  }
};

HttpResponse png(const cv::Mat3b& rgb) {
  return {.content_type = "image/png", .body = renderer::encode_png(rgb)};
}

HttpResponse png_file(const fs::path& file) {
  if (!fs::is_regular_file(file)) throw Refused(404, "there is no " + file.filename().string() + " yet");
  return {.content_type = "image/png", .body = text_of_file(file)};
}

// At most so wide: what a screen shows.
cv::Mat3b narrowed(const cv::Mat3b& picture, int width_px) {
  if (picture.cols <= width_px) return picture;
  cv::Mat3b small;
  cv::resize(picture, small, {width_px, std::max(1, picture.rows * width_px / picture.cols)}, 0, 0, cv::INTER_AREA);
  return small;
}

// A tile of the contact sheet, or with "size=large" as large as a screen shows.
HttpResponse raw(const Asked& asked) {
  constexpr int kLarge_px = 2400;
  const fs::path session = asked.workspace.existing_session(asked.word("session"));
  const auto file = picture_of_step(session, asked.name("step"));
  if (!file) throw Refused(404, "there is no picture of " + asked.word("step") + " yet");
  return png(narrowed(shown_sensor_file(*file), asked.word("size") == "large" ? kLarge_px : kTile_px));
}

HttpResponse twin(const Asked& asked, const std::string& which) {
  constexpr int kShown_px = 1200;
  const fs::path session = asked.workspace.existing_session(asked.word("session"));
  if (!fs::exists(thread_file_of(session))) throw Refused(404, "the session has no fitted thread yet");
  DevelopedViews developed = read_views(session);
  std::erase_if(developed.views, [&](const DevelopedView& one) { return one.view.id != asked.word("view"); });
  if (developed.views.empty()) throw Refused(404, "there is no view " + asked.word("view").substr(0, 100));
  read_view_pictures(session, developed);
  const inversion::View& view = developed.views.front().view;
  const FittedTwins twins = read_twins(session, view, "thread", asked.stops());
  const int block_px = read_thread(thread_file_of(session)).fit.value("block_px", 1);
  const cv::Mat3f picture = which == "photographed" ? twins.photographed
                            : which == "fitted"     ? twins.fitted
                                                    : residual_picture(view, twins, block_px);
  return png(
      narrowed(display(picture, twins.exposure, developed.linear_srgb_from_camera)(twins.box).clone(), kShown_px));
}

// As it was written, or brighter or darker.
HttpResponse cloth_of(const fs::path& folder, const Asked& asked) {
  const fs::path picture = folder / (asked.name("view") + ".png");
  if (asked.stops() == 0) return png_file(picture);
  const fs::path linear = fs::path(picture).replace_extension(".exr"),
                 scene = fs::path(picture).replace_extension(".json");
  if (!fs::is_regular_file(linear)) throw Refused(404, "there is no " + picture.filename().string() + " yet");
  return png(shown_cloth(linear, asked.stops(), read_scene(scene).linear_srgb_from_camera));
}

HttpResponse cloth(const Asked& asked) {
  return cloth_of(cloth_folder(asked.workspace.existing_session(asked.word("session"))), asked);
}

HttpResponse design(const Asked& asked) {
  return cloth_of(asked.workspace.design(asked.name("name")), asked);
}

// How a thread of the library looks: the cloth of its session, or else its spool in the first view; cloth of its own
// where it came without a session.
HttpResponse thread(const Asked& asked) {
  const json lines = asked.workspace.thread_lines();
  const auto line = std::ranges::find_if(
      lines, [&](const json& one) { return std::to_string(one.at("number").get<int>()) == asked.word("number"); });
  if (line == lines.end()) throw Refused(404, "there is no such thread in the library");
  if (const fs::path own = asked.workspace.thread_picture(line->at("sha256")); fs::is_regular_file(own))
    return png_file(own);
  const std::string& name = line->at("session").get_ref<const std::string&>();
  if (name.empty()) throw Refused(404, "there is no picture of this thread yet");
  const fs::path session = asked.workspace.existing_session(name);
  if (const fs::path swatch = cloth_folder(session) / "swatch.png"; fs::is_regular_file(swatch))
    return png_file(swatch);
  for (const auto& [step, picture] : taken_pictures(read_journal(session / "journal.jsonl").records))
    if (const auto file = step.starts_with("reflection") ? picture_of_step(session, step) : std::nullopt)
      return png(narrowed(shown_sensor_file(*file), kTile_px));
  throw Refused(404, "there is no picture of this thread");
}

HttpResponse draft(const Asked& asked) {
  return {.content_type = "image/svg+xml", .body = draw_draft_svg(read_draft(ready_draft(asked.word("name"))))};
}

}  // namespace

HttpResponse page_picture(const HttpRequest& request, const Workspace& workspace, const LastFrame& frame) {
  static const std::map<std::string, std::function<HttpResponse(const Asked&)>> kinds{
      {"raw", raw},
      {"photographed", [](const Asked& asked) { return twin(asked, "photographed"); }},
      {"fitted", [](const Asked& asked) { return twin(asked, "fitted"); }},
      {"residual", [](const Asked& asked) { return twin(asked, "residual"); }},
      {"cloth", cloth},
      {"design", design},
      {"thread", thread},
      {"draft", draft}};
  const Asked asked{request, workspace};
  if (asked.word("of") == "frame") return png(frame.picture());
  const auto found = kinds.find(asked.word("of"));
  if (found == kinds.end()) throw Refused(404, "there is no such picture");
  return found->second(asked);
}

}  // namespace station
