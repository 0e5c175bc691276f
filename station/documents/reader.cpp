#include "station/documents/reader.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "station/documents/disk/shown_text.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/migrations.h"

namespace station {
namespace {

using nlohmann::json;

std::string quoted_list(std::initializer_list<const char*> words) {
  std::string all;
  for (const char* word : words) all += (all.empty() ? "" : ", ") + std::string("\"") + word + "\"";
  return all;
}

std::string shown(const json& value) {
  return shown_text(value.dump(), 60);
}

std::string text_of(Range range) {
  return "from " + json(range.low).dump() + " to " + json(range.high).dump();
}

}  // namespace

json read_json_file(const std::filesystem::path& file) {
  const std::string text = text_of_file(file);
  try {
    return json::parse(text, nullptr, true, true);
  } catch (const json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    const auto line = 1 + std::count(text.begin(), end, '\n');
    const bool cut = error.byte > text.size();
    throw std::runtime_error(file.string() + ": not valid JSON at line " + std::to_string(line) +
                             (cut ? ": the file ends too early (cut short?)" : ": unexpected text") +
                             "; restore or correct the file");
  }
}

void write_text_file(const std::filesystem::path& file, const std::string& text) {
  FileSystem disk;
  store_file(disk, file, std::as_bytes(std::span(text)));
}

void write_json_file(const std::filesystem::path& file, const json& document) {
  write_text_file(file, document.dump(2) + "\n");
}

ObjectReader::ObjectReader(const json& document, const std::string& source, const std::string& kind)
    : object_(&document), source_(source) {
  if (!document.is_object())
    throw std::runtime_error(source + ": found " + shown(document) + ", expected a JSON object");
  const std::string wanted = "threadstation/" + kind;
  const std::string format = has("format") ? text("format") : std::string("no \"format\" key");
  if (format != wanted)
    throw std::runtime_error(source + ": expected a \"" + wanted + "\" document, found " + format + "; give a " + kind +
                             " file here");
  const int version = integer("version", 1, 1 << 30);
  if (version > current_version(kind)) throw std::runtime_error(later_version_problem(source, kind, version));
  if (version == current_version(kind)) return;
  migrated_ = std::make_shared<const json>(migrated(document, kind, version));
  object_ = migrated_.get();
}

ObjectReader::ObjectReader(std::shared_ptr<const json> document, const json& object, std::string source,
                           std::string path)
    : migrated_(std::move(document)), object_(&object), source_(std::move(source)), path_(std::move(path)) {}

std::string ObjectReader::full_name(const std::string& key) const {
  return path_.empty() ? key : path_ + "." + key;
}

void ObjectReader::refuse(const std::string& key, const std::string& found_and_expected) const {
  throw DocumentError(source_ + ": key \"" + full_name(key) + "\": " + found_and_expected, full_name(key));
}

bool ObjectReader::has(const std::string& key) const {
  return object_->contains(key);
}

bool ObjectReader::is_number(const std::string& key) const {
  return has(key) && object_->at(key).is_number();
}

const json& ObjectReader::value(const std::string& key) {
  asked_.push_back(key);
  if (!object_->contains(key)) refuse(key, "is missing; add it");
  return object_->at(key);
}

ObjectReader ObjectReader::object(const std::string& key) {
  const json& found = value(key);
  if (!found.is_object()) refuse(key, "found " + shown(found) + ", expected an object");
  return ObjectReader(migrated_, found, source_, full_name(key));
}

std::vector<ObjectReader> ObjectReader::objects(const std::string& key) {
  const json& found = value(key);
  if (!found.is_array()) refuse(key, "found " + shown(found) + ", expected a list of objects");
  std::vector<ObjectReader> list;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::string name = key + "[" + std::to_string(i) + "]";
    if (!found[i].is_object()) refuse(name, "found " + shown(found[i]) + ", expected an object");
    list.push_back(ObjectReader(migrated_, found[i], source_, full_name(name)));
  }
  return list;
}

std::string ObjectReader::text(const std::string& key) {
  const json& found = value(key);
  if (!found.is_string()) refuse(key, "found " + shown(found) + ", expected text");
  return found.get<std::string>();
}

std::string ObjectReader::choice(const std::string& key, std::initializer_list<const char*> allowed) {
  const std::string found = text(key);
  if (std::find(allowed.begin(), allowed.end(), found) == allowed.end())
    refuse(key, "found \"" + found + "\", expected one of " + quoted_list(allowed));
  return found;
}

bool ObjectReader::flag(const std::string& key) {
  const json& found = value(key);
  if (!found.is_boolean()) refuse(key, "found " + shown(found) + ", expected true or false");
  return found.get<bool>();
}

int ObjectReader::integer(const std::string& key, int low, int high) {
  const json& found = value(key);
  const std::string range = "expected a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  if (!found.is_number_integer()) refuse(key, "found " + shown(found) + ", " + range);
  const bool too_big = found.is_number_unsigned() && found.get<std::uint64_t>() > static_cast<std::uint64_t>(1) << 60;
  const auto number = too_big ? std::int64_t{1} << 60 : found.get<std::int64_t>();
  if (number < low || number > high) refuse(key, "found " + shown(found) + ", " + range);
  return static_cast<int>(number);
}

double ObjectReader::number(const std::string& key, double low, double high) {
  const json& found = value(key);
  const std::string range = "expected a number " + text_of({low, high});
  if (!found.is_number()) refuse(key, "found " + shown(found) + ", " + range);
  const double number = found.get<double>();
  if (!(number >= low && number <= high)) refuse(key, "found " + shown(found) + ", " + range);
  return number;
}

std::vector<double> ObjectReader::numbers(const std::string& key) {
  const json& found = value(key);
  const auto finite = [](const json& v) { return v.is_number() && std::isfinite(v.get<double>()); };
  if (!found.is_array() || !std::all_of(found.begin(), found.end(), finite))
    refuse(key, "found " + shown(found) + ", expected a list of numbers");
  return found.get<std::vector<double>>();
}

std::vector<double> ObjectReader::numbers(const std::string& key, std::size_t count) {
  std::vector<double> list = numbers(key);
  if (list.size() != count)
    refuse(key, "found " + std::to_string(list.size()) + " numbers, expected " + std::to_string(count));
  return list;
}

std::vector<double> ObjectReader::numbers(const std::string& key, std::size_t count, Range range) {
  std::vector<double> list = numbers(key, count);
  for (double number : list)
    if (!(number >= range.low && number <= range.high))
      refuse(key, "found " + json(number).dump() + ", expected numbers " + text_of(range));
  return list;
}

Eigen::Vector3d ObjectReader::vector3(const std::string& key) {
  const std::vector<double> v = numbers(key, 3);
  return {v[0], v[1], v[2]};
}

Eigen::Vector3d ObjectReader::vector3(const std::string& key, Range range) {
  const std::vector<double> v = numbers(key, 3, range);
  return {v[0], v[1], v[2]};
}

Eigen::Isometry3d ObjectReader::transform(const std::string& key) {
  const json& found = value(key);
  Eigen::Matrix4d matrix;
  const std::string expected = "expected a 4 x 4 rigid transform (rows, millimetres)";
  if (!found.is_array() || found.size() != 4) refuse(key, expected);
  for (int row = 0; row < 4; ++row) {
    const json& line = found[static_cast<std::size_t>(row)];
    if (!line.is_array() || line.size() != 4) refuse(key, expected);
    for (int column = 0; column < 4; ++column) {
      const json& entry = line[static_cast<std::size_t>(column)];
      if (!entry.is_number() || !std::isfinite(entry.get<double>())) refuse(key, expected);
      matrix(row, column) = entry.get<double>();
    }
  }
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  // Twelve printed digits pass the limit of 1e-6; a scaled or mirrored matrix does not.
  if ((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-6 || rotation.determinant() < 0 ||
      (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() > 0)
    refuse(key, "is not a rigid transform; " + expected);
  return Eigen::Isometry3d(matrix);
}

const json& ObjectReader::raw(const std::string& key) {
  return value(key);
}

void ObjectReader::finish() const {
  for (const auto& [key, unused] : object_->items())
    if (std::find(asked_.begin(), asked_.end(), key) == asked_.end())
      throw DocumentError(source_ + ": unknown key \"" + full_name(key) + "\"; remove it or check its spelling",
                          full_name(key), true);
}

json to_json(const Eigen::Vector3d& v) {
  return json::array({v.x(), v.y(), v.z()});
}

json to_json(const Eigen::Isometry3d& t) {
  json rows = json::array();
  for (int row = 0; row < 4; ++row)
    rows.push_back({t.matrix()(row, 0), t.matrix()(row, 1), t.matrix()(row, 2), t.matrix()(row, 3)});
  return rows;
}

}  // namespace station
