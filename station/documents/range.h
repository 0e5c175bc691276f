// The values that a number in a document or table may have: from `low` to `high`, both included.
#pragma once

namespace station {

struct Range {
  double low, high;
};

}  // namespace station
