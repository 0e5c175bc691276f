#include "station/documents/disk/reserved_space.h"

#include <fcntl.h>

#include <cerrno>
#include <stdexcept>
#include <string>

namespace station {

OpenFile reserve_space(const std::filesystem::path& folder, std::uintmax_t bytes) {
  const std::filesystem::path there = folder.empty() ? "." : folder;
  OpenFile room(::open(there.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  if (room.descriptor() < 0) return room;
  if (::fallocate(room.descriptor(), 0, 0, static_cast<off_t>(bytes)) == 0) return room;
  if (errno != ENOSPC && errno != EDQUOT) return OpenFile();
  const std::uintmax_t tenths = (bytes + 99'999) / 100'000;  // of a megabyte, rounded up
  throw std::runtime_error("there is no room for " + std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) +
                           " MB in '" + there.string() + "'; free space on that disk, then begin again");
}

}  // namespace station
