#include "inversion/fit/block_estimate.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace inversion {
namespace {

using Eigen::Array3f;
using Path = std::span<const PathEvent>;

// How many places a scalar stands for, and functions that load it from and store it to floats in a row.
template <class S>
constexpr std::size_t kWidth = 1;
template <>
constexpr std::size_t kWidth<BlockPacket> = renderer::kPacketWidth;
template <class S>
S load(const float* from) {
  if constexpr (kWidth<S> == 1)
    return *from;
  else
    return S::load(from);
}
void store(float value, float* to) {
  *to = value;
}
void store(const BlockPacket& value, float* to) {
  value.store(to);
}
double sum_of_lanes(float value) {
  return static_cast<double>(value);
}
double sum_of_lanes(const BlockPacket& value) {
  double sum = 0;
  for (int lane = 0; lane < renderer::kPacketWidth; ++lane) sum += static_cast<double>(value[lane]);
  return sum;
}

template <class Model>
struct ScalarOf;
template <template <class> class Model, class S>
struct ScalarOf<Model<S>> {
  using type = S;
};

// Whole paths are shaded together until they have this many events: what is kept of them stays in the second cache.
constexpr std::size_t kEventsTogether = 512;

bool has_light(const PathEvent& event) {
  return event.light_weight > 0;
}

bool goes_on(Path path, std::size_t event) {
  return event + 1 < path.size() && path[event].inverse_next_pdf > 0;
}

// Those directions of some paths that count for something, by number: the light's of each event, then the next event's.
template <class Model>
class Directions {
  using P = typename ScalarOf<Model>::type;

 public:
  // Forgets all directions and makes room for `most`.
  void restart(std::size_t most) {
    size_ = 0;
    const std::size_t room = most + kWidth<P>;
    if (inputs_.front().size() >= room) return;
    for (auto& numbers : inputs_) numbers.resize(room);
    for (auto& numbers : values_) numbers.resize(room);
    for (auto& numbers : weights_) numbers.resize(room);
    factors_.resize(room / kWidth<P> + 1);
  }

  void add_all_of(Path path) {
    for (std::size_t e = 0; e < path.size(); ++e) {
      if (has_light(path[e])) add(path[e].point, path[e].light);
      if (goes_on(path, e)) add(path[e].point, path[e].next);
    }
  }

  void shade(const Model& model, bool with_slopes) {
    const std::size_t last = size_;
    while (size_ % kWidth<P> != 0) {  // fills the last packet with what counts for nothing
      set_weight(size_, Array3f::Zero());
      add({.cosine = 1, .chord_length = 0}, {});
    }
    for (std::size_t i = 0; i < size_; i += kWidth<P>) {
      renderer::LobeAngles<P> angles;
      angles.distance2.setConstant(input(2, i));
      angles.cos_cos.setConstant(input(3, i));
      angles.from_center.setConstant(P(0.0F));
      for (std::size_t p = 0; p < 3; ++p) angles.from_center[static_cast<int>(p)] = input(4 + p, i);
      const renderer::ThreadPoint<P> point{input(0, i), input(1, i)};
      auto& factors = factors_[i / kWidth<P>];
      factors = with_slopes ? model.slope_factors(point, angles) : model.factors(point, angles);
      const renderer::Rgb<P> value = model.value(factors);
      for (std::size_t c = 0; c < 3; ++c) store(value[static_cast<int>(c)], &values_[c][i]);
    }
    padded_ = size_;
    size_ = last;
  }

  Array3f value(std::size_t i) const { return {values_[0][i], values_[1][i], values_[2][i]}; }
  Array3f weight(std::size_t i) const { return {weights_[0][i], weights_[1][i], weights_[2][i]}; }
  void set_weight(std::size_t i, const Array3f& weight) {
    for (std::size_t c = 0; c < 3; ++c) weights_[c][i] = weight[static_cast<int>(c)];
  }

  // Adds the sum of weight d f_cos to `slopes`.
  void add_slopes(const Model& model, renderer::ThreadSlopes<double>& slopes) const {
    using Sum = Eigen::Array<P, Model::kSlopeCount, 3>;
    Sum sum = Sum::Constant(P(0.0F));
    for (std::size_t i = 0; i < padded_; i += kWidth<P>)
      model.add_slopes(factors_[i / kWidth<P>],
                       {load<P>(&weights_[0][i]), load<P>(&weights_[1][i]), load<P>(&weights_[2][i])}, sum);
    for (int k = 0; k < Model::kSlopeCount; ++k)
      for (int c = 0; c < 3; ++c) slopes(k, c) += sum_of_lanes(sum(k, c));
  }

 private:
  void add(const renderer::ThreadPoint<float>& point, const PathDirection& at) {
    const std::array<float, 7> numbers{point.cosine,      point.chord_length, at.distance2,     at.cos_cos,
                                       at.from_center[0], at.from_center[1],  at.from_center[2]};
    for (std::size_t k = 0; k < numbers.size(); ++k) inputs_[k][size_] = numbers[k];
    ++size_;
  }
  P input(std::size_t number, std::size_t i) const { return load<P>(&inputs_[number][i]); }

  std::array<std::vector<float>, 7> inputs_;
  std::array<std::vector<float>, 3> values_, weights_;
  std::vector<typename Model::Factors> factors_;  // by packet
  std::size_t size_ = 0, padded_ = 0;
};

// A_1 of a path whose directions start at `first`, which is moved behind them. The directions' weights are set, without
// T_v.
template <class Model>
Array3f radiance(Path path, Directions<Model>& directions, std::size_t& first) {
  std::size_t i = first;
  for (std::size_t e = 0; e < path.size(); ++e) i += std::size_t{has_light(path[e])} + std::size_t{goes_on(path, e)};
  first = i;
  Array3f arriving = Array3f::Zero();
  for (std::size_t e = path.size(); e-- > 0;) {
    if (goes_on(path, e)) {
      const Array3f weight = arriving * path[e].inverse_next_pdf;
      directions.set_weight(--i, weight);
      arriving = directions.value(i) * weight;
    }
    if (has_light(path[e])) {
      directions.set_weight(--i, Array3f::Constant(path[e].light_weight));
      arriving += directions.value(i) * path[e].light_weight;
    }
  }
  return arriving;
}

// Multiplies the weights of a path's directions from `first` on by T_v.
template <class Model>
void weigh(Path path, Directions<Model>& directions, std::size_t first) {
  Array3f throughput = Array3f::Ones();
  for (std::size_t e = 0, i = first; e < path.size(); ++e) {
    if (has_light(path[e])) directions.set_weight(i, directions.weight(i) * throughput), ++i;
    if (!goes_on(path, e)) continue;
    directions.set_weight(i, directions.weight(i) * throughput);
    throughput *= directions.value(i) * path[e].inverse_next_pdf;
    ++i;
  }
}

}  // namespace

BlockModel block_model(const renderer::ThreadParameters& parameters) {
  return BlockModel(renderer::ThreadGradientModel<float>(renderer::in_scalar<float>(parameters)));
}

FiberBlockModel block_model(const renderer::FiberParameters& parameters) {
  return FiberBlockModel(renderer::FiberGradientModel<float>(renderer::in_scalar<float>(parameters)));
}

YarnBlockModel block_model(const renderer::YarnParameters& parameters) {
  return YarnBlockModel(renderer::in_scalar<float>(parameters));
}

template <class Model>
BlockEstimate shade_block(const LightPaths& paths, std::size_t block, const Model& model, bool with_slopes) {
  const std::uint32_t begin = paths.block_paths[block], end = paths.block_paths[block + 1];
  const auto first_event = [&](std::uint32_t path) { return path == 0 ? 0 : paths.path_ends[path - 1]; };
  const auto events = [&](std::uint32_t path) {
    return Path(paths.events).subspan(first_event(path), paths.path_ends[path] - first_event(path));
  };
  const auto count = static_cast<int>(end - begin);
  const auto batch_limit = [&](int batch) { return begin + static_cast<std::uint32_t>(batch_end(count, batch)); };
  BlockEstimate estimate;
  Directions<Model> directions;
  std::array<Eigen::Array3d, kPathBatches> sums;
  sums.fill(Eigen::Array3d::Zero());
  std::uint32_t first = begin;
  for (int batch = 0; batch < kPathBatches; ++batch) {
    HalfEstimate& half = estimate.halves[static_cast<std::size_t>(batch) / (kPathBatches / 2)];
    for (std::uint32_t last = first; first < batch_limit(batch); first = last) {
      while (last < batch_limit(batch) &&
             (last == first || paths.path_ends[last] - first_event(first) <= kEventsTogether))
        ++last;
      directions.restart(2 * (paths.path_ends[last - 1] - first_event(first)));
      for (std::uint32_t path = first; path < last; ++path) directions.add_all_of(events(path));
      directions.shade(model, with_slopes);
      std::size_t direction = 0;
      for (std::uint32_t path = first; path < last; ++path) {
        const std::size_t own = direction;
        sums[static_cast<std::size_t>(batch)] += radiance(events(path), directions, direction).template cast<double>();
        if (with_slopes) weigh(events(path), directions, own);
      }
      if (with_slopes) directions.add_slopes(model, half.slopes);
    }
  }
  for (std::size_t batch = 0; batch < kPathBatches; ++batch)
    estimate.halves[batch / (kPathBatches / 2)].value += sums[batch];
  for (const HalfEstimate& half : estimate.halves) {
    estimate.value += half.value / count;
    estimate.slopes += half.slopes / count;
  }
  if (count < kPathBatches) {
    estimate.halves = {};
    return estimate;
  }
  for (int b = 0; b < kPathBatches; ++b) {
    const double size = batch_end(count, b) - (b > 0 ? batch_end(count, b - 1) : 0);
    const Eigen::Array3d off = sums[static_cast<std::size_t>(b)] / size - estimate.value;
    estimate.variance += off.square() / (kPathBatches * (kPathBatches - 1));
  }
  const double halfway = batch_end(count, kPathBatches / 2 - 1);
  for (std::size_t h = 0; h < 2; ++h) {
    const double size = h == 0 ? halfway : count - halfway;
    estimate.halves[h].value /= size;
    estimate.halves[h].slopes /= size;
  }
  return estimate;
}

template BlockEstimate shade_block(const LightPaths&, std::size_t, const BlockModel&, bool);
template BlockEstimate shade_block(const LightPaths&, std::size_t, const FiberBlockModel&, bool);
template BlockEstimate shade_block(const LightPaths&, std::size_t, const YarnBlockModel&, bool);

}  // namespace inversion
