#include "station/documents/disk/reserved_space.h"

#include <fcntl.h>

#include <cerrno>
#include <cmath>
#include <stdexcept>

#include "station/documents/number_text.h"

namespace station {

OpenFile reserve_space(const std::filesystem::path& folder, std::uintmax_t bytes) {
  const std::filesystem::path there = folder.empty() ? "." : folder;
  OpenFile room(::open(there.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  if (room.descriptor() < 0) return room;
  if (::fallocate(room.descriptor(), 0, 0, static_cast<off_t>(bytes)) == 0) return room;
  if (errno != ENOSPC && errno != EDQUOT) return OpenFile();
  throw std::runtime_error("there is no room for " + number_text(std::ceil(static_cast<double>(bytes) / 1e5) / 10, 1) +
                           " MB in '" + there.string() + "'; free space on that disk, then begin again");
}

}  // namespace station
