#include "station/session/capture/delivered_pictures.h"

#include <algorithm>
#include <functional>
#include <string_view>

#include "station/bench/metering.h"
#include "station/documents/disk/sha256.h"

namespace station {

std::size_t DeliveredPictures::hash_of(const rig::Picture& picture) {
  return std::hash<std::string_view>{}({reinterpret_cast<const char*>(picture.bytes.data()), picture.bytes.size()});
}

void DeliveredPictures::add_test(const rig::Picture& test) {
  seen_.try_emplace(hash_of(test));
}

std::optional<std::string> DeliveredPictures::add(const rig::Picture& picture, const std::string& step,
                                                  const std::map<std::string, PictureRecord>& taken) {
  const auto [same, is_new] = seen_.try_emplace(hash_of(picture), step);
  if (!is_new) {
    return taken.contains(same->second) ? "picture of '" + same->second + "'"
                                        : "test or refused picture before '" + step + "'";
  }
  steps_.insert(step);
  const auto earlier = [&](const auto& entry) { return !steps_.contains(entry.first); };
  if (std::ranges::none_of(taken, earlier)) return std::nullopt;
  const std::string sha256 = sha256_hex(picture.bytes);
  const auto found =
      std::ranges::find_if(taken, [&](const auto& entry) { return earlier(entry) && entry.second.sha256 == sha256; });
  return found == taken.end() ? std::nullopt : std::optional("picture of '" + found->first + "'");
}

Verdict DeliveredPictures::check(const PictureRecord& asked, const rig::Picture& picture,
                                 const std::map<std::string, PictureRecord>& taken) {
  Verdict verdict;
  const auto bad = [&](const std::string& check, const std::string& reason, bool may_pass_again) {
    verdict.findings.push_back(
        {.check = check, .grade = Grade::bad, .value = {}, .reason = reason, .may_pass_again = may_pass_again});
  };
  if (picture.bytes.empty()) {
    bad("file", "the camera delivered an empty picture for '" + asked.step + "'; check its card and cable, then resume",
        true);
    return verdict;
  }
  if (!same_settings(asked.asked, picture.settings))
    bad("settings",
        "the picture '" + asked.step + "' was to be taken with " + settings_text(asked.asked) + " and says " +
            settings_text(picture.settings) + "; set the camera's dial to M (manual), then resume",
        false);
  if (const auto same = add(picture, asked.step, taken))
    bad("duplicate",
        "the camera delivered the " + *same + " again for '" + asked.step + "'; switch it off and on, then resume",
        true);
  return verdict;
}

}  // namespace station
