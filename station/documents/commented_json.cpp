#include "station/documents/commented_json.h"

#include <regex>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "station/documents/disk/whole_file.h"

namespace station {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kCommentWidth = 100;  // of a line with a comment

std::vector<std::string> names_in(const std::string& cell) {
  static const std::regex kName("`([^`]+)`");
  std::vector<std::string> names;
  for (std::sregex_iterator it(cell.begin(), cell.end(), kName), end; it != end; ++it) names.push_back((*it)[1]);
  return names;
}

std::string without(std::string text, const std::string& what) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos;) text.erase(at, what.size());
  return text;
}

void write_comment(std::ostream& out, const std::string& indent, const std::string& meaning) {
  std::istringstream words(meaning);
  std::string line = indent + "//";
  for (std::string word; words >> word; line += " " + word) {
    if (line.size() + word.size() < kCommentWidth) continue;
    out << line << "\n";
    line = indent + "//";
  }
  out << line << "\n";
}

void write_value(std::ostream& out, const ordered_json& value, const KeyMeanings& meanings, const std::string& path,
                 const std::string& indent);

void write_list(std::ostream& out, const ordered_json& list, const KeyMeanings& meanings, const std::string& path,
                const std::string& indent) {
  out << "[";
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (i > 0) out << ", ";
    write_value(out, list[i], meanings, path, indent);
  }
  out << "]";
}

void write_object(std::ostream& out, const ordered_json& object, const KeyMeanings& meanings, const std::string& path,
                  const std::string& indent) {
  const std::string inner = indent + "  ";
  const char* before = "{\n";
  for (const auto& [key, value] : object.items()) {
    const std::string here = path.empty() ? key : path + "." + key;
    out << before;
    if (const auto meaning = meanings.find(here); meaning != meanings.end()) write_comment(out, inner, meaning->second);
    out << inner << ordered_json(key).dump() << ": ";
    write_value(out, value, meanings, here, inner);
    before = ",\n";
  }
  out << "\n" << indent << "}";
}

void write_value(std::ostream& out, const ordered_json& value, const KeyMeanings& meanings, const std::string& path,
                 const std::string& indent) {
  if (value.is_object() && !value.empty()) return write_object(out, value, meanings, path, indent);
  if (value.is_array()) return write_list(out, value, meanings, path, indent);
  out << value.dump();
}

}  // namespace

KeyMeanings read_key_meanings(const std::filesystem::path& readme) {
  std::istringstream lines(text_of_file(readme));
  KeyMeanings meanings;
  std::string parent;
  bool in_table = false;
  for (std::string line; std::getline(lines, line);) {
    in_table = in_table || line.starts_with("| key | meaning |");
    const std::size_t middle = line.find("` | ");
    if (!in_table || !line.starts_with("| `") || middle == std::string::npos) continue;
    const std::string meaning = without(line.substr(middle + 4, line.rfind(" |") - middle - 4), "`");
    const std::vector<std::string> names = names_in(line.substr(0, middle + 1));
    std::string folder;  // of the further names of this row
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool inside = names[i].starts_with("...");
      std::string name = inside ? parent + "." + names[i].substr(3) : i == 0 ? names[i] : folder + names[i];
      if (i == 0) {
        const std::size_t dot = name.rfind('.');
        folder = dot == std::string::npos ? "" : name.substr(0, dot + 1);
        if (!inside) parent = name;
      }
      meanings[name] = meaning;
    }
  }
  if (meanings.empty()) throw std::runtime_error(readme.string() + ": found no table of keys; install it anew");
  return meanings;
}

std::string commented_json(const ordered_json& document, const KeyMeanings& meanings) {
  std::ostringstream out;
  write_value(out, document, meanings, "", "");
  out << "\n";
  return out.str();
}

}  // namespace station
