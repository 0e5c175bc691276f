// The commands one after the other on the simulated bench, as a person types them: calibrate, capture, develop, report,
// each alone from the files that the one before it left; pulled plugs, full disks and wrong files on the way.

#include "tests/station/commands/workflow.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <thread>

#include "station/bench/calibration_validity.h"
#include "station/bench/camera_adapter.h"
#include "station/documents/calibration_file.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/documents/thread_file.h"
#include "station/documents/views_file.h"
#include "tests/places.h"
#include "tests/station/bench/calibrate/calibration_errors.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

TEST_F(Workflow, CalibrationFindsTheBenchAsItIs) {
  const station::RigCalibration found = station::read_calibration(path("calibration"));
  const rig::BenchTruth truth = station::read_rig(path("rig.json")).simulation->truth;
  const CalibrationErrors errors = calibration_errors(found, *station::read_rig(path("rig.json")).simulation);
  // The tolerance of 0.5 % is there because focal length and distance trade off in a lens of 14 degrees; what counts is
  // where points at the spool are seen.
  EXPECT_NEAR(found.lens.lens.fx_px, truth.lens.fx_px, 0.005 * truth.lens.fx_px);
  EXPECT_LT(found.lens.rms_px, 0.3);
  EXPECT_NEAR(found.platform.scale, truth.turntable.scale, 5e-4);
  EXPECT_LT(errors.points_px, 1);  // 0.25 mm
  // The chart's colours are drawn by the rig file's matrix; 0.03 in a matrix of about 1 is one unit of colour
  // difference.
  const auto drawn = station::read_rig(path("rig.json")).linear_srgb_from_camera;
  ASSERT_TRUE(found.colour.has_value());
  EXPECT_LT(found.colour->mean_delta_e, 2.0);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(found.linear_srgb_from_camera[i], drawn[i], 0.03) << i;
  // Few samples a pixel; WholeBenches has more.
  EXPECT_LT(errors.lamp_mm[0], 2.5);
  EXPECT_LT(errors.lamp_mm[1], 5);
  EXPECT_LT(errors.worst_irradiance[0], 0.005);
  EXPECT_LT(errors.worst_irradiance[1], 0.01);
}

// The documented rig's sensor: bad pixels, dust, a bent response and shutter errors, all mild.
TEST_F(Workflow, CalibrationFindsTheSensorAsItIs) {
  station::RigCalibration found = station::read_calibration(path("calibration"));
  ASSERT_TRUE(found.sensor);
  station::fill_in_sensor_maps(path("calibration"), found);
  const rig::BenchTruth truth = station::read_rig(path("rig.json")).simulation->truth;
  const calibration::SensorResponse& response = found.sensor->response;
  EXPECT_NEAR(response.gain_dn_per_e / (15871 / truth.sensor.full_well_e), 1, 0.01);
  EXPECT_NEAR(response.read_noise_e / truth.sensor.read_noise_e, 1, 0.03);
  EXPECT_NEAR(response.nonlinearity, truth.sensor.defects.nonlinearity, 0.002);
  ASSERT_EQ(response.shutter.size(), 12U);
  const auto factor = [&](double nominal_s) {
    return rig::shutter_factor(truth.sensor.defects, nominal_s, truth.seed);
  };
  double reference = 0;  // the time that is true by definition
  for (const calibration::ShutterTime& time : response.shutter)
    if (time.sigma_s == 0) reference = factor(time.nominal_s);
  for (const calibration::ShutterTime& time : response.shutter)
    EXPECT_NEAR(time.true_s / time.nominal_s, factor(time.nominal_s) / reference, 2e-3) << time.nominal_s;
  const rig::DefectMaps defects =
      rig::defect_maps(truth.sensor.defects, {truth.lens.width_px, truth.lens.height_px}, truth.seed);
  const cv::Mat1b truly_bad(cv::Mat1b(defects.dark_current_e_s > 0) | cv::Mat1b(defects.read_noise_factor > 1) |
                            cv::Mat1b(defects.sensitivity < 0.5));
  EXPECT_GT(cv::countNonZero(response.maps.bad & truly_bad), 0.95 * cv::countNonZero(truly_bad));
  EXPECT_LT(cv::countNonZero(response.maps.bad & ~truly_bad), 24);  // 1e-4 of the pixels
  rig::SensorDefects dust_alone{.dust_spots = truth.sensor.defects.dust_spots,
                                .dust_depth = truth.sensor.defects.dust_depth,
                                .dust_radius_px = truth.sensor.defects.dust_radius_px};
  const cv::Mat1f dust = rig::defect_maps(dust_alone, response.maps.flat.size(), truth.seed).sensitivity;
  cv::Scalar mean, deviation;
  cv::meanStdDev(response.maps.flat / dust, mean, deviation);
  EXPECT_NEAR(mean[0], 1, 0.002);
  EXPECT_LT(deviation[0], 0.005);  // these pictures are drawn with few samples a pixel
  for (const calibration::Gate& gate : found.sensor->gates) EXPECT_TRUE(gate.passed) << gate.name;
}

TEST_F(Workflow, CalibrationIsSolvedAgainFromItsPicturesAloneAndKeepsTheirDate) {
  const json before = station::read_json_file(path("calibration/calibration.json")).flatten();
  const fs::path old = path("calibration-of-2024");
  fs::copy(path("calibration"), old, fs::copy_options::recursive);
  json list = station::read_json_file(old / "pictures.json");
  // The platform on the last of February, all else the day after.
  std::string last_of_platform;
  for (json& picture : list["pictures"]) {
    const bool platform = picture["role"] == "turning";
    picture["utc"] = (platform ? "2024-02-29T" : "2024-03-01T") + picture["utc"].get<std::string>().substr(11);
    if (platform) last_of_platform = std::max(last_of_platform, picture["utc"].get<std::string>());
  }
  station::write_json_file(old / "pictures.json", list);
  expect_success(run_threadstation({"calibrate", "--rig", path("rig.json"), "--out", old, "--solve", "--quiet"}));
  const json after = station::read_json_file(old / "calibration.json").flatten();
  for (const auto& [key, value] : before.items()) {
    if (key == "/utc") {
      EXPECT_EQ(after.at(key), last_of_platform) << "that of the last picture of the oldest part";
      continue;
    }
    if (!value.is_number()) {
      EXPECT_EQ(after.at(key), value) << key;
      continue;
    }
    // Linear algebra libraries add in an order that depends on where memory lies: some 13 digits of a covariance agree.
    EXPECT_NEAR(after.at(key).get<double>(), value.get<double>(), 1e-9 * std::abs(value.get<double>()) + 1e-15) << key;
  }
}

TEST_F(Workflow, SessionHasEveryFileUpToMasksAndEachStageRunsAgainAlone) {
  const fs::path session = path("session");
  const station::DevelopedViews developed = station::read_views(session);
  ASSERT_EQ(developed.views.size(), 17U);
  for (const char* file : {"session.json", "journal.jsonl", "calibration/calibration.json", "linear/views.json"})
    EXPECT_TRUE(fs::exists(session / file)) << file;
  for (const station::DevelopedView& view : developed.views) {
    EXPECT_TRUE(fs::exists(session / "raw" / (view.view.id + ".arw"))) << view.view.id;
    EXPECT_TRUE(fs::exists(session / view.image_file) && fs::exists(session / view.mask_file)) << view.view.id;
    EXPECT_GT(view.masked_pixels, 2000) << view.view.id;
  }
  const std::string first = run_shell("cd '" + session.string() + "' && sha256sum linear/* masks/*").out;
  expect_success(run_threadstation({"develop", session, "--quiet"}));
  EXPECT_EQ(run_shell("cd '" + session.string() + "' && sha256sum linear/* masks/*").out, first)
      << "developing again gives the same files";
  expect_success(run_threadstation({"verify", session}));
}

// Rows 41 and 42 of the station's faults: each is corrected, or refused with a line that says what to do.
TEST_F(Workflow, ACameraThatWasBumpedATagThatWasMovedAndAnotherLensAreNoticedBeforeAPictureIsKept) {
  const auto captured_with = [&](const std::string& name, const std::function<void(json&)>& change) {
    fs::copy(path("calibration"), path(name), fs::copy_options::recursive);
    json calibration = station::read_json_file(path(name) + "/calibration.json");
    change(calibration);
    station::write_json_file(path(name) + "/calibration.json", calibration);
    const std::string session = path(name) + "_session";
    const ProgramResult result = run_threadstation(capture_arguments(session, "rig.json", "silk_red", name));
    EXPECT_FALSE(fs::exists(session + "/raw/pose-horizontal-1.arw")) << name;
    return result;
  };
  const auto move_tag = [](json& tag) {
    for (std::size_t i = 1; i < tag.size(); i += 2) tag[i] = tag[i].get<double>() + 1.5;  // px
  };
  expect_one_line(captured_with("bumped",
                                [&](json& calibration) {
                                  for (json& tag : calibration["platform"]["table_tags_px"]) move_tag(tag);
                                }),
                  "bumped");
  expect_one_line(
      captured_with("moved", [&](json& calibration) { move_tag(calibration["platform"]["table_tags_px"][2]); }),
      "tag 402 on the table moved");
  expect_one_line(captured_with("other_lens", [](json& calibration) { calibration["camera"]["lens"] = "90 mm"; }),
                  "lens \"90 mm\"");
  expect_one_line(captured_with("old", [](json& calibration) { calibration["utc"] = "2010-01-01T00:00:00Z"; }),
                  "days old");
  expect_one_line(
      captured_with("failed", [](json& calibration) { calibration["platform"]["gates"][0]["passed"] = false; }),
      "--accept-calibration");
}

// On the simulated clock, from the session's start to a step's exposure.
double seconds_until(const std::string& session, const std::string& step) {
  std::ifstream journal(session + "/journal.jsonl");
  std::string start_utc;
  for (std::string line; std::getline(journal, line);) {
    const json record = json::parse(line);
    if (start_utc.empty()) start_utc = record["utc"];
    if (record["event"] == "picture" && record["data"]["step"] == step)
      return 86400 * station::days_between(start_utc, record["data"]["exposure_utc"]);
  }
  throw std::runtime_error("the session has no picture of " + step);
}

TEST_F(Workflow, ALampThatFailsOrOtherLightIsNoticedBeforeThePictureIsKept) {
  const double third_view_s = seconds_until(path("session"), "reflection-horizontal-3");
  const auto captured_with = [&](const std::string& name, const std::function<void(json&)>& fault) {
    json rig = station::read_json_file(path("rig.json"));
    fault(rig["simulation"]);
    station::write_json_file(path(name + ".json"), rig);
    return run_threadstation(capture_arguments(path(name), name + ".json"));
  };
  expect_one_line(captured_with("room_light", [](json& bench) { bench["room_leak"] = 1; }),
                  "switch the room light off");
  expect_one_line(captured_with("lamp_off", [](json& bench) { bench["lamp"]["changes"]["jump"] = -1; }),
                  "switch the lamp on");
  expect_one_line(captured_with("lamp_fell",
                                [&](json& bench) {
                                  bench["lamp"]["changes"]["jump"] = -0.04;
                                  bench["lamp"]["changes"]["jump_at_s"] = third_view_s;
                                }),
                  "let the lamp settle");
  // More than ten percent over the session's 22 simulated seconds.
  expect_one_line(captured_with("lamp_fades", [](json& bench) { bench["lamp"]["changes"]["drift_per_s"] = -0.0065; }),
                  "replace the lamp");
  expect_one_line(captured_with("too_bright",
                                [](json& bench) {
                                  for (json& value : bench["lamp"]["intensity_mm2"]) value = value.get<double>() * 1e5;
                                }),
                  "over-exposed");
  EXPECT_FALSE(fs::exists(path("lamp_off") + "/raw/reflection-horizontal-1.arw")) << "what does not serve is not kept";
  // Each run goes on where the one before it paused, and accepts the lamp as it finds it; here it falls again each
  // time.
  EXPECT_TRUE(fs::exists(path("lamp_fell") + "/raw/reflection-horizontal-1.arw"));
  int runs = 0;
  while (++runs < 17 && run_threadstation({"capture", "--resume", "--out", path("lamp_fell"), "--quiet"}).status != 0) {
  }
  EXPECT_LT(runs, 17);
  expect_success(run_threadstation({"verify", path("lamp_fell")}));
}

TEST_F(Workflow, ALampThatDriftsByTwoPercentIsDividedOut) {
  json rig = station::read_json_file(path("rig.json"));
  const double drift_per_s = -0.001;
  rig["simulation"]["lamp"]["changes"]["drift_per_s"] = drift_per_s;
  station::write_json_file(path("drifting.json"), rig);
  const std::string session = path("drifting");
  expect_success(run_threadstation(capture_arguments(session, "drifting.json")));
  expect_success(run_threadstation({"develop", session, "--quiet"}));
  std::map<std::string, double> at_s;  // of each picture, in the order of the simulated clock
  std::ifstream journal(session + "/journal.jsonl");
  for (std::string line; std::getline(journal, line);) {
    const json record = json::parse(line);
    if (record["event"] != "picture") continue;
    const std::string utc = record["data"]["exposure_utc"];
    at_s[record["data"]["step"]] = 60 * std::stod(utc.substr(14, 2)) + std::stod(utc.substr(17, 6)) +
                                   record["data"]["camera_asked"]["exposure_s"].get<double>() / 2;
  }
  double worst = 0, total = 0;
  const station::DevelopedViews developed = station::read_views(session);
  const double first_s = at_s.at(developed.views.front().view.id);
  for (const station::DevelopedView& view : developed.views) {
    const double since_s = std::fmod(at_s.at(view.view.id) - first_s + 3600, 3600);
    const double truth = 1 + drift_per_s * since_s;  // the first view is a second or two after the clock's start
    std::printf("%s: %.1f s, strength %.4f, true %.4f\n", view.view.id.c_str(), since_s, view.lamp_strength, truth);
    worst = std::max(worst, std::abs(view.lamp_strength / truth - 1));
    total = std::max(total, 1 - truth);
  }
  std::printf("lamp fell by %.2f %%; divided out to %.3f %%\n", 100 * total, 100 * worst);
  EXPECT_GT(total, 0.015);
  // Chips drawn with 4 samples a pixel scatter by 0.2 %, and the first of them is the reference.
  EXPECT_LT(worst, 0.005);
}

TEST_F(Workflow, MasksLieOnTheThreads) {
  const fs::path session = path("session");
  station::DevelopedViews developed = station::read_views(session);
  station::read_view_pictures(session, developed);
  for (const station::DevelopedView& view : developed.views) {
    if (view.view.transmission || std::abs(view.platform_angle_rad) > 0.6) continue;  // grazing light: threads are dark
    // Red silk on a black frame: inside the mask the red channel leads; a ring just outside it is grey.
    double inside_red = 0, inside_blue = 0;
    for (int row = 0; row < view.view.mask.rows; ++row)
      for (int column = 0; column < view.view.mask.cols; ++column)
        if (view.view.mask(row, column)) {
          inside_red += view.view.image(row, column)[0];
          inside_blue += view.view.image(row, column)[2];
        }
    EXPECT_GT(inside_red, 1.25 * inside_blue) << view.view.id;
    // The sheet is 68 x 25 mm, at about 4 pixels to the millimetre and foreshortened: a mask much larger or smaller is
    // wrong.
    EXPECT_GT(view.masked_pixels, 0.5 * 68 * 25 * 16 * 0.5) << view.view.id;
    EXPECT_LT(view.masked_pixels, 1.2 * 68 * 25 * 16) << view.view.id;
  }
}

TEST_F(Workflow, ReportOpensInABrowserWithoutAConsoleError) {
  const fs::path session = path("session");
  expect_success(run_threadstation({"report", session}));
  const std::string profile = path("browser");
  const ProgramResult browser = run_shell(
      "chromium --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
      "--disable-component-update --disable-sync --user-data-dir='" +
      profile + "' --enable-logging=stderr --dump-dom 'file://" + (session / "report.html").string() + "'");
  EXPECT_EQ(browser.status, 0) << browser.error;
  EXPECT_EQ(browser.error.find("CONSOLE"), std::string::npos) << browser.error;
  std::size_t pictures = 0;
  for (std::size_t at = browser.out.find("<img"); at != std::string::npos; at = browser.out.find("<img", at + 1))
    ++pictures;
  EXPECT_GE(pictures, 34U) << "a picture and a mask for each of the 17 views";
  EXPECT_EQ(browser.out.find("src=\"http"), std::string::npos) << "the page needs no network";
}

TEST_F(Workflow, APulledPlugAtTwentyRandomMomentsLosesAndDoublesNothing) {
  using Seconds = std::chrono::duration<double>;
  const std::string timed = path("timed");
  const auto start = std::chrono::steady_clock::now();
  const std::vector<std::string> hasty = hasty_capture_arguments(timed);
  expect_success(run_threadstation(hasty));
  const double whole_s = Seconds(std::chrono::steady_clock::now() - start).count();
  std::mt19937 random(20260);
  std::uniform_real_distribution<double> moment_s(0, whole_s);
  int killed = 0;
  for (int run = 0; run < 20; ++run) {
    const std::string session = path("killed-" + std::to_string(run));
    const pid_t process = start_threadstation(hasty_capture_arguments(session));
    std::this_thread::sleep_for(Seconds(moment_s(random)));  // the moment of the kill is what is tested
    ::kill(process, SIGKILL);
    killed += wait_for(process) == 128 + SIGKILL;
    const bool begun = fs::exists(session + "/session.json");
    expect_success(begun ? run_threadstation({"capture", "--resume", "--out", session, "--quiet"})
                         : run_threadstation(hasty_capture_arguments(session)));
    const ProgramResult verified = run_threadstation({"verify", session, "--json"});
    expect_success(verified);
    EXPECT_TRUE(json::parse(verified.out)["complete"]) << verified.out;
    std::set<std::string> views;
    int files = 0;
    for (const auto& entry : fs::directory_iterator(session + "/raw")) {
      const std::string name = entry.path().filename();
      EXPECT_EQ(entry.path().extension(), ".arw") << name << " is left over";
      if (name.starts_with("reflection") || name.starts_with("transmission")) ++files, views.insert(name);
    }
    EXPECT_EQ(files, 17);
    EXPECT_EQ(views.size(), 17U);
    fs::remove_all(session);
  }
  EXPECT_GE(killed, 10) << "most runs must have been killed before their end";
}

TEST_F(Workflow, CtrlCStopsThePlatformAndLeavesASessionThatResumes) {
  const std::string session = path("interrupted");
  const pid_t process = start_threadstation(hasty_capture_arguments(session));
  // Until the first view is stored, or the session has ended without it.
  const auto ended = [&] {
    std::ifstream file(session + "/journal.jsonl");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    return text.find("\"event\":\"stop\"") != std::string::npos;
  };
  while (!fs::exists(session + "/raw/reflection-horizontal-1.arw") && !ended())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ::kill(process, SIGINT);
  EXPECT_EQ(wait_for(process), 1);
  std::ifstream journal(session + "/journal.jsonl");
  std::string line, last;
  while (std::getline(journal, line)) last = line;
  EXPECT_NE(last.find("\"paused\""), std::string::npos) << last;
  expect_success(run_threadstation({"capture", "--resume", "--out", session, "--quiet"}));
  expect_success(run_threadstation({"verify", session}));
}

TEST_F(Workflow, AFullDiskAndAReadOnlyFolderGetOneLine) {
  // A small file system in a mount namespace of its own, so that it goes away with the command.
  const std::string mount = path("mount");
  fs::create_directory(mount);
  const std::string capture = std::string("'") + THREADSTATION_PROGRAM + "' capture --rig '" + path("rig.json") +
                              "' --calibration '" + path("calibration") + "' --spool '" + DATA_DIR +
                              "/spools/silk_red.json' --unattended --quiet --out '" + mount + "/session'";
  const auto on_file_system = [&](const std::string& options) {
    const std::string unshare =
        ::geteuid() == 0 ? "unshare -m --propagation unchanged" : "unshare -rm --propagation unchanged";
    return run_shell(unshare + " sh -c \"mount -t tmpfs -o " + options + " tmpfs '" + mount + "' || exit 9; " +
                     capture + "; status=\\$?; umount '" + mount + "'; exit \\$status\"");
  };
  expect_one_line(on_file_system("size=1500k"), "1 MB free");  // row 25: before anything is written
  expect_one_line(on_file_system("ro"), "Read-only file system");
}

TEST_F(Workflow, WrongUseEndsWithTwoAndOneLine) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"capture", "--out", "x"},
        {"nonsense"},
        {},
        {"calibrate"},
        {"develop"},
        {"demo", "--fast"},
        {"capture", "--resume", "--rig", "r", "--out", "x"},
        {"calibrate", "--rig", "r", "--out", "o", "--only", "everything"}}) {
    const ProgramResult result = run_threadstation(arguments);
    EXPECT_EQ(result.status, 2) << result.error;
    EXPECT_EQ(result.error_lines(), 1) << result.error;
  }
  EXPECT_EQ(run_threadstation({"--help"}).status, 0);
  EXPECT_EQ(run_threadstation({"capture", "--help"}).status, 0);
}

TEST_F(Workflow, WrongFilesGetOneLineThatNamesThem) {
  const std::string out = path("never");
  const auto with_rig = [&](const std::string& rig) {
    return run_threadstation({"calibrate", "--rig", rig, "--out", out});
  };
  expect_one_line(with_rig(path("no_such.json")), "no_such.json");
  expect_one_line(with_rig(std::string(DATA_DIR) + "/spools/silk_red.json"), "threadstation/spool");
  json rig = station::read_json_file(path("rig.json"));
  rig["colour"] = "red";
  station::write_json_file(path("unknown_key.json"), rig);
  expect_one_line(with_rig(path("unknown_key.json")), "\"colour\"");
  const std::string text = rig.dump();
  std::ofstream(path("cut.json")) << text.substr(0, text.size() / 3);
  expect_one_line(with_rig(path("cut.json")), "cut.json");
  expect_one_line(run_threadstation({"verify", path("calibration")}), "session");
  expect_one_line(run_threadstation({"develop", path("nowhere")}), "nowhere");
  expect_one_line(capture(path("session")), "already");
  rig = station::read_json_file(path("rig.json"));
  rig["simulation"]["sensor"]["width_px"] = 300;
  station::write_json_file(path("other_sensor.json"), rig);
  expect_one_line(run_threadstation(capture_arguments(out, "other_sensor.json")), "300 x 400");
  EXPECT_FALSE(fs::exists(out)) << "a refused command leaves nothing behind";
}

TEST_F(Workflow, ADamagedSessionIsNamedByVerifyAndRefusedByDevelop) {
  const fs::path session = path("damaged");
  fs::copy(path("session"), session, fs::copy_options::recursive);
  const fs::path picture = session / "raw" / "transmission-3.arw";
  fs::resize_file(picture, fs::file_size(picture) / 2);
  expect_one_line(run_threadstation({"develop", session, "--quiet"}), "transmission-3.arw");
  const ProgramResult verified = run_threadstation({"verify", session});
  EXPECT_EQ(verified.status, 1);
  EXPECT_NE(verified.error.find("transmission-3.arw"), std::string::npos) << verified.error;
}

}  // namespace
}  // namespace station_test
