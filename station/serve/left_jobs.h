// Jobs that go on although the server that started them has gone: the emergency stop of the next one reaches them.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>

namespace station {

inline constexpr const char* kProcessFile = ".process";  // the ending of a file that names a job's process

// Writes which process a job is. Its number alone may be another process's later, so its beginning is written, too.
void note_process(const std::filesystem::path& file, pid_t process);

// Gives both ctrl-C to every job that a file in the folder names, but for the one that `own` names, and forgets those
// that have ended. True when there was one.
bool stop_left_jobs(const std::filesystem::path& folder, const std::filesystem::path& own);

// Removes what jobs said, "<time>-<kind>.*", but for the newest `kept` jobs and as many checks, by which the page knows
// its devices. Processes that are named by a file stay named.
void forget_old_jobs(const std::filesystem::path& folder, std::size_t kept = 300);

}  // namespace station
