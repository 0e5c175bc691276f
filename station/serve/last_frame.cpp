#include "station/serve/last_frame.h"

#include <algorithm>
#include <array>
#include <list>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calibration/develop/linear_grey.h"
#include "calibration/geometry/tags.h"
#include "calibration/sensor/sensor_file.h"
#include "renderer/picture/jpeg.h"
#include "renderer/picture/picture_bytes.h"
#include "station/bench/camera_adapter.h"
#include "station/bench/exposure.h"
#include "station/bench/picture_measures.h"
#include "station/documents/disk/file_name.h"
#include "station/output/display.h"
#include "station/serve/page_answers.h"
#include "station/session/record/picture_record.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kBins = 64;
constexpr int kWidest_px = 3000;  // that tags are looked for in; larger pictures are reduced

fs::file_time_type time_of(const fs::path& file) {
  std::error_code error;
  const auto time = fs::last_write_time(file, error);
  return error ? fs::file_time_type::min() : time;
}

std::optional<fs::path> newest_raw_file(const fs::path& folder) {
  std::optional<fs::path> newest;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (is_raw_file(entry.path()) && (!newest || time_of(*newest) < time_of(entry.path()))) newest = entry.path();
  return newest;
}

// Each 2 x 2 cell as one colour: 0 black, 1 white.
cv::Mat3f cells_of(const calibration::SensorPicture& picture) {
  cv::Mat3f cells(picture.mosaic.rows / 2, picture.mosaic.cols / 2);
  const double range_dn = picture.white_level_dn - picture.black_level_dn;
  for (int row = 0; row < cells.rows; ++row)
    for (int column = 0; column < cells.cols; ++column) {
      cv::Vec3f sum(0, 0, 0), count(0, 0, 0);
      for (int i = 0; i < 4; ++i) {
        const int channel = picture.channel.at(static_cast<std::size_t>(i));
        sum[channel] += picture.mosaic(2 * row + i / 2, 2 * column + i % 2);
        count[channel] += 1;
      }
      for (int c = 0; c < 3; ++c)
        cells(row, column)[c] = static_cast<float>((sum[c] / count[c] - picture.black_level_dn) / range_dn);
    }
  return cells;
}

json histogram_of(const cv::Mat3f& levels) {
  std::array<std::array<double, kBins>, 3> bins{};
  for (const cv::Vec3f& pixel : levels)
    for (int c = 0; c < 3; ++c) {
      const int bin = std::clamp(static_cast<int>(static_cast<float>(kBins) * pixel[c]), 0, kBins - 1);
      bins[static_cast<std::size_t>(c)][static_cast<std::size_t>(bin)] += 1.0 / static_cast<double>(levels.total());
    }
  return {{"r", bins[0]}, {"g", bins[1]}, {"b", bins[2]}};
}

void add_tags(json& document, cv::Mat1f grey, const RigFile& rig) {
  double scale = 1;
  if (grey.cols > kWidest_px) {
    scale = 2;
    cv::resize(grey, grey, {}, 1 / scale, 1 / scale, cv::INTER_AREA);
  }
  const calibration::TagObservation seen = calibration::detect_tags(grey);
  if (const auto blur_px = edge_blur_px(grey, seen))
    document["focus"] = {{"blur_px", scale * *blur_px}, {"doubtful_px", kDoubtfulBlur_px}, {"bad_px", kBadBlur_px}};
  document["tags"] = json::array();
  for (const auto& [where, layout] : {std::pair("platform", &rig.platform_ring),
                                      {"table", &rig.table_tags},
                                      {"holder", &rig.holder_tags},
                                      {"board", &rig.board}}) {
    document["tags"].push_back(
        {{"where", where}, {"seen", calibration::tags_seen(*layout, seen)}, {"printed", layout->tags.size()}});
  }
}

json lamp_of(const fs::path& session) {
  std::vector<json> lamp;
  if (session.empty()) return lamp;
  for (const auto& [step, picture] : taken_pictures(read_journal(session / "journal.jsonl").records))
    if (const Finding* finding = picture.verdict.find("lamp"); finding != nullptr && finding->value)
      lamp.push_back({{"step", step}, {"utc", picture.utc}, {"percent", *finding->value}});
  std::ranges::sort(lamp, {}, [](const json& one) { return one.at("utc").get<std::string>(); });
  return lamp;
}

cv::Mat3b decoded(const fs::path& jpeg) {
  try {
    return renderer::decode_jpeg(renderer::bytes_of_picture(jpeg), renderer::JpegDamage::shown);
  } catch (const std::runtime_error&) {
    throw Refused(404, "the live view's last frame cannot be read");
  }
}

}  // namespace

std::optional<fs::path> picture_of_step(const fs::path& session, const std::string& step) {
  const auto taken = taken_pictures(read_journal(session / "journal.jsonl").records);
  const auto picture = taken.find(step);
  if (picture == taken.end()) return std::nullopt;
  const fs::path file(picture->second.file);
  if (file.parent_path() != "raw" || problem_with_name(file.filename().string())) return std::nullopt;
  return session / file;
}

cv::Mat3b shown_sensor_file(const fs::path& file) {
  constexpr std::size_t kRemembered = 64;
  constexpr int kWidest = 1200;
  constexpr double kMostBrightened = 16;  // a dark picture is to look dark
  struct Shown {
    fs::path file;
    fs::file_time_type time;
    cv::Mat3b picture;
  };
  static std::mutex mutex;
  static std::list<Shown> shown;
  const fs::file_time_type time = time_of(file);
  {
    const std::scoped_lock lock(mutex);
    for (const Shown& one : shown)
      if (one.file == file && one.time == time) return one.picture;
  }
  const cv::Mat3f cells = cells_of(calibration::read_sensor_file(file));
  cv::Mat3b picture = display(cells, std::min(display_scale(cells), kMostBrightened), {1, 0, 0, 0, 1, 0, 0, 0, 1});
  if (picture.cols > kWidest)
    cv::resize(picture, picture, {kWidest, picture.rows * kWidest / picture.cols}, 0, 0, cv::INTER_AREA);
  const std::scoped_lock lock(mutex);
  shown.push_front({file, time, picture});
  if (shown.size() > kRemembered) shown.pop_back();
  return picture;
}

std::string LastFrame::Found::id() const {
  return file.filename().string() + "-" + std::to_string(time_of(file).time_since_epoch().count());
}

std::optional<LastFrame::Found> LastFrame::newest() const {
  std::vector<Found> all;
  std::optional<fs::path> session;
  for (const std::string& name : folders_in(workspace_.folder() / "sessions")) {
    const fs::path folder = workspace_.session(name);
    if (!session || time_of(*session / "journal.jsonl") < time_of(folder / "journal.jsonl")) session = folder;
  }
  if (session)
    if (const auto file = newest_raw_file(*session / "raw"))
      all.push_back({*file, *session, session->filename().string() + ": " + file->stem().string()});
  for (const std::string& name : folders_in(workspace_.folder() / "calibrations"))
    if (const auto file = newest_raw_file(workspace_.calibration(name) / "pictures"))
      all.push_back({*file, {}, name + ": " + file->stem().string()});
  if (fs::exists(workspace_.preview())) all.push_back({workspace_.preview(), {}, "", false});
  const auto newest = std::ranges::max_element(all, {}, [](const Found& one) { return time_of(one.file); });
  return newest == all.end() ? std::nullopt : std::optional(*newest);
}

json LastFrame::measured(const Found& frame) const {
  json document{{"source", frame.source}, {"kind", frame.raw ? "raw" : "preview"}, {"id", frame.id()}};
  if (!frame.raw) {
    const cv::Mat3b rgb = decoded(frame.file);
    cv::Mat3f levels;
    rgb.convertTo(levels, CV_32F, 1.0 / 255);
    cv::Mat1f grey;
    cv::cvtColor(levels, grey, cv::COLOR_RGB2GRAY);
    document["width_px"] = rgb.cols, document["height_px"] = rgb.rows;
    document["histogram"] = histogram_of(levels);
    add_tags(document, grey, rig_);
    return document;
  }
  const calibration::SensorPicture picture = calibration::read_sensor_file(frame.file);
  const cv::Mat1b everywhere(picture.mosaic.size(), 255);
  document["width_px"] = picture.mosaic.cols, document["height_px"] = picture.mosaic.rows;
  document["histogram"] = histogram_of(cells_of(picture));
  document["exposure"] = {{"exposure_s", picture.exposure_s},
                          {"level", bright_level(picture, {}, ExposureAim{}.percentile)},
                          {"aim", rig_.target_level},
                          {"saturated", saturated_fraction(picture, everywhere)}};
  document["lamp"] = lamp_of(frame.session);
  add_tags(document, calibration::linear_grey(picture), rig_);
  return document;
}

json LastFrame::document() {
  const std::scoped_lock lock(mutex_);
  const auto frame = newest();
  if (!frame) return nullptr;
  if (const std::string id = frame->id(); id != known_id_) {
    known_ = measured(*frame);
    known_id_ = id;
  }
  return known_;
}

cv::Mat3b LastFrame::picture() const {
  const auto frame = newest();
  if (!frame) throw Refused(404, "the camera has made no picture yet");
  return frame->raw ? shown_sensor_file(frame->file) : decoded(frame->file);
}

}  // namespace station
