#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>

#include "station/cloth/export/fiber_export.h"
#include "station/documents/fiber_file.h"
#include "station/documents/number_table.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"
#include "tests/station/documents/refusal.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kThreads = std::string(DATA_DIR) + "/threads/", kDrafts = std::string(DATA_DIR) + "/drafts/";

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class ExportThread : public testing::Test {
 protected:
  ProgramResult exported(const fs::path& thread, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"export", "thread", thread.string(), "--out", out().string(), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_threadstation(arguments);
  }
  void expect_refused(const ProgramResult& result, const std::vector<std::string>& words) const {
    EXPECT_EQ(result.status, 1) << result.error;
    EXPECT_EQ(result.error_lines(), 1) << result.error;
    for (const std::string& word : words) EXPECT_NE(result.error.find(word), std::string::npos) << result.error;
  }
  fs::path out() const { return folder_ / "exported"; }

  TemporaryFolder folder_;
};

TEST_F(ExportThread, TableHoldsWhatScatterEvalSays) {
  ASSERT_EQ(exported(kThreads + "silk_red.json", {"--only", "csv"}).status, 0);
  std::ifstream table(out() / "scattering.csv");
  std::string line, queries = "h,theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad\n", values = "r,g,b\n";
  std::getline(table, line);
  EXPECT_EQ(line, "h,theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad,f_cos_r,f_cos_g,f_cos_b");
  int rows = 0;
  for (; std::getline(table, line); ++rows) {
    if (rows % 37 != 0) continue;
    std::size_t place = 0;
    for (int comma = 0; comma < 5; ++comma) place = line.find(',', place) + 1;
    queries += line.substr(0, place - 1) + "\n";
    values += line.substr(place) + "\n";
  }
  EXPECT_EQ(rows, 9 * 37 * 36 * 8);
  station::write_text_file(folder_ / "queries.csv", queries);
  station::write_text_file(folder_ / "expected.csv", values);
  const ProgramResult result =
      run_threadstation({"scatter", "eval", "--model", "thread", "--parameters", kThreads + "silk_red.json", "--in",
                         (folder_ / "queries.csv").string(), "--out", (folder_ / "values.csv").string()});
  ASSERT_EQ(result.status, 0) << result.error;
  const station::NumberTable found(folder_ / "values.csv", {"f_cos_r", "f_cos_g", "f_cos_b", "pdf"}, {});
  const station::NumberTable expected(folder_ / "expected.csv", {"r", "g", "b"}, {});
  ASSERT_EQ(found.rows(), expected.rows());
  constexpr station::Range kAny{0, 1e9};
  for (std::size_t row = 0; row < found.rows(); ++row)
    for (const char* c : {"r", "g", "b"}) {
      const double value = found.number(row, std::string("f_cos_") + c, kAny);
      EXPECT_NEAR(expected.number(row, c, kAny), value, 1e-6 * value) << row;  // directions have nine digits
    }
}

TEST_F(ExportThread, NumpyReadsTheSameNumbersAsTheTables) {
  ASSERT_EQ(exported(kThreads + "cotton_white.json", {"--only", "csv,numpy"}).status, 0);
  const std::string script = R"(
import numpy, sys
folder = sys.argv[1]
read = lambda name: numpy.load(folder + "/numpy/" + name + ".npy")
f, mean = read("f_cos"), read("f_cos_mean")
assert f.shape == (9, 37, 36, 8, 3) and f.dtype == numpy.float64, f.shape
rows = numpy.loadtxt(folder + "/scattering.csv", delimiter=",", skiprows=1).reshape(9, 37, 36, 8, 8)
assert numpy.allclose(rows[..., 5:], f, rtol=1e-8, atol=0)
axes = [read(name) for name in ("theta_o_rad", "theta_i_rad", "phi_rad", "h")]
theta_o, theta_i, phi, h = numpy.meshgrid(*axes, indexing="ij")
for column, axis in ((0, h), (1, theta_i), (2, phi), (3, theta_o)):
    assert numpy.allclose(rows[..., column], axis, rtol=1e-8, atol=1e-12), column
rows = numpy.loadtxt(folder + "/scattering_mean.csv", delimiter=",", skiprows=1).reshape(9, 37, 36, 7)
assert numpy.allclose(rows[..., 4:], mean, rtol=1e-8, atol=0)
solid_angle = numpy.cos(read("theta_i_rad"))[:, None, None] * numpy.radians(5) * numpy.radians(10)
print((mean[0] * solid_angle).sum(axis=(0, 1)).tolist(), f.mean(axis=3)[0].sum() / mean[0].sum())
)";
  station::write_text_file(folder_ / "check.py", script);
  const ProgramResult result = run_shell("/usr/bin/python3 " + (folder_ / "check.py").string() + " " + out().string());
  ASSERT_EQ(result.status, 0) << result.error;
  // Summed over the sphere, the mean at theta_o = 0 is the albedo of white cotton seen from the side; the sum over
  // eight offsets is nearly that over all.
  double red = 0, green = 0, blue = 0, few_over_many = 0;
  ASSERT_EQ(std::sscanf(result.out.c_str(), "[%lf, %lf, %lf] %lf", &red, &green, &blue, &few_over_many), 4)
      << result.out;
  EXPECT_GT(blue, 0.8);
  EXPECT_LT(red, 1.0);
  EXPECT_GT(red, blue);
  EXPECT_NEAR(few_over_many, 1, 0.01);
}

TEST_F(ExportThread, MitsubaSceneHasTheFiberInItsUnits) {
  ASSERT_EQ(exported(kThreads + "silk_blue.json", {"--only", "mitsuba"}).status, 0);
  const renderer::FiberParameters fiber = station::read_fiber(out() / "fiber.json");
  pugi::xml_document document;
  ASSERT_TRUE(document.load_file((out() / "thread.xml").c_str()));
  const pugi::xml_node bsdf = document.child("scene").child("bsdf");
  EXPECT_STREQ(bsdf.attribute("type").value(), "hair");
  std::map<std::string, std::string> values;
  for (const pugi::xml_node& node : bsdf) values[node.attribute("name").value()] = node.attribute("value").value();
  EXPECT_EQ(values.size(), 7U);
  const auto number = [&](const char* name) { return std::stod(values.at(name)); };
  EXPECT_NEAR(number("longitudinal_roughness"), fiber.beta_m, 1e-8);
  EXPECT_NEAR(number("azimuthal_roughness"), fiber.beta_n, 1e-8);
  EXPECT_NEAR(number("int_ior") / number("ext_ior"), fiber.eta, 1e-8);
  EXPECT_EQ(number("scale_tilt"), 0);
  std::istringstream sigma(values.at("sigma_a"));
  for (int c = 0; c < 3; ++c) {
    double share = -1;
    char comma = ',';
    sigma >> share;
    if (c < 2) sigma >> comma;
    EXPECT_GE(share, 0);
    EXPECT_LE(share, 1);  // Mitsuba refuses colours above it
    EXPECT_NEAR(share * number("scale"), fiber.sigma_a[c], 1e-8);
    EXPECT_EQ(comma, ',');
  }
}

// The metallic thread's coloured highlights are no fiber's: what comes out is said to be far from it.
TEST_F(ExportThread, AThreadThatNoFiberEqualsIsExportedWithItsError) {
  const ProgramResult result = exported(kThreads + "metal_gold.json", {"--only", "mitsuba,blender"});
  ASSERT_EQ(result.status, 0) << result.error;
  const double rms = json::parse(result.out).at("fiber").at("rms").get<double>();
  EXPECT_GT(rms, 0.7);
  EXPECT_EQ(station::read_json_file(out() / "export.json").at("fiber").at("rms").get<double>(), rms);
  char stated[64];
  std::snprintf(stated, sizeof stated, "error of f cos: %.1f %%", 100 * rms);
  for (const char* file : {"thread.xml", "thread_material.py"})
    EXPECT_NE(text_of(out() / file).find(stated), std::string::npos) << file;
}

TEST_F(ExportThread, NamesAreNoCode) {
  const std::string name = "a --> b\n\"\"\"\nimport os; os.abort() # \\ caf\u00e9";
  json thread = station::read_json_file(kThreads + "silk_red.json");
  thread["name"] = name;
  station::write_json_file(folder_ / "named.json", thread);
  ASSERT_EQ(exported(folder_ / "named.json", {"--only", "mitsuba,blender"}).status, 0);
  pugi::xml_document document;
  EXPECT_TRUE(document.load_file((out() / "thread.xml").c_str()));
  EXPECT_TRUE(document.child("scene").child("bsdf"));
  station::write_text_file(folder_ / "check.py", R"(
import ast, json, sys
body = ast.parse(open(sys.argv[1], encoding="utf-8").read()).body
named = [node.value for node in body if isinstance(node, ast.Assign) and node.targets[0].id == "THREAD"]
assert ast.literal_eval(named[0]) == json.load(open(sys.argv[2], encoding="utf-8"))["name"]
assert sum(isinstance(node, ast.Import) for node in body) == 1
)");
  const ProgramResult result =
      run_shell("/usr/bin/python3 " + (folder_ / "check.py").string() + " " + (out() / "thread_material.py").string() +
                " " + (folder_ / "named.json").string());
  EXPECT_EQ(result.status, 0) << result.error;
}

TEST_F(ExportThread, RefusalsAreOneLineAndLeaveNothing) {
  expect_refused(exported(folder_ / "none.json"), {"none.json"});
  expect_refused(exported(std::string(DATA_DIR) + "/fibers/" + "README.md"), {"README.md"});
  expect_refused(exported(kDrafts + "plain.json"), {"threadstation/thread", "plain.json"});
  expect_refused(exported(kThreads + "silk_red.json", {"--only", "merl"}), {"--draft"});
  expect_refused(exported(kThreads + "silk_red.json", {"--only", "merl", "--draft", kDrafts + "none.json"}),
                 {"none.json"});
  EXPECT_FALSE(fs::exists(out()));
  station::write_text_file(out(), "a file");
  expect_refused(exported(kThreads + "silk_red.json"), {"exported", "choose another --out"});
  expect_refused(
      run_threadstation({"export", "thread", kThreads + "silk_red.json", "--out", (out() / "below").string()}),
      {"exported/below"});
  EXPECT_EQ(text_of(out()), "a file");
  const ProgramResult unknown = exported(kThreads + "silk_red.json", {"--only", "maya"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_EQ(unknown.error_lines(), 1) << unknown.error;
}

TEST_F(ExportThread, AClothThatTurnsIsRefusedUnlessItsMeanIsWanted) {
  const ProgramResult result =
      exported(kThreads + "silk_red.json", {"--only", "merl", "--draft", kDrafts + "satin_5.json"});
  expect_refused(result, {"satin_5.json", "limit 25 %", "--allow-anisotropic"});
  EXPECT_FALSE(fs::exists(out()));
}

TEST(FiberExport, WhiteLightStaysWhiteInSrgb) {
  station::ThreadFile thread;
  thread.linear_srgb_from_camera = {1.7, -0.5, -0.1, -0.2, 1.4, -0.3, 0.05, -0.6, 1.5};
  const Eigen::Vector3d grey = station::srgb_scattering_from_camera(thread) * Eigen::Vector3d::Constant(0.4);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(grey[c], 0.4, 1e-12);
  thread.linear_srgb_from_camera = {2, 0, 0, 0, 1, 0, 0, 0, 0.5};  // a white balance: scattering has none
  EXPECT_TRUE(station::srgb_scattering_from_camera(thread).isIdentity(1e-12));
  thread.linear_srgb_from_camera.fill(1);
  EXPECT_NE(refusal([&] { station::srgb_scattering_from_camera(thread); }).find("no inverse"), std::string::npos);
}

}  // namespace
}  // namespace station_test
