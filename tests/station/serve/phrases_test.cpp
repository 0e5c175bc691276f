// The catalogues of what the program says, station/serve/page/phrases.*.json: templates are its own sentences.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>

#include "tests/places.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = fs::path(FIXTURES_DIR).parent_path();

std::string content_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

// All string literals of a source file, neighbours joined as a compiler joins them.
std::string literals_of(const std::string& source) {
  std::string all;
  bool joins = false;
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (source[i] == '\'' && i + 2 < source.size()) {  // a character, which may be a quotation mark
      if (source[i + 1] == '\\' && source[i + 3] == '\'')
        i += 3;
      else if (source[i + 2] == '\'')
        i += 2;
      continue;
    }
    if (source[i] != '"') {
      joins = joins && std::isspace(static_cast<unsigned char>(source[i])) != 0;
      continue;
    }
    if (!joins) all += '\n';
    for (++i; i < source.size() && source[i] != '"'; ++i) {
      if (source[i] == '\\' && i + 1 < source.size()) ++i;
      all += source[i];
    }
    joins = true;
  }
  return all;
}

std::set<std::string> places_of(const std::string& words) {
  static const std::regex place("\\{[a-z]\\}");
  std::set<std::string> found;
  for (std::sregex_iterator at(words.begin(), words.end(), place), end; at != end; ++at) found.insert(at->str());
  return found;
}

TEST(Phrases, AreThoseThatTheProgramSaysAndKeepTheirValues) {
  constexpr std::size_t kTells = 12;  // characters that say where a sentence comes from
  std::string sources;
  for (const char* room : {"station", "rig", "calibration", "inversion"})
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / room))
      if (entry.path().extension() == ".cpp" || entry.path().extension() == ".h")
        sources += literals_of(content_of(entry.path()));
  int catalogues = 0;
  for (const auto& entry : fs::directory_iterator(kRoot / "station/serve/page")) {
    if (!entry.path().filename().string().starts_with("phrases.") || entry.path().extension() != ".json") continue;
    ++catalogues;
    const auto phrases = nlohmann::json::parse(content_of(entry.path()));
    EXPECT_GT(phrases.size(), 150U);
    for (const auto& [english, other] : phrases.items()) {
      EXPECT_EQ(places_of(english), places_of(other.get<std::string>())) << english;
      static const std::regex place("\\{[a-z]\\}");
      for (std::sregex_token_iterator at(english.begin(), english.end(), place, -1), end; at != end; ++at)
        if (at->length() > static_cast<std::ptrdiff_t>(kTells))
          EXPECT_NE(sources.find(at->str()), std::string::npos) << "nobody says \"" << at->str() << "\"";
    }
  }
  EXPECT_GE(catalogues, 1);
}

}  // namespace
}  // namespace station_test
