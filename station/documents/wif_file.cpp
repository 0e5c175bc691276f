#include "station/documents/wif_file.h"

#define SI_NO_CONVERSION  // bytes stay as they are
#include <SimpleIni.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "station/documents/disk/shown_text.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/text_pieces.h"

namespace station {
namespace {

using Structure = std::vector<std::vector<bool>>;

constexpr std::size_t kMostBytes = 8 << 20;
constexpr int kMostShafts = 1024, kMostColors = 65536;
constexpr double kMillimetresPerInch = 25.4;

std::string without_comment(const std::string& text) {
  return trimmed(text.substr(0, text.find(';')));
}

std::string quoted(const std::string& text) {
  return "\"" + shown_text(text) + "\"";
}

std::optional<double> number_in(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

class WifReader {
 public:
  WifReader(const std::string& text, std::string source) : source_(std::move(source)) {
    if (text.empty()) fail("is empty; give a Weaving Information File");
    if (text.size() > kMostBytes) fail("is larger than 8 MB; this is no draft");
    if (text.find('\0') != std::string::npos) fail("has bytes of zero; save it as plain text");
    if (ini_.LoadData(text.data(), text.size()) < 0) fail("cannot be read as sections and keys; export it again");
    if (!ini_.SectionExists("WIF")) fail("has no [WIF] section; give a Weaving Information File");
    if (text.back() != '\n' && text.back() != '\r') fail("ends within a line: it is cut short; export it again");
    check_contents();
  }

  bool has(const char* section) const { return ini_.SectionExists(section); }

  [[noreturn]] void fail(const std::string& what) const { throw std::runtime_error(source_ + ": " + what); }
  [[noreturn]] void fail(const char* section, const std::string& key, const std::string& what) const {
    fail("[" + std::string(section) + "] " + key + " " + what);
  }

  std::optional<std::string> text(const char* section, const char* key) const {
    const char* value = ini_.GetValue(section, key);
    if (!value) return {};
    return without_comment(value);
  }
  std::string needed(const char* section, const char* key, const char* why) const {
    const auto value = text(section, key);
    if (!value || value->empty()) fail(section, key, std::string("is missing; ") + why);
    return *value;
  }
  double number(const char* section, const char* key, const char* why) const {
    const std::string value = needed(section, key, why);
    const auto parsed = number_in(value);
    if (!parsed) fail(section, key, "is " + quoted(value) + ", expected a number");
    return *parsed;
  }
  int count(const char* section, const char* key, int most) const {
    const double value = number(section, key, "a draft cannot be read without it");
    if (value != std::floor(value) || value < 1 || value > most)
      fail(section, key,
           "is " + quoted(*text(section, key)) + ", expected a whole number from 1 to " + std::to_string(most));
    return static_cast<int>(value);
  }
  bool flag(const char* section, const char* key, bool otherwise) const {
    const auto value = text(section, key);
    if (!value) return otherwise;
    const std::string word = lower_case(*value);
    if (word == "true" || word == "on" || word == "yes" || word == "1") return true;
    if (word == "false" || word == "off" || word == "no" || word == "0") return false;
    fail(section, key, "is " + quoted(*value) + ", expected true or false");
  }

  // The lines "number = list of numbers" of a section, by number.
  std::map<int, std::vector<int>> lists(const char* section, int most_key, int most_value) const {
    std::map<int, std::vector<int>> lines;
    const auto* keys = ini_.GetSection(section);
    if (!keys) return lines;
    for (const auto& [key, value] : *keys) {
      const int line = whole(section, key.pItem, key.pItem, 1, most_key);
      const std::string list = without_comment(value);
      std::vector<int>& numbers = lines[line];
      std::istringstream parts(list);
      for (std::string part; std::getline(parts, part, ',');)
        numbers.push_back(whole(section, key.pItem, trimmed(part), 0, most_value));
      if (numbers.empty() || list.back() == ',')
        fail(section, key.pItem, "ends before its number: the file is damaged or cut short");
    }
    return lines;
  }

 private:
  int whole(const char* section, const std::string& key, const std::string& text, int least, int most) const {
    const auto value = number_in(text);
    if (!value || *value != std::floor(*value) || *value < least || *value > most)
      fail(section, quoted(key),
           "has " + quoted(text) + ", expected whole numbers from " + std::to_string(least) + " to " +
               std::to_string(most));
    return static_cast<int>(*value);
  }
  void check_contents() const {
    const auto* keys = ini_.GetSection("CONTENTS");
    if (!keys) return;
    for (const auto& [key, value] : *keys) {
      if (lower_case(without_comment(value)) == "true" && !ini_.SectionExists(key.pItem))
        fail("[CONTENTS] promises the section " + quoted(key.pItem) +
             ", which is not there: the file is cut short; export it again");
    }
  }

  std::string source_;
  CSimpleIniA ini_;  // names in any case
};

// Millimetres of one unit of a section.
double unit_mm(const WifReader& wif, const char* section) {
  const std::string units = lower_case(wif.needed(section, "Units", "give centimeters, inches or decipoints"));
  if (units == "centimeters") return 10;
  if (units == "inches") return kMillimetresPerInch;
  if (units == "decipoints") return kMillimetresPerInch / 720;
  wif.fail(section, "Units", "is " + quoted(units) + ", expected centimeters, inches or decipoints");
}

// Shortest period that the sequence repeats a whole number of times.
template <typename T>
std::size_t shortest_repeat(const std::vector<T>& sequence) {
  for (std::size_t period = 1; period <= sequence.size() / 2; ++period) {
    if (sequence.size() % period) continue;
    bool repeats = true;
    for (std::size_t i = period; i < sequence.size() && repeats; ++i) repeats = sequence[i] == sequence[i - period];
    if (repeats) return period;
  }
  return sequence.size();
}

Structure transposed(const Structure& rows) {
  Structure columns(rows.front().size(), std::vector<bool>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < rows[i].size(); ++j) columns[j][i] = rows[i][j];
  return columns;
}

Structure one_repeat(Structure rows) {
  rows.resize(shortest_repeat(rows));
  Structure columns = transposed(rows);
  columns.resize(shortest_repeat(columns));
  return transposed(columns);
}

// Shafts that are lifted (or sunk) for each pick: the lift plan, or the treadles' ties.
std::vector<std::vector<int>> shafts_of_picks(const WifReader& wif, int shafts, int picks) {
  std::vector<std::vector<int>> lifted(static_cast<std::size_t>(picks));
  if (wif.has("LIFTPLAN")) {
    const auto plan = wif.lists("LIFTPLAN", picks, shafts);
    if (plan.empty() || plan.rbegin()->first != picks)
      wif.fail("[LIFTPLAN] ends at pick " + std::to_string(plan.empty() ? 0 : plan.rbegin()->first) + " of the " +
               std::to_string(picks) + " of [WEFT] Threads: the file is cut short; export it again");
    for (const auto& [pick, list] : plan) lifted[static_cast<std::size_t>(pick - 1)] = list;
    return lifted;
  }
  const int treadles = wif.count("WEAVING", "Treadles", kMostShafts);
  const auto treadling = wif.lists("TREADLING", picks, treadles);
  if (treadling.empty() || treadling.rbegin()->first != picks)
    wif.fail("[TREADLING] ends at pick " + std::to_string(treadling.empty() ? 0 : treadling.rbegin()->first) +
             " of the " + std::to_string(picks) + " of [WEFT] Threads: the file is cut short; export it again");
  const auto ties = wif.lists("TIEUP", treadles, shafts);
  for (const auto& [pick, list] : treadling) {
    for (const int treadle : list) {
      if (treadle == 0) continue;
      const auto tie = ties.find(treadle);
      if (tie == ties.end())
        wif.fail("[TREADLING] pick " + std::to_string(pick) + " uses treadle " + std::to_string(treadle) +
                 ", which [TIEUP] ties to no shaft; add it");
      auto& own = lifted[static_cast<std::size_t>(pick - 1)];
      own.insert(own.end(), tie->second.begin(), tie->second.end());
    }
  }
  return lifted;
}

Structure drawdown(const WifReader& wif, int ends, int picks) {
  const int shafts = wif.count("WEAVING", "Shafts", kMostShafts);
  const bool rising = wif.flag("WEAVING", "Rising Shed", true);
  const auto threading = wif.lists("THREADING", ends, shafts);
  for (int end = 1; end <= ends; ++end) {
    if (threading.contains(end)) continue;
    wif.fail("[THREADING] has no shaft for end " + std::to_string(end) + " of the " + std::to_string(ends) +
             " of [WARP] Threads: the file is cut short, or an end is not threaded; complete it");
  }
  const auto moved = shafts_of_picks(wif, shafts, picks);
  Structure warp_over(static_cast<std::size_t>(picks), std::vector<bool>(static_cast<std::size_t>(ends)));
  for (std::size_t pick = 0; pick < warp_over.size(); ++pick) {
    std::vector<bool> is_moved(static_cast<std::size_t>(shafts) + 1, false);
    for (const int shaft : moved[pick]) is_moved[static_cast<std::size_t>(shaft)] = shaft > 0;
    for (const auto& [end, list] : threading) {
      const bool with_a_shaft = std::any_of(list.begin(), list.end(), [&](int shaft) {
        return static_cast<bool>(is_moved[static_cast<std::size_t>(shaft)]);
      });
      warp_over[pick][static_cast<std::size_t>(end - 1)] = with_a_shaft == rising;
    }
  }
  return warp_over;
}

// Colour of each yarn of a system: its own, or the system's.
std::vector<int> colors_of(const WifReader& wif, const char* system, const char* colors, int count) {
  int common = 1;
  if (const auto value = wif.text(system, "Color")) {
    const auto parsed = number_in(value->substr(0, value->find(',')));
    if (!parsed || *parsed != std::floor(*parsed) || *parsed < 0 || *parsed > kMostColors)
      wif.fail(system, "Color", "is " + quoted(*value) + ", expected the number of a colour");
    common = static_cast<int>(*parsed);
  }
  std::vector<int> order(static_cast<std::size_t>(count), common);
  for (const auto& [yarn, list] : wif.lists(colors, count, kMostColors))
    order[static_cast<std::size_t>(yarn - 1)] = list.front();
  order.resize(shortest_repeat(order));
  return order;
}

renderer::YarnSystem system_of(const WifReader& wif, const char* section, const std::vector<int>& colors,
                               std::map<int, int>& thread_of_color) {
  renderer::YarnSystem system;
  const double unit = unit_mm(wif, section);
  const char* why = "the cloth's size depends on it; add it to the file";
  system.pitch_mm = unit * wif.number(section, "Spacing", why);
  system.diameter_mm = unit * wif.number(section, "Thickness", why);
  system.threads.clear();
  for (const int color : colors)
    system.threads.push_back(
        thread_of_color.try_emplace(color, static_cast<int>(thread_of_color.size())).first->second);
  return system;
}

}  // namespace

renderer::Draft parse_wif(const std::string& text, const std::string& source) {
  const WifReader wif(text, source);
  const int ends = wif.count("WARP", "Threads", renderer::kMostCrossings),
            picks = wif.count("WEFT", "Threads", renderer::kMostCrossings);
  renderer::Draft draft;
  draft.name = wif.text("TEXT", "Title").value_or("");
  if (draft.name.empty()) draft.name = std::filesystem::path(source).stem().string();
  draft.warp_over = one_repeat(drawdown(wif, ends, picks));
  std::map<int, int> thread_of_color;
  draft.warp = system_of(wif, "WARP", colors_of(wif, "WARP", "WARP COLORS", ends), thread_of_color);
  draft.weft = system_of(wif, "WEFT", colors_of(wif, "WEFT", "WEFT COLORS", picks), thread_of_color);
  if (const auto problem = renderer::check_draft(draft)) throw std::runtime_error(source + ": " + *problem);
  return draft;
}

renderer::Draft read_wif(const std::filesystem::path& file) {
  return parse_wif(text_of_file(file), file.string());
}

}  // namespace station
