// Reads every #include of the program and holds it against the rooms: a room may include its own headers and those of
// the rooms that its CMakeLists.txt names. Neither rooms nor files include each other in a circle.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/places.h"

namespace {

namespace fs = std::filesystem;
const fs::path kRoot = SOURCE_DIR;
const std::vector<std::string> kFolders{"station", "rig", "calibration", "inversion", "renderer"};

using Graph = std::map<std::string, std::set<std::string>>;

struct Include {
  std::string file;    // from the root of the repository
  std::string target;  // as written between the quotes or brackets
  bool quoted = false;
};

std::vector<Include> includes() {
  static const std::regex kInclude(R"re(^\s*#\s*include\s*(["<])([^">]+)[">])re");
  std::vector<Include> found;
  for (const std::string& folder : kFolders)
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cpp") continue;
      std::ifstream in(entry.path());
      std::smatch match;
      for (std::string line; std::getline(in, line);)
        if (std::regex_search(line, match, kInclude))
          found.push_back({fs::relative(entry.path(), kRoot), match[2], match[1] == "\""});
    }
  return found;
}

// "station/bench" of "station/bench/calibrate/lamps.h"; the folder alone for a file that lies in no room.
std::string room_of(const std::string& file) {
  std::istringstream parts(file);
  std::string folder, room, rest;
  std::getline(parts, folder, '/');
  std::getline(parts, room, '/');
  return std::getline(parts, rest, '/') ? folder + "/" + room : folder;
}

bool ours(const std::string& target) {
  return std::find(kFolders.begin(), kFolders.end(), target.substr(0, target.find('/'))) != kFolders.end();
}

// The rooms that each room may include, as CMake knows them: a line "folder/room: other_room other_room" each.
Graph linked_rooms() {
  Graph rooms;
  std::ifstream in(ROOMS_FILE);
  for (std::string line; std::getline(in, line);) {
    if (line.empty()) continue;
    const std::size_t colon = line.find(':');
    std::set<std::string>& linked = rooms[line.substr(0, colon)];
    std::istringstream names(line.substr(colon + 1));
    for (std::string name; names >> name;) linked.insert(name.replace(name.find('_'), 1, "/"));
  }
  return rooms;
}

// The nodes of one circle in the order of its arrows; empty when there is none.
std::vector<std::string> a_circle(const Graph& graph) {
  enum class Visit { under_way, done };
  std::map<std::string, Visit> visits;
  std::vector<std::string> path;
  const std::function<bool(const std::string&)> closes = [&](const std::string& node) {
    if (const auto visit = visits.find(node); visit != visits.end()) {
      if (visit->second == Visit::done) return false;
      path.erase(path.begin(), std::find(path.begin(), path.end(), node));
      return true;
    }
    visits[node] = Visit::under_way;
    path.push_back(node);
    if (const auto next = graph.find(node); next != graph.end())
      for (const std::string& target : next->second)
        if (closes(target)) return true;
    visits[node] = Visit::done;
    path.pop_back();
    return false;
  };
  for (const auto& [node, targets] : graph)
    if (closes(node)) return path;
  return {};
}

std::string text(const std::vector<std::string>& circle) {
  std::string joined;
  for (const std::string& node : circle) joined += node + " -> ";
  return joined + "...";
}

TEST(Architecture, EachRoomIncludesOnlyTheRoomsThatItNames) {
  const Graph rooms = linked_rooms();
  EXPECT_GT(rooms.size(), 20U) << "CMake must have listed the rooms in " << ROOMS_FILE;
  int checked = 0;
  for (const Include& include : includes()) {
    if (!ours(include.target) && !include.target.starts_with("tests/") && !include.target.starts_with("..")) continue;
    const std::string from = room_of(include.file), to = room_of(include.target);
    if (include.file == "station/main.cpp") continue;  // stands above all rooms
    ++checked;
    if (from == to) continue;
    const auto room = rooms.find(from);
    EXPECT_TRUE(room != rooms.end() && room->second.contains(to)) << include.file << " includes " << include.target;
  }
  EXPECT_GT(checked, 1000) << "the test must see the program's includes";
}

// A name without its folder would be found beside its file, and pass all other tests unseen.
TEST(Architecture, EachQuotedIncludeBeginsWithAFolderOfOurs) {
  for (const Include& include : includes())
    EXPECT_TRUE(!include.quoted || ours(include.target)) << include.file << " includes \"" << include.target << '"';
}

TEST(Architecture, RoomsNameOnlyRoomsThatTheyInclude) {
  Graph met;
  for (const Include& include : includes()) met[room_of(include.file)].insert(room_of(include.target));
  for (const auto& [room, linked] : linked_rooms())
    for (const std::string& other : linked)
      EXPECT_TRUE(met[room].contains(other)) << room << "/CMakeLists.txt names " << other;
}

TEST(Architecture, NoCircleAmongRooms) {
  EXPECT_EQ(a_circle(linked_rooms()), std::vector<std::string>{}) << text(a_circle(linked_rooms()));
}

// station/session/record and its like: parts of a room, where it has some.
TEST(Architecture, NoCircleAmongFolders) {
  Graph folders;
  for (const Include& include : includes()) {
    const std::string from = fs::path(include.file).parent_path(), to = fs::path(include.target).parent_path();
    if (ours(include.target) && from != to) folders[from].insert(to);
  }
  EXPECT_EQ(a_circle(folders), std::vector<std::string>{}) << text(a_circle(folders));
}

TEST(Architecture, NoCircleAmongFiles) {
  Graph files;  // a header and its source are one
  for (const Include& include : includes()) {
    const std::string from = fs::path(include.file).replace_extension(),
                      to = fs::path(include.target).replace_extension();
    if (ours(include.target) && from != to) files[from].insert(to);
  }
  EXPECT_GT(files.size(), 300U);
  EXPECT_EQ(a_circle(files), std::vector<std::string>{}) << text(a_circle(files));
}

TEST(Architecture, EachOfTheseLibrariesIsMetInOneRoom) {
  const std::map<std::string, std::set<std::string>> home{{"embree3", {"renderer/trace"}},
                                                          {"png.h", {"renderer/picture"}},
                                                          {"tiffio.h", {"renderer/picture"}},
                                                          {"exiv2", {"renderer/picture"}},
                                                          {"ImfInputFile.h", {"renderer/picture"}},
                                                          {"assimp", {"renderer/scene"}},
                                                          {"libraw", {"calibration/sensor"}},
                                                          {"apriltag", {"calibration/geometry"}},
                                                          {"mrcal", {"calibration/geometry"}},
                                                          {"gphoto2", {"rig/devices", "rig/cameras"}},
                                                          {"libserialport.h", {"rig/devices", "rig/turntables"}},
                                                          {"cairo.h", {"station/bench"}},
                                                          {"sqlite3.h", {"station/thread"}},
                                                          {"boost", {"station/serve"}},
                                                          {"CLI", {"station/commands"}}};
  for (const Include& include : includes())
    for (const auto& [library, rooms] : home)
      if (include.target == library || include.target.starts_with(library + "/"))
        EXPECT_TRUE(rooms.contains(room_of(include.file))) << include.file << " includes " << include.target;
}

TEST(Architecture, EverySourceLiesInARoom) {
  for (const std::string& folder : kFolders)
    for (const auto& entry : fs::directory_iterator(kRoot / folder)) {
      const std::string extension = entry.path().extension().string(), name = fs::relative(entry.path(), kRoot);
      EXPECT_TRUE((extension != ".h" && extension != ".cpp") || name == "station/main.cpp") << name;
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
