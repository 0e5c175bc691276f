// A strict reader of threadstation's JSON documents: every key is asked for, and an unknown one is an error that names
// it. Each kind of document has functions of the same names: parse_<kind> reads a document (`source` is the name that
// error messages give it), read_<kind> a file, and to_json makes the document.
//
// Errors: DocumentError for what a key says, std::runtime_error for the rest; one line: the file, the key (as a path
// such as "camera.width_px"), what was found and what is expected.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "station/documents/range.h"

namespace station {

// A key that is missing, unknown, or has no value that can be taken.
struct DocumentError : std::runtime_error {
  DocumentError(const std::string& what, std::string its_key, bool its_key_is_unknown = false)
      : std::runtime_error(what), key(std::move(its_key)), unknown(its_key_is_unknown) {}
  std::string key;  // its path: "camera_by_tape.aim_mm"
  bool unknown;
};

// Reads and parses a file, in which `//` begins a comment; the error for text that is not JSON tells line and column.
nlohmann::json read_json_file(const std::filesystem::path& file);

// Write a file whole or not at all, by store_file (disk/stored_file.h).
void write_json_file(const std::filesystem::path& file, const nlohmann::json& document);
void write_text_file(const std::filesystem::path& file, const std::string& text);

// One object of a document. Callers ask for its keys, then call finish(), which refuses keys that nobody asked for.
class ObjectReader {
 public:
  // Begins with a whole document, of which "format" must be "threadstation/<kind>". One of an earlier version is read
  // as the current one would be (migrations.h); one of a later version is refused.
  ObjectReader(const nlohmann::json& document, const std::string& source, const std::string& kind);

  bool has(const std::string& key) const;
  bool is_number(const std::string& key) const;  // false too where there is none
  ObjectReader object(const std::string& key);
  std::vector<ObjectReader> objects(const std::string& key);  // an array of objects

  std::string text(const std::string& key);
  std::string choice(const std::string& key, std::initializer_list<const char*> allowed);
  bool flag(const std::string& key);
  int integer(const std::string& key, int low, int high);
  double number(const std::string& key, double low, double high);
  double number(const std::string& key, Range range) { return number(key, range.low, range.high); }
  std::vector<double> numbers(const std::string& key);  // any number of finite numbers
  std::vector<double> numbers(const std::string& key, std::size_t count);
  std::vector<double> numbers(const std::string& key, std::size_t count, Range range);  // each in `range`
  Eigen::Vector3d vector3(const std::string& key);
  Eigen::Vector3d vector3(const std::string& key, Range range);
  Eigen::Isometry3d transform(const std::string& key);  // 4 x 4 row-major, rotation checked
  const nlohmann::json& raw(const std::string& key);    // the value as it is; lives as long as reader and document

  void finish() const;
  [[noreturn]] void refuse(const std::string& key, const std::string& found_and_expected) const;
  const std::string& source() const { return source_; }

 private:
  ObjectReader(std::shared_ptr<const nlohmann::json> document, const nlohmann::json& object, std::string source,
               std::string path);
  const nlohmann::json& value(const std::string& key);
  std::string full_name(const std::string& key) const;

  std::shared_ptr<const nlohmann::json> migrated_;  // the document, where it was of an earlier version
  const nlohmann::json* object_;
  std::string source_, path_;
  std::vector<std::string> asked_;
};

nlohmann::json to_json(const Eigen::Vector3d& v);
nlohmann::json to_json(const Eigen::Isometry3d& t);  // 4 x 4 row-major

}  // namespace station
