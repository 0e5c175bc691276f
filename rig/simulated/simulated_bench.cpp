#include "rig/simulated/simulated_bench.h"

#include <cmath>
#include <utility>

#include "rig/simulated/noise.h"

namespace rig {
namespace {

// A number that stands for an object and its place, as a seed for the hand's error. Poses are rounded to millionths, so
// that a pose that went through a file gives the same number.
std::uint64_t placement_key(const Arrangement& arrangement) {
  std::uint64_t key = mixed(static_cast<std::uint64_t>(arrangement.object) + 1);
  const auto take = [&key](std::uint64_t value) { key = mixed(key ^ mixed(value + 1)); };
  take(arrangement.object == BenchObject::holder ? static_cast<std::uint64_t>(arrangement.mounting) : 0);
  take(arrangement.on_platform ? 1 : 0);
  if (arrangement.stand > 0) take(static_cast<std::uint64_t>(arrangement.stand));
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      take(static_cast<std::uint64_t>(std::llround(arrangement.pose(row, column) * 1e6)));
  return key;
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
  void correct(const std::string& /*what*/) override { bench_.place_anew(); }

 private:
  SimulatedBench& bench_;
};

}  // namespace

SimulatedBench::SimulatedBench(BenchTruth truth, DrawPicture draw) : truth_(std::move(truth)), draw_(std::move(draw)) {}

BenchState SimulatedBench::state() const {
  BenchState now{.lens = truth_.lens,
                 .arrangement = arrangement_,
                 .world_from_object = placed_pose_,
                 .platform_angle_rad = platform_angle_rad_,
                 .lamp = std::nullopt};
  if (arrangement_.on_platform)
    now.world_from_object = Eigen::AngleAxisd(platform_angle_rad_, Eigen::Vector3d::UnitZ()) * placed_pose_;
  if (arrangement_.lamp != Lamp::off) {
    now.lamp = arrangement_.lamp == Lamp::front        ? truth_.front
               : arrangement_.lamp == Lamp::front_left ? truth_.front_left
                                                       : truth_.back;
  }
  now.room_radiance = (arrangement_.room_light ? 1.0 : truth_.room_leak) * truth_.room_radiance;
  return now;
}

cv::Mat3f SimulatedBench::draw_roughly() const {
  BenchState now = state();
  now.roughly = true;
  return draw_(now);
}

cv::Mat3f SimulatedBench::draw_lamp() const {
  BenchState now = state();
  now.room_radiance.setZero();
  return now.lamp ? draw_(now) : cv::Mat3f();
}

cv::Mat3f SimulatedBench::draw_without_lamp() const {
  BenchState now = state();
  if (now.lamp && now.room_radiance.maxCoeff() <= 0) return {};
  now.lamp.reset();
  return draw_(now);
}

// The hand's error is an offset in the parent's frame and a small turn about the object's own origin. An object that
// stands or lies on the platform is supported by it and errs only in its place and direction there.
void SimulatedBench::place(const Arrangement& arrangement) {
  attempt_ = 0;
  put(arrangement);
}

void SimulatedBench::place_anew() {
  ++attempt_;
  put(arrangement_);
}

void SimulatedBench::put(const Arrangement& arrangement) {
  arrangement_ = arrangement;
  placed_pose_ = arrangement.pose;
  if (arrangement.object == BenchObject::nothing) return;
  NoiseStream hand(truth_.seed + attempt_, placement_key(arrangement));
  if (arrangement.stand > 0) {
    const auto within = [&hand](double most) { return most * (2 * hand.uniform() - 1); };
    const double forward_mm = within(truth_.stand_placement_mm), right_mm = within(truth_.stand_placement_mm);
    placed_pose_ = Eigen::Translation3d(forward_mm, right_mm, 0) *
                   Eigen::AngleAxisd(within(truth_.stand_placement_rad), Eigen::Vector3d::UnitZ()) * arrangement.pose;
    return;
  }
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
  if (turn.norm() > 0) placed_pose_.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
}

bool same_state(const BenchState& a, const BenchState& b) {
  return same_arrangement(a.arrangement, b.arrangement) &&
         a.world_from_object.matrix() == b.world_from_object.matrix() && a.platform_angle_rad == b.platform_angle_rad &&
         same_lamp(a.lamp, b.lamp) && a.room_radiance == b.room_radiance;
}

std::unique_ptr<Operator> make_simulated_operator(SimulatedBench& bench) {
  return std::make_unique<SimulatedOperator>(bench);
}

}  // namespace rig
