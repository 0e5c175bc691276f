// Reads every #include of the program and holds it against the one direction of arrows:
//   station -> rig, calibration, inversion, renderer;  inversion -> renderer;  the others on none of the others.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "tests/places.h"

namespace {

namespace fs = std::filesystem;
const fs::path kRoot = SOURCE_DIR;

const std::map<std::string, std::set<std::string>> kAllowed{
    {"station", {"station", "rig", "calibration", "inversion", "renderer"}},
    {"inversion", {"inversion", "renderer"}},
    {"rig", {"rig"}},
    {"calibration", {"calibration"}},
    {"renderer", {"renderer"}}};

struct Include {
  fs::path file;
  std::string target;  // as written between the quotes or brackets
};

std::vector<Include> includes_in(const fs::path& folder) {
  static const std::regex kInclude(R"re(^\s*#\s*include\s*["<]([^">]+)[">])re");
  std::vector<Include> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".h" && extension != ".cpp") continue;
    std::ifstream in(entry.path());
    std::smatch match;
    for (std::string line; std::getline(in, line);)
      if (std::regex_search(line, match, kInclude)) found.push_back({entry.path(), match[1]});
  }
  return found;
}

TEST(Architecture, EveryIncludeFollowsTheArrows) {
  int checked = 0;
  for (const auto& [folder, allowed] : kAllowed)
    for (const Include& include : includes_in(kRoot / folder)) {
      const std::string target = include.target.substr(0, include.target.find('/'));
      if (!kAllowed.contains(target) && target != "tests" && target != "..") continue;  // a library's header
      ++checked;
      EXPECT_TRUE(allowed.contains(target)) << fs::relative(include.file, kRoot) << " includes " << include.target;
    }
  EXPECT_GT(checked, 50) << "the test must see the program's includes";
}

TEST(Architecture, EachOfTheseLibrariesIsMetInOneFolder) {
  const std::map<std::string, std::string> home{
      {"embree3", "renderer"},  {"OpenImageIO", "renderer"}, {"libraw", "calibration"},  {"apriltag", "calibration"},
      {"mrcal", "calibration"}, {"gphoto2", "rig"},          {"libserialport.h", "rig"}, {"CLI", "station"}};
  for (const auto& [folder, unused] : kAllowed)
    for (const Include& include : includes_in(kRoot / folder))
      for (const auto& [library, owner] : home)
        if (include.target == library || include.target.starts_with(library + "/")) {
          EXPECT_EQ(folder, owner) << fs::relative(include.file, kRoot) << " includes " << include.target;
        }
}

TEST(Architecture, TheTopLevelHasTheAgreedFoldersAndNothingElse) {
  const std::set<std::string> agreed{"CMakeLists.txt", "README.md", "LICENSE",  "station", "rig",
                                     "calibration",    "inversion", "renderer", "tests",   "fixtures"};
  for (const auto& entry : fs::directory_iterator(kRoot)) {
    const std::string name = entry.path().filename().string();
    const bool made_by_commands = name.starts_with("build") || name == "demo";  // ignored by git
    EXPECT_TRUE(name.starts_with(".") || made_by_commands || agreed.contains(name)) << name;
  }
}

}  // namespace
