// The journal of a session (journal.jsonl): what happened, one record per line, each on the disk before the next thing
// is done.
//
// A line has this form, so that another program can check it:
//   {"seq":3,"utc":"...","event":"picture","data":{...},"sha256":"<64 hexadecimal digits>"}
// - "seq" counts from 1 without a gap; "sha256" is the last key, and the line ends with one newline (byte 10);
// - the digits are the SHA-256 of the 64 digits of the line before (64 times '0' for the first line), followed by the
// bytes of this line up to and without `,"sha256":"`. A line that is edited, removed or moved breaks the chain.
//
// Opening a journal cuts off a torn last line (without its newline, or with another checksum): its record was never
// acknowledged. The cut is itself recorded, as the event "cut". A bad line before the last one is an error.
//
// Errors: std::runtime_error that names the file, the line where there is one, and what to do.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "rig/devices/clock.h"
#include "station/documents/disk/file_system.h"

namespace station {

struct JournalRecord {
  std::uint64_t seq = 0;
  std::string utc, event;
  nlohmann::json data;
  std::string sha256;
};

struct JournalText {
  std::vector<JournalRecord> records;
  std::uintmax_t good_bytes = 0;  // length of the whole records: where a torn tail begins
  std::uintmax_t torn_bytes = 0;  // 0: the journal ends with a whole record
};

// Reads a journal and changes nothing; a missing file is an empty journal.
JournalText read_journal(const std::filesystem::path& file);

class Journal {
 public:
  // The clock and the file system must outlive the journal.
  Journal(const std::filesystem::path& file, rig::Clock& clock, FileSystem& file_system);

  // Appends a record and returns when it is on the disk. After an error the journal ends as it did before. May be
  // called from any thread, as append_last may.
  void append(std::string_view event, const nlohmann::json& data);
  // Appends a record after which every further one is refused.
  void append_last(std::string_view event, const nlohmann::json& data);

  const std::vector<JournalRecord>& records() const { return records_; }

 private:
  void append_record(std::string_view event, const nlohmann::json& data);
  void write_line(const std::string& line);

  std::filesystem::path path_;
  rig::Clock* clock_;
  FileSystem* file_system_;
  OpenFile file_;
  std::uintmax_t size_ = 0;
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
  bool closed_ = false;
  bool broken_ = false;  // it is not known what stands on the disk
  std::vector<JournalRecord> records_;
};

}  // namespace station
