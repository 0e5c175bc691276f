// What a number in a document or table may be: both ends included.
#pragma once

namespace station {

struct Range {
  double low, high;
};

}  // namespace station
