#include "station/documents/disk/stored_file.h"

#include <fcntl.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <future>
#include <stdexcept>
#include <vector>

#include "station/documents/disk/sha256.h"

namespace station {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kLeftOverEnding = ".partial";

fs::path temporary_name(const fs::path& file) {
  std::string name = file.filename().string();
  name.insert(name.begin(), '.');
  name += kLeftOverEnding;
  return file.parent_path() / name;
}

std::string advice(const std::error_code& code) {
  if (code == std::errc::no_space_on_device || code.value() == EDQUOT) return "free space on that disk, then go on";
  if (code == std::errc::read_only_file_system) return "make that disk writable or choose another folder";
  if (code == std::errc::permission_denied || code == std::errc::operation_not_permitted)
    return "give this user the right to write there or choose another folder";
  if (code == std::errc::io_error) return "the disk or its cable may be failing: check it, then go on";
  if (code == std::errc::no_such_file_or_directory) return "make its folder or choose another one";
  return "check the folder, then go on";
}

void write_temporary(FileSystem& file_system, const fs::path& temporary, std::span<const std::byte> bytes) {
  std::error_code ignored;
  fs::remove(temporary, ignored);  // from a run that was killed
  const OpenFile out = file_system.open(temporary, O_WRONLY | O_CREAT | O_EXCL);
  file_system.write(out, bytes);
  file_system.sync(out);
}

bool holds(const fs::path& file, std::span<const std::byte> bytes) {
  std::ifstream in(file, std::ios::binary);
  std::vector<char> block(std::size_t{1} << 20U);
  std::size_t read = 0;
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())), in.gcount() > 0) {
    const auto count = static_cast<std::size_t>(in.gcount());
    if (count > bytes.size() - read || std::memcmp(block.data(), bytes.data() + read, count) != 0) return false;
    read += count;
  }
  return in.eof() && read == bytes.size();
}

std::string place_problem(const fs::filesystem_error& error) {
  const std::error_code& code = error.code();
  const bool refused = code == std::errc::permission_denied || code == std::errc::operation_not_permitted;
  return "could not use '" + error.path1().string() + "': " + code.message() + "; " +
         (refused                                        ? "give this user the right to use it or name another place"
          : code == std::errc::no_such_file_or_directory ? "check the name"
          : code == std::errc::filename_too_long         ? "give a shorter name"
          : code == std::errc::too_many_symbolic_link_levels ? "the link leads back to itself: name another place"
                                                             : advice(code));
}

}  // namespace

std::string write_problem(const fs::path& file, const std::error_code& code) {
  return "could not write '" + file.string() + "': " + code.message() + "; " + advice(code);
}

std::string problem_line(const std::exception& error) {
  const auto* place = dynamic_cast<const fs::filesystem_error*>(&error);
  return place ? place_problem(*place) : error.what();
}

std::string store_file(FileSystem& file_system, const fs::path& file, std::span<const std::byte> bytes) {
  const fs::path temporary = temporary_name(file);
  std::future<std::string> hashed = std::async(std::launch::async, [bytes] { return sha256_hex(bytes); });
  std::string hash;
  std::error_code ignored;
  bool renamed = false;
  try {
    write_temporary(file_system, temporary, bytes);
    hash = hashed.get();
    if (!holds(temporary, bytes)) {
      throw std::runtime_error("wrote '" + file.string() +
                               "' and read back other bytes; the disk may be failing: check it, then go on");
    }
    file_system.rename(temporary, file);
    renamed = true;
    file_system.sync_folder(file.parent_path());
  } catch (const std::system_error& error) {
    fs::remove(renamed ? file : temporary, ignored);
    throw std::runtime_error(write_problem(file, error.code()));
  } catch (...) {
    fs::remove(temporary, ignored);
    throw;
  }
  return hash;
}

void check_can_store(FileSystem& file_system, const fs::path& file) {
  if (fs::is_directory(file))
    throw std::runtime_error(write_problem(file, std::make_error_code(std::errc::is_a_directory)));
  const fs::path temporary = temporary_name(file);
  std::error_code problem, ignored;
  try {
    write_temporary(file_system, temporary, {});
  } catch (const std::system_error& error) {
    problem = error.code();
  }
  fs::remove(temporary, ignored);
  if (problem) throw std::runtime_error(write_problem(file, problem));
}

void make_folder(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) throw std::runtime_error(write_problem(folder, code));
}

bool is_left_over(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.starts_with('.') && name.ends_with(kLeftOverEnding);
}

std::vector<std::string> remove_left_overs(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (is_left_over(entry.path())) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) fs::remove(folder / name);
  return names;
}

}  // namespace station
