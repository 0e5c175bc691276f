#include "station/thread/library.h"

#include <sqlite3.h>

#include <algorithm>
#include <functional>
#include <sstream>
#include <stdexcept>

#include "station/documents/disk/new_folder.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/manifest.h"
#include "station/documents/number_text.h"
#include "station/documents/session_file.h"
#include "station/documents/thread_file.h"
#include "station/session/record/session_folder.h"
#include "station/thread/thread_colour.h"

namespace station {
namespace fs = std::filesystem;
namespace {

constexpr int kVersion = 4;
constexpr const char* kTables = R"(
CREATE TABLE IF NOT EXISTS spools (id INTEGER PRIMARY KEY, barcode TEXT NOT NULL, name TEXT NOT NULL, lot TEXT NOT NULL,
  material TEXT NOT NULL, colour TEXT NOT NULL, note TEXT NOT NULL, UNIQUE (barcode, name, lot));
CREATE TABLE IF NOT EXISTS sessions (id INTEGER PRIMARY KEY, spool INTEGER NOT NULL REFERENCES spools (id),
  folder TEXT NOT NULL, utc TEXT NOT NULL, UNIQUE (folder, utc));
CREATE TABLE IF NOT EXISTS threads (id INTEGER PRIMARY KEY AUTOINCREMENT, spool INTEGER NOT NULL REFERENCES spools (id),
  session INTEGER REFERENCES sessions (id), name TEXT NOT NULL, sha256 TEXT NOT NULL UNIQUE, added_utc TEXT NOT NULL,
  diameter_mm REAL NOT NULL, relative_rmse REAL);
)";
// What versions 2, 3 and 4 added.
constexpr const char* kRemoved = "ALTER TABLE threads ADD COLUMN removed_utc TEXT";
constexpr const char* kTags = "ALTER TABLE threads ADD COLUMN tags TEXT NOT NULL DEFAULT ''";  // parted by ", "
constexpr const char* kMeasures =
    "ALTER TABLE threads ADD COLUMN lab_l REAL; ALTER TABLE threads ADD COLUMN lab_a REAL; "
    "ALTER TABLE threads ADD COLUMN lab_b REAL; ALTER TABLE threads ADD COLUMN highlight_rad REAL";
constexpr const char* kSelect =
    "SELECT threads.id, barcode, spools.name, lot, material, colour, note, threads.name, added_utc, sha256, "
    "coalesce(sessions.folder, ''), coalesce(sessions.utc, ''), relative_rmse, diameter_mm, "
    "tags, lab_l, lab_a, lab_b, highlight_rad "
    "FROM threads JOIN spools ON spools.id = threads.spool LEFT JOIN sessions ON sessions.id = threads.session ";

}  // namespace

// The SQLite connection; each SQL statement is one call.
class Library::Index {
 public:
  using Row = std::function<void(sqlite3_stmt*)>;

  explicit Index(const fs::path& file) : file_(file) {
    if (sqlite3_open_v2(file.c_str(), &db_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr) != SQLITE_OK) fail();
    sqlite3_busy_timeout(db_, 5000);
    int version = 0;
    run("PRAGMA user_version", {}, [&](sqlite3_stmt* row) { version = sqlite3_column_int(row, 0); });
    if (version > kVersion)
      throw std::runtime_error("'" + file.string() + "': made by a later threadstation: library version " +
                               std::to_string(version) + ", this one reads up to version " + std::to_string(kVersion) +
                               "; install the later one");
    run("PRAGMA foreign_keys = ON", {});
    run("PRAGMA synchronous = FULL", {});
    if (version == kVersion) return;
    execute("BEGIN IMMEDIATE");  // two programs may open it at once
    run("PRAGMA user_version", {}, [&](sqlite3_stmt* row) { version = sqlite3_column_int(row, 0); });
    if (version < 2) {
      execute(kTables);
      execute(kRemoved);
    }
    if (version < 3) execute(kTags);
    if (version < 4) execute(kMeasures);
    if (version < kVersion) execute(("PRAGMA user_version = " + std::to_string(kVersion)).c_str());
    execute("COMMIT");
  }
  ~Index() { sqlite3_close(db_); }
  Index(const Index&) = delete;
  Index& operator=(const Index&) = delete;

  void execute(const char* sql) {
    if (sqlite3_exec(db_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }

  void run(const std::string& sql, const std::vector<std::string>& values, const Row& each = {}) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(db_, sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) fail();
    const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> owner(statement, sqlite3_finalize);
    int at = 0;
    for (const std::string& value : values)
      sqlite3_bind_text(statement, ++at, value.c_str(), static_cast<int>(value.size()), SQLITE_TRANSIENT);
    int result = SQLITE_ROW;
    while ((result = sqlite3_step(statement)) == SQLITE_ROW)
      if (each) each(statement);
    if (result != SQLITE_DONE) fail();
  }

  // The id of a row that is made now unless it is there already.
  std::string id_of(const std::string& insert, const std::string& select, const std::vector<std::string>& all,
                    const std::vector<std::string>& key) {
    run(insert, all);
    std::string id;
    run(select, key, [&](sqlite3_stmt* row) { id = text(row, 0); });
    return id;
  }

  // The id of the row of a spool: one barcode, name and lot.
  std::string spool_of(const Sample& sample) {
    return id_of("INSERT OR IGNORE INTO spools (barcode, name, lot, material, colour, note) VALUES (?, ?, ?, ?, ?, ?)",
                 "SELECT id FROM spools WHERE barcode = ? AND name = ? AND lot = ?",
                 {sample.barcode, sample.name, sample.lot, sample.material, sample.colour, sample.note},
                 {sample.barcode, sample.name, sample.lot});
  }

  // What of a thread is looked for by number.
  void measure(int number, const ThreadFile& thread) {
    const Eigen::Vector3d lab = colour_of(thread).lab;
    run("UPDATE threads SET lab_l = CAST(? AS REAL), lab_a = CAST(? AS REAL), lab_b = CAST(? AS REAL), "
        "highlight_rad = CAST(? AS REAL) WHERE id = CAST(? AS INTEGER)",
        {shortest_text(lab[0]), shortest_text(lab[1]), shortest_text(lab[2]), shortest_text(thread.parameters.alpha[0]),
         std::to_string(number)});
  }

  static std::string text(sqlite3_stmt* row, int column) {
    const auto* value = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
    return value == nullptr ? "" : value;
  }

  [[noreturn]] void fail() const {
    throw std::runtime_error("the library's index '" + file_.string() + "': " + sqlite3_errmsg(db_) +
                             "; check the folder and its disk, or restore the file from a copy");
  }

 private:
  fs::path file_;
  sqlite3* db_ = nullptr;
};

namespace {

LibraryThread thread_of(sqlite3_stmt* row, const std::function<std::string(sqlite3_stmt*, int)>& text) {
  LibraryThread thread{.number = sqlite3_column_int(row, 0),
                       .sample = {.barcode = text(row, 1),
                                  .name = text(row, 2),
                                  .lot = text(row, 3),
                                  .material = text(row, 4),
                                  .colour = text(row, 5),
                                  .note = text(row, 6)},
                       .thread_name = text(row, 7),
                       .added_utc = text(row, 8),
                       .sha256 = text(row, 9),
                       .session = text(row, 10),
                       .session_utc = text(row, 11),
                       .relative_rmse = std::nullopt,
                       .diameter_mm = sqlite3_column_double(row, 13),
                       .tags = tags_of(text(row, 14))};
  const auto number = [row](int column) {
    return sqlite3_column_type(row, column) == SQLITE_NULL ? std::nullopt
                                                           : std::optional(sqlite3_column_double(row, column));
  };
  thread.relative_rmse = number(12);
  if (const auto l = number(15)) thread.lab = Eigen::Vector3d(*l, *number(16), *number(17));
  thread.highlight_rad = number(18);
  return thread;
}

// The condition of a query, with a ? for each of `values`.
std::string condition_of(const LibraryQuery& query, std::vector<std::string>& values) {
  std::string condition = "WHERE removed_utc IS NULL";
  std::istringstream words(query.words);
  for (std::string word; words >> word;) {
    condition +=
        " AND instr(lower(barcode || ' ' || spools.name || ' ' || lot || ' ' || material || ' ' || colour || ' ' || "
        "note || ' ' || threads.name || ' ' || tags), lower(?)) > 0";
    values.push_back(word);
  }
  const auto between = [&](const char* column, const std::optional<std::array<double, 2>>& range) {
    if (!range) return;
    condition += std::string(" AND ") + column + " BETWEEN CAST(? AS REAL) AND CAST(? AS REAL)";
    for (const double end : *range) values.push_back(shortest_text(end));
  };
  between("diameter_mm", query.diameter_mm);
  between("highlight_rad", query.highlight_rad);
  between("relative_rmse", query.relative_rmse);
  return condition;
}

}  // namespace

std::vector<std::string> tags_of(const std::string& text) {
  constexpr std::size_t kMost = 20, kLongest = 40;
  constexpr const char* kBlank = " \t\r\n";
  std::vector<std::string> tags;
  std::istringstream parts(text);
  for (std::string tag; std::getline(parts, tag, ',');) {
    const std::size_t begin = tag.find_first_not_of(kBlank);
    if (begin == std::string::npos) continue;
    tag = tag.substr(begin, tag.find_last_not_of(kBlank) - begin + 1);
    if (tag.size() > kLongest)
      throw std::runtime_error("the tag '" + tag + "' is longer than 40 characters; tags are short, parted by commas");
    if (std::ranges::find(tags, tag) == tags.end()) tags.push_back(tag);
  }
  if (tags.size() > kMost)
    throw std::runtime_error("a thread was to have " + std::to_string(tags.size()) + " tags; give at most 20");
  return tags;
}

Library::Library(const fs::path& folder, bool make) : folder_(folder) {
  const fs::path file = folder / "index.sqlite";
  if (!fs::exists(file)) {
    if (!make)
      throw std::runtime_error("'" + folder.string() +
                               "' is no library (it has no index.sqlite); check --library, or add a thread first");
    std::error_code code;
    if (fs::exists(folder) && !fs::is_empty(folder, code))
      throw std::runtime_error("'" + folder.string() + "' holds other files; choose a new or empty folder");
    fs::create_directories(folder / "threads", code);
    if (code) throw std::runtime_error(write_problem(folder, code));
  }
  index_ = std::make_unique<Index>(file);
}

Library::~Library() = default;

fs::path Library::thread_file(int number) const {
  return folder_ / "threads" / (std::to_string(number) + ".json");
}

LibraryThread Library::add(const fs::path& session_or_thread, const std::string& utc) {
  const bool from_session = is_session(session_or_thread);
  const fs::path file = from_session ? session_or_thread / "result" / "thread.json" : session_or_thread;
  if (from_session && !fs::exists(file))
    throw std::runtime_error("the session '" + session_or_thread.string() +
                             "' has no result/thread.json; fit it with threadstation invert first");
  const ThreadFile thread = read_thread(file);
  const std::string content = text_of_file(file), sha256 = sha256_hex(content);
  int there = 0, taken_out = 0;
  index_->run("SELECT id, removed_utc IS NOT NULL FROM threads WHERE sha256 = ?", {sha256}, [&](sqlite3_stmt* row) {
    (sqlite3_column_int(row, 1) != 0 ? taken_out : there) = sqlite3_column_int(row, 0);
  });
  if (there > 0)
    throw std::runtime_error("'" + file.string() + "' is in the library already, as number " + std::to_string(there));
  if (taken_out > 0)
    throw std::runtime_error("'" + file.string() + "' was taken out of the library, as number " +
                             std::to_string(taken_out) + "; put it back with threadstation library restore " +
                             std::to_string(taken_out));
  Sample sample{.barcode = {}, .name = thread.name, .lot = {}, .material = {}, .colour = {}, .note = {}};
  std::string session_utc;
  if (from_session) {
    const SessionFile session = read_session_file(session_or_thread);
    session_utc = session.utc;
    if (session.sample) sample = *session.sample;
    if (sample.name.empty()) sample.name = session.spool.name;
    if (sample.material.empty()) sample.material = session.spool.material;
  }
  int number = 0;
  index_->execute("BEGIN IMMEDIATE");
  try {
    const std::string spool = index_->spool_of(sample);
    std::string session;
    if (from_session) {
      const std::string place = fs::absolute(session_or_thread).lexically_normal().string();
      session = index_->id_of("INSERT OR IGNORE INTO sessions (spool, folder, utc) VALUES (?, ?, ?)",
                              "SELECT id FROM sessions WHERE folder = ? AND utc = ?", {spool, place, session_utc},
                              {place, session_utc});
    }
    const std::string rmse =
        thread.fit.contains("relative_rmse") ? nlohmann::json(thread.fit.at("relative_rmse")).dump() : "";
    index_->run(
        "INSERT INTO threads (spool, session, name, sha256, added_utc, diameter_mm, relative_rmse) VALUES "
        "(?, nullif(?, ''), ?, ?, ?, CAST(? AS REAL), CAST(nullif(?, '') AS REAL))",
        {spool, session, thread.name, sha256, utc, nlohmann::json(thread.diameter_mm).dump(), rmse});
    index_->run("SELECT id FROM threads WHERE sha256 = ?", {sha256},
                [&](sqlite3_stmt* row) { number = sqlite3_column_int(row, 0); });
    index_->measure(number, thread);
    FileSystem disk;
    store_file(disk, thread_file(number), std::as_bytes(std::span(content)));
    index_->execute("COMMIT");
  } catch (...) {
    index_->run("ROLLBACK", {});
    throw;
  }
  return show(number);
}

void Library::measure_all() const {
  std::vector<int> numbers;
  index_->run("SELECT id FROM threads WHERE lab_l IS NULL AND removed_utc IS NULL", {},
              [&](sqlite3_stmt* row) { numbers.push_back(sqlite3_column_int(row, 0)); });
  if (numbers.empty()) return;
  std::vector<std::pair<int, ThreadFile>> threads;
  for (const int number : numbers) {
    try {
      threads.emplace_back(number, read_thread(thread_file(number)));
    } catch (const std::runtime_error&) {
      // Its file is told of by whoever needs it; it is not found by its colour.
    }
  }
  index_->execute("BEGIN IMMEDIATE");
  try {
    for (const auto& [number, thread] : threads) index_->measure(number, thread);
    index_->execute("COMMIT");
  } catch (...) {
    index_->run("ROLLBACK", {});
    throw;
  }
}

std::vector<LibraryThread> Library::find(const LibraryQuery& query) const {
  if (query.near_lab || query.highlight_rad) measure_all();
  std::vector<LibraryThread> threads;
  std::vector<std::string> values;
  const std::string condition = condition_of(query, values);
  if (!query.near_lab) {
    const std::string most = query.most > 0 ? " LIMIT " + std::to_string(query.most) : "";
    index_->run(kSelect + condition + " ORDER BY threads.id" + most, values,
                [&](sqlite3_stmt* row) { threads.push_back(thread_of(row, Index::text)); });
    return threads;
  }
  std::vector<std::pair<double, int>> near;  // with their numbers
  index_->run("SELECT threads.id, lab_l, lab_a, lab_b FROM threads JOIN spools ON spools.id = threads.spool " +
                  condition + " AND lab_l IS NOT NULL",
              values, [&](sqlite3_stmt* row) {
                const Eigen::Vector3d lab(sqlite3_column_double(row, 1), sqlite3_column_double(row, 2),
                                          sqlite3_column_double(row, 3));
                const double distance = (lab - *query.near_lab).norm();
                if (distance <= query.within) near.emplace_back(distance, sqlite3_column_int(row, 0));
              });
  std::ranges::sort(near);
  if (query.most > 0 && near.size() > static_cast<std::size_t>(query.most))
    near.resize(static_cast<std::size_t>(query.most));
  for (const auto& [distance, number] : near) {
    threads.push_back(show(number));
    threads.back().distance = distance;
  }
  return threads;
}

LibraryThread Library::show(int number) const {
  std::optional<LibraryThread> thread;
  index_->run(std::string(kSelect) + "WHERE threads.id = CAST(? AS INTEGER)", {std::to_string(number)},
              [&](sqlite3_stmt* row) { thread = thread_of(row, Index::text); });
  if (!thread)
    throw std::runtime_error("the library '" + folder_.string() + "' has no thread number " + std::to_string(number) +
                             "; see threadstation library list");
  return *thread;
}

LibraryThread Library::edit(int number, const Sample& sample) {
  show(number);
  if (sample.name.empty() && sample.barcode.empty())
    throw std::runtime_error("thread number " + std::to_string(number) +
                             " was to have neither name nor barcode; give one of them");
  index_->execute("BEGIN IMMEDIATE");
  try {
    const std::string spool = index_->spool_of(sample);
    index_->run("UPDATE spools SET material = ?, colour = ?, note = ? WHERE id = ?",
                {sample.material, sample.colour, sample.note, spool});
    index_->run("UPDATE threads SET spool = ? WHERE id = CAST(? AS INTEGER)", {spool, std::to_string(number)});
    index_->execute("COMMIT");
  } catch (...) {
    index_->run("ROLLBACK", {});
    throw;
  }
  return show(number);
}

LibraryThread Library::tag(int number, const std::vector<std::string>& tags) {
  show(number);
  std::string text;
  for (const std::string& tag : tags) text += (text.empty() ? "" : ", ") + tag;
  index_->run("UPDATE threads SET tags = ? WHERE id = CAST(? AS INTEGER)", {text, std::to_string(number)});
  return show(number);
}

void Library::remove(int number, const std::string& utc) {
  set_removed(number, utc);
}

void Library::restore(int number) {
  set_removed(number, "");
}

void Library::set_removed(int number, const std::string& utc) {
  const std::string id = std::to_string(number);
  show(number);
  bool out = false;
  index_->run("SELECT removed_utc IS NOT NULL FROM threads WHERE id = CAST(? AS INTEGER)", {id},
              [&](sqlite3_stmt* row) { out = sqlite3_column_int(row, 0) != 0; });
  if (out == !utc.empty())
    throw std::runtime_error("thread number " + id + " is " + (out ? "out of" : "in") + " the library '" +
                             folder_.string() + "' already; see threadstation library list");
  index_->run("UPDATE threads SET removed_utc = nullif(?, '') WHERE id = CAST(? AS INTEGER)", {utc, id});
}

void Library::export_thread(int number, const fs::path& out) const {
  const LibraryThread thread = show(number);
  const std::string content = text_of_file(thread_file(number));
  if (sha256_hex(content) != thread.sha256)
    throw std::runtime_error("'" + thread_file(number).string() +
                             "' is not the file that was added; restore it from a copy, or add its session again");
  make_new_folder(out);
  FileSystem disk;
  store_file(disk, out / "thread.json", std::as_bytes(std::span(content)));
  nlohmann::json sample = to_json(thread.sample);
  sample["session_utc"] = thread.session_utc;
  write_json_file(out / "sample.json", sample);
  write_manifest(out, disk);
}

}  // namespace station
