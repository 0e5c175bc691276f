#include "station/serve/zip_download.h"

#include <archive.h>
#include <archive_entry.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "station/documents/disk/whole_file.h"
#include "station/serve/page_answers.h"

namespace station {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMost = std::uintmax_t(512) << 20;

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::uintmax_t bytes = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.is_symlink()) continue;
    files.push_back(entry.path());
    bytes += entry.file_size();
  }
  if (bytes > kMost)
    throw Refused(413, "the export " + folder.filename().string() + " has " + std::to_string(bytes >> 20) +
                           " MiB, more than the 512 that a browser is sent; copy its folder " + folder.string());
  std::ranges::sort(files);
  return files;
}

la_ssize_t add_bytes(archive* /*archive*/, void* text, const void* bytes, std::size_t count) {
  static_cast<std::string*>(text)->append(static_cast<const char*>(bytes), count);
  return static_cast<la_ssize_t>(count);
}

void check(archive* written, int result) {
  if (result < ARCHIVE_OK)
    throw std::runtime_error(std::string("cannot pack the export: ") + archive_error_string(written));
}

}  // namespace

HttpResponse zip_of(const fs::path& folder) {
  const std::string name = folder.filename().string();
  if (!fs::is_directory(folder)) throw Refused(404, "there is no export " + name);
  HttpResponse response{.content_type = "application/zip",
                        .body = {},
                        .headers = {{"Content-Disposition", "attachment; filename=\"" + name + ".zip\""}}};
  const std::unique_ptr<archive, int (*)(archive*)> written(archive_write_new(), archive_write_free);
  check(written.get(), archive_write_set_format_zip(written.get()));
  check(written.get(), archive_write_set_bytes_in_last_block(written.get(), 1));  // without padding
  check(written.get(), archive_write_open(written.get(), &response.body, nullptr, add_bytes, nullptr));
  for (const fs::path& file : files_below(folder)) {
    const std::string content = text_of_file(file);
    const std::unique_ptr<archive_entry, void (*)(archive_entry*)> entry(archive_entry_new(), archive_entry_free);
    archive_entry_set_pathname_utf8(entry.get(), (name / file.lexically_relative(folder)).c_str());
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(content.size()));
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    check(written.get(), archive_write_header(written.get(), entry.get()));
    if (archive_write_data(written.get(), content.data(), content.size()) < 0) check(written.get(), ARCHIVE_FATAL);
  }
  check(written.get(), archive_write_close(written.get()));
  return response;
}

}  // namespace station
