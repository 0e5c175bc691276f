#include "station/cloth/render/checkpoint.h"

#include <array>
#include <cstdio>
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

json head_of(const RenderIdentity& identity, const cv::Size& size) {
  json head = to_json(identity);
  head["format"] = kFormat;
  head["version"] = current_version(kKind);
  head["width_px"] = size.width;
  head["height_px"] = size.height;
  return head;
}

void store(const fs::path& file, const json& head, const std::vector<std::span<const std::byte>>& content) {
  const std::string line = head.dump() + "\n";
  std::vector<std::byte> bytes;
  const auto append = [&bytes](std::span<const std::byte> more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  };
  append(std::as_bytes(std::span(line)));
  for (const std::span<const std::byte> part : content) append(part);
  const std::string hash = sha256_hex(bytes);
  append(std::as_bytes(std::span(hash)));
  FileSystem disk;
  store_file(disk, file, bytes);
}

struct Stored {
  fs::path file;
  std::vector<std::byte> bytes;
  json head;
  std::span<const std::byte> content;
  bool whole = false;  // its hash is that of its bytes
};

// What a checkpoint or a part of it holds, if it is of this rendering.
Stored stored_in(const fs::path& file, const RenderIdentity& identity) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) refuse(file, "it is not a file");
  Stored stored{.file = file, .bytes = bytes_of_file(file)};
  const std::vector<std::byte>& bytes = stored.bytes;
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  const void* end_of_line = bytes.empty() ? nullptr : std::memchr(text, '\n', bytes.size());
  if (!end_of_line || bytes.size() < kHashDigits) refuse(file, "it is damaged");
  const auto start = static_cast<std::size_t>(static_cast<const char*>(end_of_line) - text) + 1;
  stored.head = json::parse(text, text + start, nullptr, false);
  const json& head = stored.head;
  if (!head.is_object() || head.value("format", json()) != kFormat) refuse(file, "it is not a checkpoint, or damaged");
  const json& version = head.value("version", json());
  if (version.is_number_integer() && version > current_version(kKind))
    throw std::runtime_error(later_version_problem(file.string(), kKind, version.get<int>()));
  if (version != current_version(kKind)) refuse(file, "it is of version " + version.dump());
  if (const auto other = difference(head, identity)) refuse(file, "it is of a rendering with " + *other);
  const std::size_t signed_size = bytes.size() - kHashDigits;
  stored.whole = signed_size >= start &&
                 sha256_hex(std::span(bytes).first(signed_size)) == std::string_view(text + signed_size, kHashDigits);
  if (stored.whole) stored.content = std::span(bytes).subspan(start, signed_size - start);
  return stored;
}

void read_planes(const Stored& stored, renderer::Film& film) {
  std::size_t size = 0;
  for (const std::span<std::byte> plane : planes(film)) size += plane.size();
  if (!stored.whole || stored.content.size() != size) refuse(stored.file, "it is damaged or cut short");
  const std::byte* from = stored.content.data();
  for (const std::span<std::byte> plane : planes(film)) {
    std::memcpy(plane.data(), from, plane.size());
    from += plane.size();
  }
}

// The goals of all tiles, which tell how far the pass was for those whose part is lost, and records of some tiles.
void read_part(const Stored& stored, renderer::Film& film) {
  constexpr std::size_t kRecord = sizeof(renderer::TileRecord);
  cv::Mat1i goals(film.goals.size());
  const std::size_t before = goals.total() * goals.elemSize();
  if (!stored.whole || stored.content.size() < before || (stored.content.size() - before) % kRecord != 0)
    refuse(stored.file, "it is damaged or cut short");
  std::memcpy(goals.data, stored.content.data(), before);
  film.goals = cv::max(film.goals, goals);
  for (std::size_t at = before; at < stored.content.size(); at += kRecord) {
    renderer::TileRecord record;
    std::memcpy(&record, stored.content.data() + at, kRecord);
    if (record.tile < 0 || record.tile >= film.goals.cols) refuse(stored.file, "it is damaged");
    renderer::put(record, film);
  }
}

// The parts that lie beside the picture.
std::vector<fs::path> parts_of(const fs::path& picture) {
  std::vector<fs::path> parts;
  const std::string begin = checkpoint_of(picture).filename().string() + ".";
  std::error_code none;
  const fs::path folder = picture.has_parent_path() ? picture.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, none), end; !none && entry != end; entry.increment(none)) {
    const std::string name = entry->path().filename().string();
    int number = 0, of = 0, read = 0;
    if (name.starts_with(begin) && std::sscanf(name.c_str() + begin.size(), "%dof%d%n", &number, &of, &read) == 2 &&
        begin.size() + static_cast<std::size_t>(read) == name.size())
      parts.push_back(entry->path());
  }
  return parts;
}

}  // namespace

fs::path checkpoint_of(const fs::path& picture) {
  return picture.string() + ".checkpoint";
}

fs::path part_of(const fs::path& picture, const renderer::TileShare& share) {
  return checkpoint_of(picture).string() + "." + std::to_string(share.number + 1) + "of" + std::to_string(share.of);
}

void store_checkpoint(const fs::path& file, const RenderIdentity& identity, const renderer::Film& film) {
  renderer::Film same = film;  // shares its planes
  const auto bytes = planes(same);
  store(file, head_of(identity, film.counts.size()), {bytes.begin(), bytes.end()});
}

void store_part(const fs::path& file, const RenderIdentity& identity, const renderer::Film& film,
                const renderer::TileShare& share) {
  json head = head_of(identity, film.counts.size());
  head["share"] = {share.number, share.of};
  std::vector<renderer::TileRecord> records;
  for (const int tile : renderer::tiles_in(share, film.goals.cols)) records.push_back(renderer::record_of(film, tile));
  renderer::Film same = film;
  store(file, head, {planes(same).back(), std::as_bytes(std::span(records))});
}

std::optional<renderer::Film> read_checkpoint(const fs::path& picture, const RenderIdentity& identity,
                                              const cv::Size& size) {
  std::error_code ignored;
  const fs::path whole = checkpoint_of(picture);
  const std::vector<fs::path> parts = parts_of(picture);
  if (!fs::exists(whole, ignored) && parts.empty()) return std::nullopt;
  renderer::Film film = renderer::empty_film(size.width, size.height);
  if (fs::exists(whole, ignored)) read_planes(stored_in(whole, identity), film);
  for (const fs::path& part : parts) read_part(stored_in(part, identity), film);
  return film;
}

bool has_parts(const fs::path& picture) {
  return !parts_of(picture).empty();
}

void remove_parts(const fs::path& picture) {
  std::error_code ignored;
  for (const fs::path& part : parts_of(picture)) fs::remove(part, ignored);
}

}  // namespace station
