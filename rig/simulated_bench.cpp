#include "rig/simulated_bench.h"

#include <cmath>
#include <utility>

#include "rig/noise.h"

namespace rig {
namespace {

// One number for many.
class Key {
 public:
  explicit Key(std::uint64_t first) : bits_(mixed(first + 1)) {}
  Key& take(std::uint64_t value) {
    bits_ = mixed(bits_ ^ mixed(value + 1));
    return *this;
  }
  // Millionths, so that a number that went through a file or over a wire is the same number.
  Key& take_rounded(double value) { return take(static_cast<std::uint64_t>(std::llround(value * 1e6))); }
  std::uint64_t bits() const { return bits_; }

 private:
  std::uint64_t bits_;
};

// What a hand placed where.
std::uint64_t placement_key(const Arrangement& arrangement) {
  Key key(static_cast<std::uint64_t>(arrangement.object));
  key.take(arrangement.object == BenchObject::holder ? static_cast<std::uint64_t>(arrangement.mounting) : 0);
  key.take(arrangement.on_platform ? 1 : 0);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      key.take_rounded(arrangement.pose(row, column));
    }
  }
  return key.bits();
}

bool same_lamp(const std::optional<TrueLamp>& a, const std::optional<TrueLamp>& b) {
  return a.has_value() == b.has_value() &&
         (!a || (a->position == b->position && a->intensity == b->intensity && a->radius_mm == b->radius_mm &&
                 a->aim == b->aim && a->beam_exponent == b->beam_exponent));
}

class SimulatedOperator final : public Operator {
 public:
  explicit SimulatedOperator(SimulatedBench& bench) : bench_(bench) {}
  void arrange(const Arrangement& wanted) override { bench_.place(wanted); }

 private:
  SimulatedBench& bench_;
};

}  // namespace

SimulatedBench::SimulatedBench(BenchTruth truth, DrawPicture draw)
    : truth_(std::move(truth)), draw_(std::move(draw)) {}

BenchState SimulatedBench::state() const {
  BenchState now{.lens = truth_.lens,
                 .arrangement = arrangement_,
                 .world_from_object = placed_pose_,
                 .platform_angle_rad = platform_angle_rad_,
                 .lamp = std::nullopt};
  if (arrangement_.on_platform) {
    now.world_from_object = Eigen::AngleAxisd(platform_angle_rad_, Eigen::Vector3d::UnitZ()) * placed_pose_;
  }
  if (arrangement_.lamp != Lamp::off) {
    now.lamp = arrangement_.lamp == Lamp::front ? truth_.front : truth_.back;
  }
  now.room_radiance = (arrangement_.room_light ? 1.0 : truth_.room_leak) * truth_.room_radiance;
  return now;
}

cv::Mat3f SimulatedBench::draw_lamp() const {
  BenchState now = state();
  now.room_radiance.setZero();
  return now.lamp ? draw_(now) : cv::Mat3f();
}

cv::Mat3f SimulatedBench::draw_without_lamp() const {
  BenchState now = state();
  if (now.lamp && now.room_radiance.maxCoeff() <= 0) {
    return {};
  }
  now.lamp.reset();
  return draw_(now);
}

// The hand's error: an offset in the parent's frame and a small turn about the object's own origin. What stands or
// lies on the platform is held by it, so only its place and direction on the platform are uncertain.
void SimulatedBench::place(const Arrangement& arrangement) {
  arrangement_ = arrangement;
  placed_pose_ = arrangement.pose;
  if (arrangement.object == BenchObject::nothing) {
    return;
  }
  NoiseStream hand(truth_.seed, placement_key(arrangement));
  const auto [x, y] = hand.normals();
  const auto [z, turn_x] = hand.normals();
  const auto [turn_y, turn_z] = hand.normals();
  if (arrangement.on_platform) {
    placed_pose_.translation() += truth_.placement_mm * Eigen::Vector3d(x, y, 0);
    placed_pose_.linear() =
        Eigen::AngleAxisd(truth_.placement_rad * turn_z, Eigen::Vector3d::UnitZ()) * placed_pose_.linear();
    return;
  }
  placed_pose_.translation() += truth_.placement_mm * Eigen::Vector3d(x, y, z);
  const Eigen::Vector3d turn = truth_.placement_rad * Eigen::Vector3d(turn_x, turn_y, turn_z);
  if (turn.norm() > 0) {
    placed_pose_.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  }
}

void SimulatedBench::begin_occasion(const std::string& name) {
  Key key(0);
  for (const char letter : name) {
    key.take(static_cast<unsigned char>(letter));
  }
  const std::lock_guard hold(counting_);
  occasion_ = key.bits();
  photographed_.clear();
}

std::uint64_t SimulatedBench::noise_of_next_picture(const ExposureSettings& settings) {
  const std::lock_guard hold(counting_);
  Key key(occasion_);
  key.take(placement_key(arrangement_)).take_rounded(platform_angle_rad_);
  key.take(static_cast<std::uint64_t>(arrangement_.lamp)).take(arrangement_.room_light ? 1 : 0);
  key.take_rounded(settings.exposure_s)
      .take(static_cast<std::uint64_t>(settings.iso))
      .take_rounded(settings.f_number);
  return key.take(photographed_[key.bits()]++).bits();
}

std::uint64_t key_of(const BenchState& state) {
  Key key(placement_key(state.arrangement));
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      key.take_rounded(state.world_from_object(row, column));
    }
  }
  key.take_rounded(state.platform_angle_rad).take(state.lamp ? 1 : 0);
  for (int i = 0; i < 3; ++i) {
    if (state.lamp) {
      key.take_rounded(state.lamp->position[i]).take_rounded(state.lamp->aim[i]);
    }
    key.take_rounded(state.room_radiance[i]);
  }
  return key.bits();
}

bool same_state(const BenchState& a, const BenchState& b) {
  return same_arrangement(a.arrangement, b.arrangement) &&
         a.world_from_object.matrix() == b.world_from_object.matrix() &&
         a.platform_angle_rad == b.platform_angle_rad && same_lamp(a.lamp, b.lamp) &&
         a.room_radiance == b.room_radiance;
}

std::unique_ptr<Operator> make_simulated_operator(SimulatedBench& bench) {
  return std::make_unique<SimulatedOperator>(bench);
}

}  // namespace rig
