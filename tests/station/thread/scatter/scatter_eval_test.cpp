#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "renderer/scattering/thread.h"
#include "renderer/scattering/yarn.h"
#include "station/documents/fiber_file.h"
#include "station/documents/number_table.h"
#include "station/documents/thread_file.h"
#include "station/documents/yarn_file.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using station::NumberTable;

const fs::path kFixtures = FIXTURES_DIR, kData = DATA_DIR;
constexpr station::Range kAny{-1e300, 1e300};
const std::vector<std::string> kValueColumns{"f_cos_r", "f_cos_g", "f_cos_b", "pdf"};
constexpr const char* kPlaceColumns = "h,theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad";

struct Row {
  double h;
  Eigen::Vector3d wi, wo;
};

std::string line(const std::vector<double>& numbers) {
  std::string text;
  char number[32];
  for (double n : numbers) {
    std::snprintf(number, sizeof number, "%.17g", n);
    text += (text.empty() ? "" : ",") + std::string(number);
  }
  return text + "\n";
}

double inclination(const Eigen::Vector3d& w) {
  return std::atan2(w.x(), std::hypot(w.y(), w.z()));
}

// Both azimuths turned by `turn`, which must not matter.
std::vector<double> place(const Row& row, double turn) {
  return {row.h, inclination(row.wi), std::atan2(row.wi.z(), row.wi.y()) + turn, inclination(row.wo),
          std::atan2(row.wo.z(), row.wo.y()) + turn};
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

class ScatterEval : public testing::Test {
 protected:
  ProgramResult evaluate(const std::string& model, const std::string& queries, const fs::path& parameters = {}) const {
    write(folder_ / "queries.csv", queries);
    std::vector<std::string> arguments{"scatter", "eval",
                                       "--model", model,
                                       "--in",    (folder_ / "queries.csv").string(),
                                       "--out",   (folder_ / "values.csv").string()};
    if (!parameters.empty()) {
      arguments.push_back("--parameters");
      arguments.push_back(parameters.string());
    }
    return run_threadstation(arguments);
  }
  NumberTable values() const { return NumberTable(folder_ / "values.csv", kValueColumns, {}); }

  // One line on standard error that contains all of `words`, status 1, and no table written.
  void expect_refused(const ProgramResult& result, const std::vector<std::string>& words) const {
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.error_lines(), 1) << result.error;
    for (const std::string& word : words) EXPECT_NE(result.error.find(word), std::string::npos) << result.error;
    EXPECT_FALSE(fs::exists(folder_ / "values.csv"));
  }

  // The program's values of all rows of `places` against the library's.
  template <class Model>
  void expect_values_of(const Model& model, const std::vector<Row>& rows) const {
    const NumberTable found = values();
    ASSERT_EQ(found.rows(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto expected = model.lobes_at(rows[i].h, rows[i].wo).evaluate(rows[i].wi);
      for (int c = 0; c < 3; ++c)  // rounding of angles
        EXPECT_NEAR(found.number(i, kValueColumns[static_cast<std::size_t>(c)], kAny), expected.f_cos[c],
                    1e-12 * expected.f_cos[c]);
      EXPECT_NEAR(found.number(i, "pdf", kAny), expected.pdf, 1e-12 * expected.pdf);
    }
  }

  TemporaryFolder folder_;
};

const std::vector<Row> kRows{{0.3, {0.1, -0.9, 0.4}, {-0.2, 0.3, 0.9}}, {-0.9, {0.7, 0.1, 0.7}, {0.5, 0.8, 0.1}}};

std::vector<Row> unit_rows() {
  std::vector<Row> rows = kRows;
  for (Row& row : rows) row.wi.normalize(), row.wo.normalize();
  return rows;
}

std::string queries_of(const std::vector<Row>& rows) {
  std::string text = std::string(kPlaceColumns) + "\n";
  for (const Row& row : rows) text += line(place(row, 0));
  return text;
}

TEST_F(ScatterEval, FibersAgreeWithAllRowsOfTheReferenceTable) {
  const std::vector<std::string> columns{
      "h",    "eta",  "sigma_a_r", "sigma_a_g", "sigma_a_b", "beta_m",       "beta_n",       "alpha_deg",    "wo_x",
      "wo_y", "wo_z", "wi_x",      "wi_y",      "wi_z",      "exact_fcos_r", "exact_fcos_g", "exact_fcos_b", "pdf"};
  const NumberTable table(kFixtures / "reference" / "single_fiber_bcsdf.csv", columns, {});
  ASSERT_EQ(table.rows(), 800u);
  const auto at = [&](std::size_t row, const char* column) { return table.number(row, column, kAny); };
  std::string queries = std::string(kPlaceColumns) + ",eta,sigma_a_r,sigma_a_g,sigma_a_b,beta_m,beta_n,tilt_deg\n";
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const Row row{
        at(i, "h"), {at(i, "wi_x"), at(i, "wi_y"), at(i, "wi_z")}, {at(i, "wo_x"), at(i, "wo_y"), at(i, "wo_z")}};
    std::vector<double> numbers = place(row, i % 2 ? 1.7 : 0);
    for (std::size_t c = 1; c < 8; ++c) numbers.push_back(at(i, columns[c].c_str()));
    queries += line(numbers);
  }
  const ProgramResult result = evaluate("fiber", queries);
  ASSERT_EQ(result.status, 0) << result.error;
  const NumberTable found = values();
  ASSERT_EQ(found.rows(), 800u);
  for (std::size_t i = 0; i < 800; ++i)
    for (std::size_t c = 0; c < 4; ++c)  // the table's directions have 12 digits, which narrow lobes amplify
      EXPECT_NEAR(found.number(i, kValueColumns[c], kAny) / at(i, columns[14 + c].c_str()), 1, 1e-6) << i << ' ' << c;
}

TEST_F(ScatterEval, ColumnsOverrideTheFiberRowByRow) {
  const fs::path file = kData / "fibers" / "dyed_red.json";
  const std::vector<Row> rows = unit_rows();
  std::string queries = "beta_n," + std::string(kPlaceColumns) + ",sigma_a_g\n";
  std::vector<renderer::FiberParameters> fibers(rows.size(), station::read_fiber(file));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    fibers[i].beta_n = 0.2 + 0.3 * static_cast<double>(i);
    fibers[i].sigma_a[1] = 0.1 + static_cast<double>(i);
    std::string row = line(place(rows[i], 0));
    row.pop_back();
    queries += std::to_string(fibers[i].beta_n) + "," + row + "," + std::to_string(fibers[i].sigma_a[1]) + "\n";
  }
  ASSERT_EQ(evaluate("fiber", queries, file).status, 0);
  const NumberTable found = values();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const renderer::FiberModel<double> model(fibers[i]);
    const auto expected = model.lobes_at(rows[i].h, rows[i].wo).evaluate(rows[i].wi);
    EXPECT_NEAR(found.number(i, "f_cos_g", kAny), expected.f_cos[1], 1e-12 * expected.f_cos[1]);
    EXPECT_NEAR(found.number(i, "pdf", kAny), expected.pdf, 1e-12 * expected.pdf);
  }
}

TEST_F(ScatterEval, EveryModelIsThatOfItsFile) {
  const std::vector<Row> rows = unit_rows();
  const fs::path fiber = kData / "fibers" / "clear.json", thread = kData / "threads" / "metal_gold.json",
                 yarn = kData / "yarns" / "twenty_fibers.json";
  ASSERT_EQ(evaluate("fiber", queries_of(rows), fiber).status, 0);
  expect_values_of(renderer::FiberModel<double>(station::read_fiber(fiber)), rows);
  ASSERT_EQ(evaluate("thread", queries_of(rows), thread).status, 0);
  expect_values_of(renderer::ThreadModel<double>(station::read_thread(thread).parameters), rows);
  const ProgramResult result = evaluate("yarn", queries_of(rows), yarn);
  ASSERT_EQ(result.status, 0);
  expect_values_of(renderer::YarnModel<double>(station::read_yarn(yarn)), rows);
  EXPECT_EQ(result.out, "2 values: " + (folder_ / "values.csv").string() + "\n");
}

TEST_F(ScatterEval, RightAnglesGrazingOffsetsCommentsAndSpreadsheetHabitsAreAccepted) {
  const ProgramResult result =
      evaluate("fiber",
               "\xEF\xBB\xBFh, theta_i_rad, phi_i_rad, theta_o_rad, phi_o_rad\r\n# right angles\r\n"
               "1, 1.5708, 0, -1.5708, 3\r\n-1, 0, 0, 0.3, 100\r\n\r\n",
               kData / "fibers" / "clear.json");
  ASSERT_EQ(result.status, 0) << result.error;
  EXPECT_EQ(values().rows(), 2u);  // which are finite, as the table's reader demands
}

TEST_F(ScatterEval, WrongTablesAreRefusedInOneLineThatNamesThePlace) {
  const fs::path fiber = kData / "fibers" / "clear.json";
  const std::string names = std::string(kPlaceColumns) + "\n", good = "0.1,0,1,0,2\n";
  const auto refused = [&](const std::string& queries, const std::vector<std::string>& words) {
    expect_refused(evaluate("fiber", queries, fiber), words);
  };
  refused("", {"queries.csv", "empty", "theta_i_rad"});
  refused(names, {"queries.csv", "no rows"});
  refused("h,theta_i_rad,phi_i_rad,theta_o_rad\n0,0,0,0\n", {"\"phi_o_rad\" is missing"});
  refused("color," + names + good, {"column \"color\" is not known", "tilt_deg"});
  refused("h," + names + "0," + good, {"\"h\" stands there twice"});
  refused(names + good + "1.1,0,1,0,2\n", {"line 3", "\"h\"", "1.1", "from -1 to 1"});
  refused(names + "0.1,1.6,1,0,2\n", {"line 2", "\"theta_i_rad\"", "1.6"});
  refused(names + "0.1,0,1,0\n", {"line 2", "4 cells", "5 columns"});
  refused(names + "0.1,0,nan,0,2\n", {"line 2", "\"phi_i_rad\"", "\"nan\"", "finite"});
  refused(names + "0.1,0,1,inf,2\n", {"\"theta_o_rad\""});
  refused(names + "0.1,0,1,0,2x\n", {"\"phi_o_rad\"", "\"2x\""});
  refused(names + "0.1,,1,0,2\n", {"\"theta_i_rad\"", "\"\""});
  refused("beta_m," + names + "0.01," + good, {"\"beta_m\"", "from 0.02 to 1"});
}

TEST_F(ScatterEval, WhatIsMissingIsSaidWithWhatToDo) {
  const std::string queries = queries_of(unit_rows());
  expect_refused(evaluate("fiber", queries), {"--parameters", "\"eta\"", "fiber file"});
  expect_refused(evaluate("thread", queries), {"--parameters", "thread file"});
  expect_refused(evaluate("thread", queries, kData / "fibers" / "clear.json"), {"threadstation/thread"});
  expect_refused(evaluate("thread", "eta," + std::string(kPlaceColumns) + "\n1.5,0,0,0,0,0\n",
                          kData / "threads" / "silk_red.json"),
                 {"column \"eta\" is not known"});
  expect_refused(evaluate("yarn", queries, folder_ / "none.json"), {"none.json", "no such file"});
  EXPECT_EQ(evaluate("cloth", queries).status, 2);
  EXPECT_EQ(run_threadstation({"scatter"}).status, 2);
  EXPECT_EQ(run_threadstation({"scatter", "eval", "--help"}).status, 0);
}

TEST(ScatteringDocuments, ExamplesAreReadAndMistakesNamed) {
  for (const auto& [folder, kind] : {std::pair{"fibers", "fiber"}, std::pair{"yarns", "yarn"}}) {
    int read = 0;
    for (const auto& entry : fs::directory_iterator(kData / folder)) {
      if (entry.path().extension() != ".json") continue;
      if (kind == std::string("fiber"))
        EXPECT_NO_THROW(station::read_fiber(entry.path())) << entry.path();
      else
        EXPECT_NO_THROW(station::read_yarn(entry.path())) << entry.path();
      ++read;
    }
    EXPECT_GE(read, 1);
  }
}

}  // namespace
}  // namespace station_test
