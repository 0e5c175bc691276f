#include "station/bench/calibrate/placing_watch.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "calibration/geometry/pose.h"
#include "calibration/geometry/target_stand.h"
#include "renderer/picture/jpeg.h"
#include "station/bench/calibrate/lamps.h"
#include "station/bench/calibrate/standing_target.h"
#include "station/bench/picture_measures.h"
#include "station/documents/degree.h"
#include "station/documents/disk/file_system.h"
#include "station/documents/disk/stored_file.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

using Eigen::Isometry3d, Eigen::Vector3d;

constexpr double kStill_s = 1;
constexpr double kHandsOut_s = 3;              // more, before anything turns
constexpr int kSmall_px = 150;                 // width of the frame in which hands are looked for
constexpr double kMovedLight = 0.06;           // of white, beyond what the whole frame changed
constexpr double kMovedPart = 0.004;           // of that frame
constexpr double kStillPart = 0.002;           // of the picture's width, that corners may move between two frames
constexpr double kLeastStill_px = 0.7;         // live view is coarse
constexpr double kFewestTags = 0.5;            // of the target's
constexpr double kMostLean_rad = 9 * kDegree;  // of the plate against what is wanted; stands differ by 20 degrees
constexpr double kMostOff_mm = 45, kMostTurn_rad = 25 * kDegree;
const cv::Scalar kWanted(255, 200, 0), kRight(80, 220, 80);  // RGB

std::vector<cv::Point> outline_in(const RigFile& rig, const rig::Arrangement& wanted, double angle_rad,
                                  cv::Size frame) {
  const calibration::Lens lens = engraved_lens(rig, frame);
  const Isometry3d camera_from_target =
      rig.world_from_camera_by_tape.inverse() * calibration::turned(angle_rad, wanted.pose);
  std::vector<cv::Point> outline;
  for (const Vector3d& corner : target_outline(rig, wanted.object)) {
    const Vector3d seen = camera_from_target * corner;
    if (seen.z() <= 0) return {};
    outline.emplace_back(cvRound(lens.fx_px * seen.x() / seen.z() + lens.cx_px),
                         cvRound(lens.fy_px * seen.y() / seen.z() + lens.cy_px));
  }
  return outline;
}

cv::Mat3b frame_of(const std::vector<std::byte>& jpeg) {
  try {
    return renderer::decode_jpeg({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()},
                                 renderer::JpegDamage::shown);
  } catch (const std::runtime_error&) {
    throw std::runtime_error("the camera's live view sent a frame that is no JPEG; switch it off and on");
  }
}

cv::Mat1f in_small(const cv::Mat1f& grey) {
  cv::Mat1f small;
  cv::resize(grey, small, {kSmall_px, std::max(1, kSmall_px * grey.rows / grey.cols)}, 0, 0, cv::INTER_AREA);
  return small;
}

// Whether something moved between two small frames; that all of it became brighter or darker does not count.
bool something_moved(const cv::Mat1f& before, const cv::Mat1f& after) {
  if (before.size() != after.size()) return true;
  cv::Mat1f change;
  cv::subtract(after, before, change);
  const int moved = cv::countNonZero(cv::abs(change - cv::mean(change)[0]) > kMovedLight);
  return moved > kMovedPart * static_cast<double>(change.total());
}

}  // namespace

PlacingWatch::PlacingWatch(const RigFile& rig, rig::Camera& camera, std::filesystem::path live, Clock now,
                           const LensCoverage* covered)
    : rig_(rig), camera_(camera), live_(std::move(live)), now_(std::move(now)), covered_(covered) {}

void PlacingWatch::begin(const std::optional<rig::Arrangement>& before, const rig::Arrangement& wanted,
                         double angle_rad) {
  wanted_.reset();
  still_since_s_.reset();
  before_.clear();
  small_before_.release();
  if (wanted.stand == 0) return;
  wanted_ = wanted;
  angle_rad_ = angle_rad;
  only_the_target_ =
      wanted.room_light && before && before->lamp == wanted.lamp && before->room_light == wanted.room_light;
}

// What keeps the target from standing as wanted; empty: nothing.
std::string PlacingWatch::fault(const calibration::TagObservation& seen, const cv::Mat1f& grey) const {
  const std::string name = rig::object_name(wanted_->object);
  const calibration::TagLayout& tags = target_tags(rig_, wanted_->object);
  const auto fit = calibration::fit_pose(engraved_lens(rig_, grey.size()), tags, seen);
  if (!fit ||
      static_cast<double>(calibration::tags_seen(tags, seen)) < kFewestTags * static_cast<double>(tags.tags.size()))
    return "Not enough of " + name + " is seen: the outline shows where it is wanted.";
  const Isometry3d world_from_target = rig_.world_from_camera_by_tape * fit->camera_from_object;
  const Isometry3d upright = calibration::turned(turn_between(world_from_target, wanted_->pose), wanted_->pose);
  if (Eigen::AngleAxisd(world_from_target.linear() * upright.linear().transpose()).angle() > kMostLean_rad)
    return "It does not lean as on stand " + std::to_string(wanted_->stand) +
           (wanted_->on_its_side ? ", on its side." : ", upright.");
  const auto standing = find_target(rig_, *wanted_, seen, grey.size(), angle_rad_);
  const Vector3d off = standing->translation() - wanted_->pose.translation();
  if (off.head<2>().norm() > kMostOff_mm || std::abs(turn_between(*standing, wanted_->pose)) > kMostTurn_rad)
    return "It stands " + how_far_off(*wanted_, *standing) + ".";
  const auto blur_px = edge_blur_px(grey, seen);
  if (blur_px && *blur_px > kDoubtfulBlur_px) return "It is not sharp: look at the focus.";
  return "";
}

PlacingWatch::Look PlacingWatch::look() {
  const std::vector<std::byte> jpeg = camera_.preview();
  cv::Mat3b frame = frame_of(jpeg);
  cv::Mat1f grey;
  cv::Mat1b bytes;
  cv::cvtColor(frame, bytes, cv::COLOR_RGB2GRAY);
  bytes.convertTo(grey, CV_32F, 1.0 / 255);
  const calibration::TagObservation seen = calibration::detect_tags(grey);
  Look found{.remark = fault(seen, grey)};
  const auto moved = motion_px(before_, seen);
  before_ = seen;
  cv::Mat1f small = in_small(grey);
  const bool hands = something_moved(small_before_, small);
  small_before_ = std::move(small);
  const double now_s = now_();
  if (!found.remark.empty() || !moved || *moved > std::max(kLeastStill_px, kStillPart * frame.cols) || hands)
    still_since_s_.reset();
  else if (!still_since_s_)
    still_since_s_ = now_s;
  const bool right = found.remark.empty();
  const double still_s = still_since_s_ ? now_s - *still_since_s_ : 0;
  found.stands = still_since_s_ && still_s >= kStill_s;
  found.hands_out = found.stands && still_s >= kStill_s + kHandsOut_s;
  if (right)
    found.remark = !only_the_target_
                       ? "It stands well. Say that it is done when the light is as asked for and nothing else comes in."
                   : found.hands_out ? "It stands well."
                   : found.stands
                       ? "It stands well. Hands out of the box: the platform turns in " +
                             std::to_string(static_cast<int>(std::ceil(kStill_s + kHandsOut_s - still_s))) + " s."
                       : "It stands well: let go of it.";
  if (covered_ && wanted_->object == rig::BenchObject::board) {
    covered_->shade_unseen(frame);
    if (const std::string so_far = covered_->sentence(); !so_far.empty()) found.remark += " " + so_far;
  }
  const std::vector<cv::Point> outline = outline_in(rig_, *wanted_, angle_rad_, frame.size());
  if (!outline.empty())
    cv::polylines(frame, outline, true, right ? kRight : kWanted, std::max(1, frame.cols / 300), cv::LINE_AA);
  const std::string shown = renderer::encode_jpeg(frame);
  FileSystem disk;
  store_file(disk, live_, std::as_bytes(std::span(shown)));
  return found;
}

std::optional<std::string> WatchedPerson::ask(const rig::Question& question) {
  if (!watch_) return person_.ask(question);
  rig::Question watched = question;
  // A wait with something to do is not ended by a signal, so ctrl-C is looked for in every question.
  watched.meanwhile = [this]() -> std::optional<std::string> {
    if (interrupted()) return rig::kDecline;
    if (!watch_->watches()) return std::nullopt;
    try {
      const PlacingWatch::Look seen = watch_->look();
      person_.remark(seen.remark);
      if (seen.hands_out && watch_->all_is_seen()) return rig::kDone;
    } catch (const std::runtime_error& problem) {  // without its help the person is asked all the same
      person_.remark(std::string("There is no live view: ") + problem.what());
      watch_->end();
    }
    return std::nullopt;
  };
  return person_.ask(watched);
}

namespace {

// Tells the watch what a person is asked to put down.
class WatchedOperator final : public rig::Operator {
 public:
  WatchedOperator(std::unique_ptr<rig::Operator> person, std::unique_ptr<PlacingWatch> watch, rig::Turntable& turntable,
                  WatchedPerson& asked)
      : person_(std::move(person)), watch_(std::move(watch)), turntable_(turntable), asked_(asked) {
    asked_.set_watch(watch_.get());
  }
  ~WatchedOperator() override { asked_.set_watch(nullptr); }
  WatchedOperator(const WatchedOperator&) = delete;
  WatchedOperator& operator=(const WatchedOperator&) = delete;

  void arrange(const rig::Arrangement& wanted) override {
    watch_->begin(standing_, wanted, turntable_.angle_rad());
    standing_.reset();
    person_->arrange(wanted);
    watch_->end();
    standing_ = wanted;
  }
  void correct(const std::string& what) override {
    if (standing_) watch_->begin(standing_, *standing_, turntable_.angle_rad());
    person_->correct(what);
    watch_->end();
  }

 private:
  std::unique_ptr<rig::Operator> person_;
  std::unique_ptr<PlacingWatch> watch_;
  rig::Turntable& turntable_;
  WatchedPerson& asked_;
  std::optional<rig::Arrangement> standing_;
};

}  // namespace

void watch_placing(const RigFile& rig, RigDevices& devices, const std::filesystem::path& live, WatchedPerson& asked,
                   const LensCoverage& covered) {
  const auto begin = std::chrono::steady_clock::now();
  const auto now_s = [begin] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  auto watch = std::make_unique<PlacingWatch>(rig, *devices.camera, live, now_s, &covered);
  devices.person =
      std::make_unique<WatchedOperator>(std::move(devices.person), std::move(watch), *devices.turntable, asked);
}

}  // namespace station
