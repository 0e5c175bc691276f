#include "station/session/record/journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <optional>
#include <stdexcept>
#include <system_error>

#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/disk/whole_file.h"

namespace station {
namespace {

using nlohmann::json;
constexpr std::string_view kChecksumKey = R"(,"sha256":")";
constexpr std::string_view kLineEnd = "\"}";
constexpr std::size_t kDigits = 64;
constexpr std::size_t kEndSize = kChecksumKey.size() + kDigits + kLineEnd.size();

std::string first_link() {
  return std::string(kDigits, '0');
}

// The digits of a line whose checksum holds. `line` is without its newline.
std::optional<std::string> checked_digits(std::string_view line, const std::string& previous) {
  if (line.size() <= kEndSize || !line.ends_with(kLineEnd)) return std::nullopt;
  const std::string_view content = line.substr(0, line.size() - kEndSize);
  const std::string_view end = line.substr(content.size());
  const std::string digits(end.substr(kChecksumKey.size(), kDigits));
  const bool holds = end.starts_with(kChecksumKey) && sha256_hex(previous + std::string(content)) == digits;
  return holds ? std::optional(digits) : std::nullopt;
}

JournalRecord parse_record(std::string_view line, const std::string& digits) {
  const json document = json::parse(line);
  return {.seq = document.at("seq").get<std::uint64_t>(),
          .utc = document.at("utc").get<std::string>(),
          .event = document.at("event").get<std::string>(),
          .data = document.at("data"),
          .sha256 = digits};
}

std::runtime_error bad_line(const std::filesystem::path& file, std::size_t number, const std::string& found) {
  return std::runtime_error("'" + file.string() + "' line " + std::to_string(number) + " " + found +
                            "; the journal was changed after it was written: restore it from a copy");
}

JournalRecord checked_record(std::string_view line, const std::string& digits, std::size_t number,
                             const std::filesystem::path& file) {
  try {
    JournalRecord record = parse_record(line, digits);
    if (record.seq != number) throw bad_line(file, number, "counts " + std::to_string(record.seq));
    return record;
  } catch (const json::exception&) {
    throw bad_line(file, number, "is not a record");
  }
}

std::string line_content(const JournalRecord& record) {
  nlohmann::ordered_json document;
  document["seq"] = record.seq;
  document["utc"] = record.utc;
  document["event"] = record.event;
  document["data"] = record.data;
  // Messages of devices may hold any bytes: those that are no UTF-8 are replaced rather than losing the record.
  std::string text = document.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  text.pop_back();
  return text;
}

}  // namespace

JournalText read_journal(const std::filesystem::path& file) {
  const std::string text = std::filesystem::exists(file) ? text_of_file(file) : "";
  JournalText journal;
  std::string previous = first_link();
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t number = journal.records.size() + 1;
    const std::size_t end = text.find('\n', begin);
    const bool last = end == std::string::npos || end + 1 == text.size();
    const std::string_view line = std::string_view(text).substr(begin, end == std::string::npos ? end : end - begin);
    const std::optional<std::string> digits = checked_digits(line, previous);
    if (last && (end == std::string::npos || !digits)) {
      journal.torn_bytes = text.size() - begin;
      break;
    }
    if (!digits) throw bad_line(file, number, "does not match its checksum");
    journal.records.push_back(checked_record(line, *digits, number, file));
    previous = *digits;
    begin = end + 1;
    journal.good_bytes = begin;
  }
  return journal;
}

Journal::Journal(const std::filesystem::path& file, rig::Clock& clock, FileSystem& file_system)
    : path_(file), clock_(&clock), file_system_(&file_system) {
  JournalText text = read_journal(file);
  records_ = std::move(text.records);
  size_ = text.good_bytes;
  try {
    file_ = file_system.open(file, O_WRONLY | O_CREAT | O_APPEND);
    file_system.sync_folder(file.parent_path());
  } catch (const std::system_error& error) {
    throw std::runtime_error(write_problem(file, error.code()));
  }
  if (text.torn_bytes > 0) {
    if (::ftruncate(file_.descriptor(), static_cast<off_t>(size_)) != 0)
      throw std::runtime_error(write_problem(file, std::error_code(errno, std::generic_category())));
    append("cut", {{"bytes", text.torn_bytes}, {"after_line", records_.size()}});
  }
}

void Journal::append(std::string_view event, const json& data) {
  const std::lock_guard lock(*mutex_);
  append_record(event, data);
}

void Journal::append_last(std::string_view event, const json& data) {
  const std::lock_guard lock(*mutex_);
  append_record(event, data);
  closed_ = true;
}

void Journal::append_record(std::string_view event, const json& data) {
  if (closed_) throw std::runtime_error("'" + path_.string() + "' was ended by a stop at once; resume the session");
  JournalRecord record{
      .seq = records_.size() + 1, .utc = clock_->utc(), .event = std::string(event), .data = data, .sha256 = {}};
  const std::string content = line_content(record);
  record.sha256 = sha256_hex((records_.empty() ? first_link() : records_.back().sha256) + content);
  write_line(content + std::string(kChecksumKey) + record.sha256 + std::string(kLineEnd) + "\n");
  records_.push_back(std::move(record));
}

void Journal::write_line(const std::string& line) {
  if (broken_) {
    throw std::runtime_error("'" + path_.string() +
                             "' could not be written before; free or check its disk, then resume");
  }
  try {
    file_system_->write(file_, std::as_bytes(std::span(line)));
    file_system_->sync(file_);
    size_ += line.size();
  } catch (const std::system_error& error) {
    // After a failed fsync the pages may be gone or may reach the disk later, so only a fresh opening can tell.
    const bool cut = ::ftruncate(file_.descriptor(), static_cast<off_t>(size_)) == 0;
    broken_ = !cut || error.code() == std::errc::io_error;
    throw std::runtime_error(write_problem(path_, error.code()));
  }
}

}  // namespace station
