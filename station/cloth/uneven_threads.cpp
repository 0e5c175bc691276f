#include "station/cloth/uneven_threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace station {
namespace {

constexpr std::size_t kFewestYarns = 20;  // of a system, in a repeat

// Means of the fifths of a normal distribution.
constexpr std::array<double, kThreadShades> kFifths{-1.3998, -0.5319, 0, 0.5319, 1.3998};

std::vector<std::vector<bool>> repeated(const std::vector<std::vector<bool>>& warp_over) {
  const auto enough = [](std::size_t yarns) { return yarns * ((kFewestYarns + yarns - 1) / yarns); };
  std::vector<std::vector<bool>> more(enough(warp_over.size()));
  for (std::size_t pick = 0; pick < more.size(); ++pick) {
    const std::vector<bool>& row = warp_over[pick % warp_over.size()];
    for (std::size_t end = 0; end < enough(row.size()); ++end) more[pick].push_back(row[end % row.size()]);
  }
  return more;
}

}  // namespace

ThreadIrregularity irregularity_of(const ThreadFile& thread, const std::filesystem::path& file) {
  const auto found = thread.fit.find("irregularity");
  if (found == thread.fit.end() || !found->is_object())
    throw std::runtime_error("how uneven the thread " + file.string() +
                             " is was not measured; fit its session again with invert, or leave --uneven out");
  const auto value = [&](const char* what) {
    const auto one = found->find(what);
    return one != found->end() && one->is_object() ? one->value("value", 0.0) : 0.0;
  };
  return {.shade = value("shade"), .diameter = value("diameter"), .length_mm = found->value("length_mm", 0.0)};
}

std::vector<ThreadFile> shades_of(const ThreadFile& thread, double shade) {
  // The fifths' means vary by less than what they stand for.
  double variance = 0;
  for (const double fifth : kFifths) variance += fifth * fifth / kThreadShades;
  std::vector<ThreadFile> shades(kThreadShades, thread);
  for (std::size_t i = 0; i < shades.size(); ++i) {
    shades[i].name += ", shade " + std::to_string(i + 1) + " of " + std::to_string(kThreadShades);
    shades[i].parameters.sigma_a *= std::exp(shade * kFifths.at(i) / std::sqrt(variance));
  }
  return shades;
}

renderer::Draft uneven_draft(renderer::Draft draft, const ThreadIrregularity& warp, const ThreadIrregularity& weft) {
  draft.warp_over = repeated(draft.warp_over);
  const double diameter = std::hypot(warp.diameter, weft.diameter) / std::sqrt(2.0),
               length_mm = (warp.length_mm + weft.length_mm) / 2;
  const double repeat_mm = std::min(static_cast<double>(draft.warp_over.size()) * draft.weft.pitch_mm,
                                    static_cast<double>(draft.warp_over.front().size()) * draft.warp.pitch_mm);
  draft.unevenness.shades = kThreadShades;
  // A yarn that stays alike for longer than the repeat differs from its neighbours, and one that does not along itself.
  constexpr double kLengthsInARepeat = 5;
  const bool along = kLengthsInARepeat * length_mm < repeat_mm;
  draft.unevenness.radius = along ? 0 : diameter;
  draft.slubs.radius = along ? diameter : 0;
  draft.slubs.shade_mm = along ? length_mm : 0;
  if (along) draft.slubs.length_mm = length_mm;
  return draft;
}

}  // namespace station
