#include "station/cloth/render/checkpoint.h"

#include <array>
#include <cstring>
#include <span>
#include <stdexcept>
#include <vector>

#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/migrations.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kFormat = "threadstation/checkpoint";
constexpr const char* kKind = "checkpoint";  // the version is that of the film's numbers and what they mean
constexpr std::size_t kHashDigits = 64;

// The film's numbers, one plane after the other.
std::array<std::span<std::byte>, 4> planes(renderer::Film& film) {
  const auto bytes = [](cv::Mat& plane) {
    return std::span(reinterpret_cast<std::byte*>(plane.data), plane.total() * plane.elemSize());
  };
  return {bytes(film.sums), bytes(film.squares), bytes(film.counts), bytes(film.goals)};
}

[[noreturn]] void refuse(const fs::path& file, const std::string& found) {
  throw std::runtime_error("cannot go on from " + file.string() + ": " + found +
                           "; give --fresh to throw it away and begin again, or another --out");
}

}  // namespace

fs::path checkpoint_of(const fs::path& picture) {
  return picture.string() + ".checkpoint";
}

void store_checkpoint(const fs::path& file, const RenderIdentity& identity, const renderer::Film& film) {
  json head = to_json(identity);
  head["format"] = kFormat;
  head["version"] = current_version(kKind);
  head["width_px"] = film.counts.cols;
  head["height_px"] = film.counts.rows;
  const std::string line = head.dump() + "\n";
  std::vector<std::byte> bytes;
  const auto append = [&bytes](std::span<const std::byte> more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  };
  append(std::as_bytes(std::span(line)));
  renderer::Film same = film;  // shares its planes
  for (const std::span<std::byte> plane : planes(same)) append(plane);
  const std::string hash = sha256_hex(bytes);
  append(std::as_bytes(std::span(hash)));
  FileSystem disk;
  store_file(disk, file, bytes);
}

std::optional<renderer::Film> read_checkpoint(const fs::path& file, const RenderIdentity& identity,
                                              const cv::Size& picture) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return std::nullopt;
  if (!fs::is_regular_file(file, ignored)) refuse(file, "it is not a file");
  const std::vector<std::byte> bytes = bytes_of_file(file);
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  const void* end_of_line = std::memchr(text, '\n', bytes.size());
  if (!end_of_line || bytes.size() < kHashDigits) refuse(file, "it is damaged");
  const auto start = static_cast<std::size_t>(static_cast<const char*>(end_of_line) - text) + 1;
  const json head = json::parse(text, text + start, nullptr, false);
  if (!head.is_object() || head.value("format", json()) != kFormat) refuse(file, "it is not a checkpoint, or damaged");
  const json& version = head.value("version", json());
  if (version.is_number_integer() && version > current_version(kKind))
    throw std::runtime_error(later_version_problem(file.string(), kKind, version.get<int>()));
  if (version != current_version(kKind)) refuse(file, "it is of version " + version.dump());
  if (const auto other = difference(head, identity)) refuse(file, "it is of a rendering with " + *other);
  renderer::Film film = renderer::empty_film(picture.width, picture.height);
  std::size_t size = start + kHashDigits;
  for (const std::span<std::byte> plane : planes(film)) size += plane.size();
  const std::size_t signed_size = bytes.size() - kHashDigits;
  if (bytes.size() != size ||
      sha256_hex(std::span(bytes).first(signed_size)) != std::string_view(text + signed_size, kHashDigits))
    refuse(file, "it is damaged or cut short");
  const std::byte* from = bytes.data() + start;
  for (const std::span<std::byte> plane : planes(film)) {
    std::memcpy(plane.data(), from, plane.size());
    from += plane.size();
  }
  return film;
}

}  // namespace station
