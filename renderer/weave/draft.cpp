#include "renderer/weave/draft.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <sstream>

namespace renderer {
namespace {

using Problem = std::optional<std::string>;

template <typename OnTop>
Draft make_draft(std::string name, int repeat, OnTop&& on_top) {
  Draft draft;
  draft.name = std::move(name);
  for (int pick = 0; pick < repeat; ++pick) {
    std::vector<bool> row;
    for (int end = 0; end < repeat; ++end) row.push_back(on_top(pick, end));
    draft.warp_over.push_back(row);
  }
  return draft;
}

std::string shown(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

Problem problem_of_structure(const Draft& draft) {
  const auto& rows = draft.warp_over;
  if (rows.empty() || rows.front().empty()) return "the structure is empty; give at least 2 picks of 2 ends";
  for (std::size_t pick = 0; pick < rows.size(); ++pick) {
    if (rows[pick].size() != rows.front().size())
      return "the structure is ragged: pick " + std::to_string(pick + 1) + " has " + std::to_string(rows[pick].size()) +
             " ends, pick 1 has " + std::to_string(rows.front().size()) + "; make all picks equally long";
  }
  return {};
}

Problem problem_of_floats(const Draft& draft) {
  const auto& rows = draft.warp_over;
  const std::size_t picks = rows.size(), ends = rows.front().size();
  const auto never = [](const char* kind, std::size_t index, bool on_top) {
    return kind + std::string(" ") + std::to_string(index + 1) + " never interlaces: it lies " +
           (on_top ? "over" : "under") + " every crossing yarn of the repeat; change the structure";
  };
  for (std::size_t end = 0; end < ends; ++end) {
    const auto over = [&](const std::vector<bool>& row) { return row[end] == rows[0][end]; };
    if (std::all_of(rows.begin(), rows.end(), over)) return never("warp end", end, rows[0][end]);
  }
  for (std::size_t pick = 0; pick < picks; ++pick) {
    const auto over = [&](bool warp_over) { return warp_over == rows[pick][0]; };
    if (std::all_of(rows[pick].begin(), rows[pick].end(), over)) return never("weft pick", pick, !rows[pick][0]);
  }
  return {};
}

// The number of yarns that move when warp end 0 is lifted (or pressed down): all that lie over (under) a yarn that
// moves.
std::size_t yarns_moved_with_the_first(const std::vector<std::vector<bool>>& warp_over, bool lifted) {
  const std::size_t picks = warp_over.size(), ends = warp_over.front().size();
  std::vector<bool> moved(ends + picks, false);
  std::vector<std::size_t> queue{0};
  moved[0] = true;
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const bool is_warp = queue[next] < ends;
    for (std::size_t k = 0; k < (is_warp ? picks : ends); ++k) {
      const std::size_t end = is_warp ? queue[next] : k, pick = is_warp ? k : queue[next] - ends;
      const std::size_t other = is_warp ? ends + pick : end;
      const bool other_over = warp_over[pick][end] != is_warp;
      if (moved[other] || other_over != lifted) continue;
      moved[other] = true;
      queue.push_back(other);
    }
  }
  return queue.size();
}

// A cloth hangs together when lifting any one yarn lifts all others (Clapham 1980): "lies over" is strongly
// connected.
Problem problem_of_layers(const Draft& draft) {
  const std::size_t yarns = draft.warp_over.size() + draft.warp_over.front().size();
  for (bool lifted : {true, false}) {
    const std::size_t moved = yarns_moved_with_the_first(draft.warp_over, lifted);
    if (moved < yarns)
      return std::to_string(lifted ? moved : yarns - moved) + " of the " + std::to_string(yarns) +
             " yarns of the repeat lie loose on top of the others: the cloth falls into layers; change the structure";
  }
  return {};
}

Problem problem_of_sizes(const char* kind, const YarnSystem& system) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  const std::string diameter = shown(system.diameter_mm) + " mm", pitch = shown(system.pitch_mm) + " mm";
  if (!positive(system.diameter_mm)) return kind + (" diameter is " + diameter) + "; give a positive one";
  if (!positive(system.pitch_mm)) return kind + (" pitch is " + pitch) + "; give a positive one";
  if (system.pitch_mm < system.diameter_mm)
    return kind + (" pitch " + pitch) + " is less than the yarn diameter " + diameter +
           ", so neighbouring yarns overlap; open the sett or take a thinner yarn";
  return {};
}

Problem problem_of_mechanics(const char* kind, const YarnSystem& system, bool free_periods) {
  const auto refused = [&](const char* what, double value, const char* wanted) {
    return kind + std::string(" ") + what + " is " + shown(value) + "; give " + wanted;
  };
  const auto within = [](double value, double low, double high) { return value >= low && value <= high; };
  if (!within(system.tex, 0, 1e6)) return refused("tex", system.tex, "grams per kilometre of yarn, 0 when unknown");
  if (!within(system.bending_n_mm2, 0, 1e6))
    return refused("bending stiffness", system.bending_n_mm2, "newtons x mm^2, 0 for that of a bundle of loose fibers");
  if (!within(system.tension_n, 0, 1e6)) return refused("tension", system.tension_n, "newtons, 0 or more");
  if (!within(system.contraction, 0, kMostContraction))
    return refused("contraction", system.contraction, "a share of the yarn's length from 0 to 0.3");
  if (!within(system.flatness, 1, kMostFlatness))
    return refused("flatness", system.flatness, "width over height of the section, from 1 (round) to 4");
  if (free_periods && system.contraction == 0)
    return kind + std::string(
                      " yarns have no contraction, so under their tension a cell of free periods shrinks "
                      "without end; give a contraction or fixed periods");
  return {};
}

Problem problem_of_threads(const char* kind, const YarnSystem& system) {
  if (system.threads.empty())
    return kind + std::string(" has no threads; name one thread per yarn of its colour order");
  for (int thread : system.threads) {
    if (thread < 0 || thread >= kMostThreads)
      return kind + std::string(" thread ") + std::to_string(thread) + " is not an index from 0 to " +
             std::to_string(kMostThreads - 1);
  }
  return {};
}

// Colour orders are capped here, so that the least common multiples below stay far from overflow.
Problem problem_of_extent(const Draft& draft) {
  const int most = draft.relaxed ? kMostCrossings : kMostUnrelaxedCrossings;
  const std::size_t longest = std::max(
      {draft.warp_over.size(), draft.warp_over.front().size(), draft.warp.threads.size(), draft.weft.threads.size()});
  const auto too_large = [&](const std::string& what) {
    return what + ", the most is " + std::to_string(most) + "; shorten the repeat or the colour order" +
           (draft.relaxed ? ", or leave the yarns unrelaxed" : "");
  };
  if (longest > static_cast<std::size_t>(most))
    return too_large("a repeat of " + std::to_string(longest) + " yarns is too large");
  const std::int64_t crossings = std::int64_t{ends_in_patch(draft)} * picks_in_patch(draft);
  if (crossings > most)
    return too_large("the patch is too large: " + std::to_string(ends_in_patch(draft)) + " ends x " +
                     std::to_string(picks_in_patch(draft)) + " picks are " + std::to_string(crossings) + " crossings");
  return {};
}

Problem problem_of_what_relaxes(const Draft& draft) {
  if (draft.relaxed || (!draft.free_periods && draft.transverse_modulus_n_mm2 == 0)) return {};
  return std::string(
      "free periods and a transverse modulus take effect while yarns come to rest; leave them out, or "
      "relax the yarns");
}

Problem problem_of_height_scale(const Draft& draft) {
  if (std::isfinite(draft.height_scale) && draft.height_scale > 0) return {};
  return "height scale is " + shown(draft.height_scale) + "; give a positive one, 1 for the shape as it is";
}

Problem problem_of_unevenness(const Unevenness& uneven, const Slubs& slubs) {
  const auto refused = [](const char* what, double value, const char* wanted) {
    return what + (" is " + shown(value)) + "; give " + wanted;
  };
  const auto share = [](double value) { return value >= 0 && value <= kMostUnevenness; };
  const auto length = [](double value) { return value >= kLeastSlub && value <= kMostSlub; };
  constexpr const char* kShare = "a share from 0 to 0.2";
  if (!share(uneven.radius)) return refused("unevenness of the radius", uneven.radius, kShare);
  if (!share(uneven.pitch)) return refused("unevenness of the pitch", uneven.pitch, kShare);
  if (uneven.shades < 1 || uneven.shades > kMostShades)
    return refused("number of shades of a thread", uneven.shades, "1 to 64");
  if (!share(slubs.radius)) return refused("slubs' deviation of the radius", slubs.radius, kShare);
  if (!share(slubs.twist)) return refused("slubs' deviation of the twist", slubs.twist, kShare);
  if (!length(slubs.length_mm)) return refused("slubs' length", slubs.length_mm, "0.01 to 10000 mm");
  if (slubs.shade_mm != 0 && !length(slubs.shade_mm))
    return refused("length of a shade along a yarn", slubs.shade_mm,
                   "0.01 to 10000 mm, or 0 for yarns of one shade each");
  if (slubs.shade_mm > 0 && uneven.shades == 1)
    return "threads have one shade, so it cannot change along a yarn; give 2 to 64 shades, or no length of a shade";
  return {};
}

Problem problem_of_sections(double modulus_n_mm2, const Plies& plies) {
  if (!(modulus_n_mm2 >= 0 && modulus_n_mm2 < kMostModulus))
    return "transverse modulus is " + shown(modulus_n_mm2) + "; give newtons / mm^2, 0 for sections as drafted";
  if (plies.count < 1 || plies.count > kMostPlies)
    return "number of plies of a yarn is " + std::to_string(plies.count) + "; give 1 to 12";
  if (!(std::abs(plies.turns_per_mm) <= kMostTurnsPerMm))
    return "turns of the plies are " + shown(plies.turns_per_mm) + " per mm; give at most 20 either way";
  if (!(plies.radius_mm >= 0 && std::isfinite(plies.radius_mm)))
    return "radius of a ply is " + shown(plies.radius_mm) + " mm; give a positive one, or 0 for as large as fits";
  return {};
}

}  // namespace

Draft plain_draft() {
  return make_draft("plain", 2, [](int pick, int end) { return (pick + end) % 2 == 0; });
}

Draft twill_draft(int over, int under) {
  assert(over > 0 && under > 0);
  const int repeat = over + under;
  return make_draft("twill " + std::to_string(over) + "/" + std::to_string(under), repeat,
                    [=](int pick, int end) { return (end - pick + repeat) % repeat < over; });
}

Draft satin_draft(int ends, int step) {
  assert(std::gcd(ends, step) == 1 && step > 1 && step < ends - 1);
  return make_draft("satin " + std::to_string(ends), ends,
                    [=](int pick, int end) { return end != pick * step % ends; });
}

Draft basket_draft(int yarns) {
  assert(yarns > 0);
  return make_draft("basket " + std::to_string(yarns) + "/" + std::to_string(yarns), 2 * yarns,
                    [=](int pick, int end) { return (pick / yarns + end / yarns) % 2 == 0; });
}

double bending_of(const YarnSystem& system) {
  return system.bending_n_mm2 > 0 ? system.bending_n_mm2 : kBundleBending * system.diameter_mm * system.diameter_mm;
}

int ends_in_patch(const Draft& draft) {
  return static_cast<int>(std::lcm(draft.warp_over.front().size(), draft.warp.threads.size()));
}

int picks_in_patch(const Draft& draft) {
  return static_cast<int>(std::lcm(draft.warp_over.size(), draft.weft.threads.size()));
}

std::optional<std::string> check_draft(const Draft& draft) {
  Problem problem = problem_of_structure(draft);
  if (!problem) problem = problem_of_sizes("warp", draft.warp);
  if (!problem) problem = problem_of_sizes("weft", draft.weft);
  if (!problem) problem = problem_of_mechanics("warp", draft.warp, draft.free_periods);
  if (!problem) problem = problem_of_mechanics("weft", draft.weft, draft.free_periods);
  if (!problem) problem = problem_of_height_scale(draft);
  if (!problem) problem = problem_of_what_relaxes(draft);
  if (!problem) problem = problem_of_unevenness(draft.unevenness, draft.slubs);
  if (!problem) problem = problem_of_sections(draft.transverse_modulus_n_mm2, draft.plies);
  if (!problem) problem = problem_of_threads("warp", draft.warp);
  if (!problem) problem = problem_of_threads("weft", draft.weft);
  if (!problem) problem = problem_of_extent(draft);
  if (!problem) problem = problem_of_floats(draft);
  if (!problem) problem = problem_of_layers(draft);
  return problem;
}

}  // namespace renderer
