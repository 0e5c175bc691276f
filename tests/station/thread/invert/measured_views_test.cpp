// Views that another lab measured are fitted and reported like a session's own: here of a known thread, drawn from
// directions at random.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <random>

#include "inversion/fit/view_fit.h"
#include "renderer/picture/image_file.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/reader.h"
#include "station/documents/spool.h"
#include "station/documents/thread_file.h"
#include "station/session/import_measured.h"
#include "station/thread/invert/invert_session.h"
#include "station/thread/report/session_report.h"
#include "tests/places.h"
#include "tests/support/temporary_folder.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

TEST(MeasuredViews, AreFittedAndReported) {
  constexpr unsigned kSeed = 20261204;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  const auto between = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  const TemporaryFolder folder;
  const fs::path spool_file = fs::path(DATA_DIR) / "spools" / "silk_red.json";
  fs::copy_file(spool_file, folder / "spool.json");
  write_json_file(folder / "measured.json",
                  {{"format", "threadstation/measurement"},
                   {"version", 1},
                   {"spool", "spool.json"},
                   {"views", "views.csv"},
                   {"camera", {{"distance_mm", 620}, {"focal_length_px", 800}}},
                   {"light", {{"distance_mm", 520}, {"radius_mm", 4}, {"diffuser_radiance", {1, 1, 1}}}}});
  std::ofstream table(folder / "views.csv");
  table << "image,view_azimuth_deg,view_elevation_deg,roll_deg,light_azimuth_deg,light_elevation_deg\n";
  constexpr int kViews = 9;
  for (int i = 0; i < kViews; ++i) {
    table << i << ".exr," << between(-45, 45) << "," << between(10, 40) << "," << (i % 3 == 1 ? 90 : 0) << ","
          << (i % 3 == 2 ? 180 - between(0, 30) : between(-40, 40)) << "," << between(10, 40) << "\n";
    renderer::write_exr(folder / (std::to_string(i) + ".exr"), cv::Mat3f(90, 130, cv::Vec3f(1, 1, 1)));
  }
  table.close();
  // The cameras of an import without light in its pictures are those by which they are drawn.
  import_measured(folder / "measured.json", folder / "white", ProgressStyle::quiet);
  const ThreadFile known = read_thread(fs::path(DATA_DIR) / "threads" / "silk_red.json");
  for (const DevelopedView& view : read_views(folder / "white").views)
    renderer::write_exr(folder / (view.view.id + ".exr"),
                        inversion::fitted_view(read_spool(spool_file).wrapping, view.view, known.parameters, 64, 5));
  import_measured(folder / "measured.json", folder / "session", ProgressStyle::quiet);
  InvertRequest request{.session = folder / "session", .progress_style = ProgressStyle::quiet};
  request.fit.paths_per_block = {128, 512};
  const InvertResult fit = invert_session(request);
  const auto& found = std::get<renderer::ThreadParameters>(fit.model);
  std::printf("relative RMSE %.3f, sigma_a %.3f %.3f %.3f for %.3f %.3f %.3f\n", fit.relative_rmse, found.sigma_a[0],
              found.sigma_a[1], found.sigma_a[2], known.parameters.sigma_a[0], known.parameters.sigma_a[1],
              known.parameters.sigma_a[2]);
  EXPECT_LT(fit.relative_rmse, 0.05);
  const json unknowns = fit.fit.at("certainty").at("unknowns");
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(found.sigma_a[static_cast<int>(c)], known.parameters.sigma_a[static_cast<int>(c)],
                4 * unknowns.at(c).at("sigma").get<double>());
  const std::string page = text_of_file(write_session_report(folder / "session"));
  EXPECT_THAT(page, HasSubstr("measured elsewhere"));
  EXPECT_THAT(page, Not(HasSubstr("<h2>Calibration</h2>")));
}

}  // namespace
}  // namespace station
