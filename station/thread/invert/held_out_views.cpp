#include "station/thread/invert/held_out_views.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>

namespace station {
namespace {

// The views of one light and one mounting.
struct Series {
  bool transmission = false;
  std::vector<std::size_t> views{};  // by the platform's angle
  int out = 0;                       // how many of them are left out

  int size() const { return static_cast<int>(views.size()); }
  int most() const { return (size() - 1) / 2; }
};

std::vector<Series> series_of(const std::vector<DevelopedView>& views) {
  std::map<std::pair<bool, rig::Mounting>, Series> series;
  for (std::size_t i = 0; i < views.size(); ++i) {
    Series& of = series[{views[i].view.transmission, views[i].mounting}];
    of.transmission = views[i].view.transmission;
    of.views.push_back(i);
  }
  std::vector<Series> all;
  for (auto& [key, of] : series) {
    std::ranges::sort(of.views, {}, [&](std::size_t i) { return views[i].platform_angle_rad; });
    all.push_back(std::move(of));
  }
  return all;
}

// The share of the views of a light that are left out.
double share_out(const std::vector<Series>& all, bool transmission) {
  int out = 0, views = 0;
  for (const Series& series : all)
    if (series.transmission == transmission) out += series.out, views += series.size();
  return static_cast<double>(out) / std::max(1, views);
}

}  // namespace

std::vector<bool> held_out_views(const std::vector<DevelopedView>& views, int count) {
  std::vector<Series> all = series_of(views);
  int most = 0;
  for (const Series& series : all) most += series.most();
  if (count > most)
    throw std::runtime_error("--hold-out " + std::to_string(count) + ": of the session's " +
                             std::to_string(views.size()) + " views at most " + std::to_string(most) +
                             " can be left out, so that each has fitted ones on both sides; ask for at most " +
                             std::to_string(most));
  for (int i = 0; i < count; ++i) {
    const auto rank = [&](const Series& series) {
      return std::tuple(series.out == series.most(), share_out(all, series.transmission),
                        static_cast<double>(series.out) / std::max(1, series.size()));
    };
    ++std::ranges::min_element(all, {}, rank)->out;
  }
  std::vector<bool> out(views.size(), false);
  for (const Series& series : all)
    for (int part = 0; part < series.out; ++part)  // the middle of each of as many equal parts
      out[series.views[static_cast<std::size_t>((2 * part + 1) * series.size() / (2 * series.out))]] = true;
  return out;
}

}  // namespace station
