#include "renderer/scattering/thread_batch.h"

#include <cassert>
#include <cstddef>

#include "renderer/scattering/packet.h"

namespace renderer {
namespace {

constexpr std::size_t kWidth = kPacketWidth;
using P = Packet<kPacketWidth>;

// The packet of the numbers from `first` on, filled up with the last number beyond the end.
P load(std::span<const float> numbers, std::size_t first) {
  if (first + kWidth <= numbers.size()) return P::load(&numbers[first]);
  P packet(numbers.back());
  for (std::size_t i = first; i < numbers.size(); ++i) packet.set(static_cast<int>(i - first), numbers[i]);
  return packet;
}

void store(const P& packet, std::span<float> numbers, std::size_t first) {
  if (first + kWidth <= numbers.size()) return packet.store(&numbers[first]);
  for (std::size_t i = first; i < numbers.size(); ++i) numbers[i] = packet[static_cast<int>(i - first)];
}

Vec3<P> load(const std::array<std::span<const float>, 3>& directions, std::size_t first) {
  return {load(directions[0], first), load(directions[1], first), load(directions[2], first)};
}

}  // namespace

void evaluate_batch(const ThreadModel<float>& model, const ThreadPlaces& places, const ThreadValues& values) {
  const std::size_t count = places.h.size();
  for (std::size_t c = 0; c < 3; ++c)
    assert(places.wo[c].size() == count && places.wi[c].size() == count && values.f_cos[c].size() == count);
  assert(values.pdf.size() == count);
  const ThreadModel<P> packets(model);
  for (std::size_t first = 0; first < count; first += kWidth) {
    const ScatteringValue<P> value =
        packets.lobes_at(load(places.h, first), load(places.wo, first)).evaluate(load(places.wi, first));
    for (std::size_t c = 0; c < 3; ++c) store(value.f_cos[static_cast<int>(c)], values.f_cos[c], first);
    store(value.pdf, values.pdf, first);
  }
}

}  // namespace renderer
