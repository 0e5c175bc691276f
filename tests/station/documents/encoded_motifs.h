// Embroidery files written by encoders of the tests' own.
#pragma once

#include <string>
#include <vector>

namespace station_test {

enum class Step { stitch, jump, colour };

struct Record {
  Step step;
  int x = 0, y = 0;  // tenths of a millimetre, y up
};

std::string dst(const std::vector<Record>& records);
// `colours`: of Brother's chart, one more than there are colour changes.
std::string pes(const std::vector<Record>& records, const std::vector<int>& colours);

}  // namespace station_test
