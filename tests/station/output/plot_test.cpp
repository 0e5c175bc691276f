#include "station/output/plot.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "tests/station/documents/refusal.h"

namespace station {
namespace {

using station_test::refusal;

std::string rising_line() {
  return line_plot("x", "y", {{"rising", {{0, 0}, {1, 1}}}});
}

TEST(Plot, IsAnSvgElementWithItsLinesTitle) {
  const std::string svg = rising_line();
  EXPECT_EQ(svg.rfind("<svg", 0), 0U);
  EXPECT_NE(svg.find("rising"), std::string::npos);
}

TEST(Plot, AFullDiskIsNamed) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit few_bytes{.rlim_cur = 10, .rlim_max = before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);  // files that grow longer fail as on a full disk
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &few_bytes), 0);
  const std::string message = refusal(rising_line);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_NE(message.find("could not write"), std::string::npos) << message;
}

}  // namespace
}  // namespace station
