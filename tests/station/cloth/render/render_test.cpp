// The render command, as a person types it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "renderer/picture/image_file.h"
#include "station/cloth/render/render_scene.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/cloth/render/small_scene.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

using nlohmann::json;

// Reads progress until it says more than that it begins: at its first line nothing may have been drawn yet.
const std::string kUntilItGoesOn = "while read said; do case $said in *' 0/100 %') ;; *) break ;; esac; done";

class Render : public ::testing::Test {
 protected:
  std::string written(const std::string& name, const json& scene) {
    station::write_json_file(folder_ / name, scene);
    return folder_ / name;
  }
  ProgramResult render(const std::string& scene, const std::string& out, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"render", scene, "--out", folder_ / out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_threadstation(arguments);
  }
  void expect_one_line(const ProgramResult& result, const std::string& must_name) {
    EXPECT_EQ(result.status, 1) << result.error;
    EXPECT_EQ(result.error_lines(), 1) << result.error;
    EXPECT_NE(result.error.find(must_name), std::string::npos) << result.error;
  }
  // Interrupted as soon as progress is said, after that it begins; `out` then is what it said from then on.
  ProgramResult interrupted_render(const std::string& scene, const std::string& out, const std::string& more = {}) {
    const std::string pipe = folder_ / "pipe";
    const std::string command =
        std::string(THREADSTATION_PROGRAM) + " render " + scene + " --out " + (folder_ / out).string() + more;
    return run_shell("mkfifo " + pipe + "; " + command + " 2> " + pipe + " & program=$!; { " + kUntilItGoesOn +
                     "; kill -INT $program; cat; } < " + pipe + "; wait $program; status=$?; rm " + pipe +
                     "; exit $status");
  }
  TemporaryFolder folder_;
};

TEST_F(Render, WritesLinearAndDisplayPictures) {
  const std::string scene = written("scene.json", small_scene("plain_swatch"));
  const ProgramResult exr = render(scene, "a.exr", {"--json"});
  ASSERT_EQ(exr.status, 0) << exr.error;
  const json report = json::parse(exr.out);
  EXPECT_EQ(report.at("samples"), 40 * 40 * 2);
  EXPECT_GT(report.at("rays"), report.at("samples"));
  renderer::ImageHeader header;
  const cv::Mat3f linear = renderer::read_exr(folder_ / "a.exr", &header);
  EXPECT_EQ(linear.size(), cv::Size(40, 40));
  EXPECT_GT(cv::mean(linear)[0], 1.5 * cv::mean(linear)[2]) << "red and gold threads";
  EXPECT_EQ(header.at("threadstation/scene"), "plain cloth, light from the front");
  const ProgramResult png = render(scene, "a.png", {"--time", "--quiet", "--exposure", "3"});
  ASSERT_EQ(png.status, 0) << png.error;
  EXPECT_NE(png.out.find("samples/s"), std::string::npos) << png.out;
  EXPECT_EQ(png.error, "");
  EXPECT_GT(std::filesystem::file_size(folder_ / "a.png"), 100u);
}

TEST_F(Render, TheSameSeedGivesTheSamePictureOnAnyNumberOfThreads) {
  const std::string scene = written("scene.json", small_scene("satin_cylinder"));
  ASSERT_EQ(render(scene, "a.exr", {"--seed", "5", "--threads", "1"}).status, 0);
  ASSERT_EQ(render(scene, "b.exr", {"--seed", "5", "--threads", "2"}).status, 0);
  ASSERT_EQ(render(scene, "c.exr", {"--seed", "6"}).status, 0);
  const cv::Mat3f a = renderer::read_exr(folder_ / "a.exr");
  EXPECT_EQ(cv::norm(a, renderer::read_exr(folder_ / "b.exr"), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(a, renderer::read_exr(folder_ / "c.exr"), cv::NORM_INF), 0);
}

TEST_F(Render, APictureToLookAtStandsBesideTheOneToMeasureIn) {
  const std::string scene = written("scene.json", small_scene("plain_swatch"));
  ASSERT_EQ(render(scene, "a.exr", {"--spp", "64"}).status, 0);
  const ProgramResult smooth = render(scene, "b.exr", {"--spp", "64", "--denoise", "--png"});
  ASSERT_EQ(smooth.status, 0) << smooth.error;
  const cv::Mat3f noisy = renderer::read_exr(folder_ / "b.exr");
  EXPECT_EQ(cv::norm(noisy, renderer::read_exr(folder_ / "a.exr"), cv::NORM_INF), 0) << "what it would be without";
  renderer::ImageHeader header;
  const cv::Mat3f denoised = renderer::read_exr(folder_ / "b.denoised.exr", &header);
  EXPECT_NE(header.at("threadstation/content").find("measure in the picture beside it"), std::string::npos);
  EXPECT_GT(cv::norm(denoised, noisy), 0);
  EXPECT_NEAR(cv::mean(denoised)[1] / cv::mean(noisy)[1], 1, 0.05);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "b.denoised.png"));
  expect_one_line(render(scene, "c.exr", {"--spp", "16", "--denoise"}), "give --spp 32 or more");
}

// As bright as its exposure says, which is one over the card's radiance.
TEST_F(Render, AWhiteCardExposesThePicture) {
  json scene = small_scene("plain_swatch");
  scene["lights"] = {{{"kind", "environment"}, {"radiance", {0.25, 0.25, 0.25}}, {"visible", false}}};
  scene["white_card"] = {{"position_mm", {0, 0, 0}}, {"normal", {0, 0, 1}}};
  const ProgramResult by_card = render(written("card.json", scene), "card.png", {"--json"});
  ASSERT_EQ(by_card.status, 0) << by_card.error;
  EXPECT_NEAR(json::parse(by_card.out).at("exposure").get<double>(), 4, 0.01);
  const ProgramResult by_hand = render(folder_ / "card.json", "hand.png", {"--json", "--exposure", "2"});
  EXPECT_EQ(json::parse(by_hand.out).at("exposure"), 2);
  scene["lights"] = {
      {{"kind", "sphere"}, {"position_mm", {0, 0, -90}}, {"radius_mm", 5}, {"intensity_mm2", {9e4, 9e4, 9e4}}}};
  expect_one_line(render(written("dark.json", scene), "dark.png"), "no light reaches its face");
}

TEST_F(Render, BadFilesGiveOneClearLine) {
  const json good = small_scene("plain_swatch");
  expect_one_line(render(folder_ / "none.json", "a.exr"), "no such file");
  expect_one_line(render(written("scene.json", good), "a.jpg"), "expected .exr");
  expect_one_line(render(written("scene.json", good), "no/such/a.exr"), "there is no folder");
  json bad = good;
  bad["cloths"][0]["weft_threads"] = {7};
  expect_one_line(render(written("scene.json", bad), "a.exr"), "has a yarn of thread 7");
  bad = good;
  bad["threads"][1] = "thread.json";
  written("thread.json", {{"format", "threadstation/thread"}, {"version", 1}, {"name", "empty"}});
  expect_one_line(render(written("scene.json", bad), "a.exr"), "thread.json: key \"diameter_mm\": is missing");
  bad = good;
  bad["cloths"][0]["shape"] = {{"kind", "cylinder"}, {"radius_mm", 0.1}, {"height_mm", 5}};
  expect_one_line(render(written("scene.json", bad), "a.exr"), "cannot hold one repeat");
  bad["cloths"][0]["shape"]["radius_mm"] = 0.35;
  expect_one_line(render(written("scene.json", bad), "a.exr"), "bends more sharply");
  bad = good;
  bad["cloths"][0]["shape"]["width_mm"] = bad["cloths"][0]["shape"]["height_mm"] = 1e4;
  bad["cloths"][0]["method"] = "brute_force";
  expect_one_line(render(written("scene.json", bad), "a.exr"), "use two_scale");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.exr"));
  const ProgramResult wrong_use = render(written("scene.json", good), "a.exr", {"--spp", "0"});
  EXPECT_EQ(wrong_use.status, 2) << wrong_use.error;
}

TEST_F(Render, CtrlCLeavesACheckpointFromWhichTheSameCommandEndsWithTheSamePicture) {
  json scene = small_scene("plain_swatch");
  scene["samples_per_pixel"] = 400;
  const std::string file = written("scene.json", scene);
  ASSERT_EQ(render(file, "whole.exr").status, 0);
  const ProgramResult stopped = interrupted_render(file, "a.exr");
  EXPECT_EQ(stopped.status, 1) << stopped.out << stopped.error;
  EXPECT_NE(stopped.out.find("threadstation: rendering was stopped on request"), std::string::npos) << stopped.out;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.exr"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "a.exr.checkpoint"));
  EXPECT_GT(std::filesystem::file_size(folder_ / "a.preview.png"), 100u);
  const ProgramResult finished = render(file, "a.exr", {"--json"});
  ASSERT_EQ(finished.status, 0) << finished.error;
  const json report = json::parse(finished.out);
  EXPECT_GT(report.at("samples_before"), 0);
  EXPECT_EQ(report.at("samples").get<int>() + report.at("samples_before").get<int>(), 40 * 40 * 400);
  EXPECT_EQ(station::sha256_of_file(folder_ / "a.exr"), station::sha256_of_file(folder_ / "whole.exr"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.exr.checkpoint"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.preview.png"));
}

TEST_F(Render, AnotherRenderingsCheckpointIsRefusedInOneLineUntilItIsThrownAway) {
  json scene = small_scene("plain_swatch");
  const json as_it_was = station::read_json_file(scene["threads"][0].get<std::string>());
  written("thread.json", as_it_was);
  scene["threads"][0] = "thread.json";
  const std::string file = written("scene.json", scene);
  ASSERT_EQ(interrupted_render(file, "a.exr", " --spp 4000").status, 1);
  const auto refused = [&](const std::vector<std::string>& more, const std::string& must_name) {
    const ProgramResult result = render(file, "a.exr", more);
    expect_one_line(result, must_name);
    EXPECT_NE(result.error.find("a.exr.checkpoint"), std::string::npos) << result.error;
    EXPECT_NE(result.error.find("--fresh"), std::string::npos) << result.error;
  };
  refused({}, "samples per pixel 4000, not 2");
  refused({"--spp", "4000", "--seed", "9"}, "seed 1, not 9");
  json thread = as_it_was;
  thread["diameter_mm"] = 0.7;
  written("thread.json", thread);
  refused({"--spp", "4000"}, "another scene");
  written("thread.json", as_it_was);
  const std::filesystem::path checkpoint = folder_ / "a.exr.checkpoint";
  const auto spoil = [&](std::streamoff at) {
    std::fstream bytes(checkpoint, std::ios::in | std::ios::out | std::ios::binary);
    bytes.seekp(at, std::ios::end);
    bytes.put('?');
  };
  spoil(-5000);
  refused({"--spp", "4000"}, "damaged");
  std::filesystem::resize_file(checkpoint, 3000);
  refused({"--spp", "4000"}, "cut short");
  ASSERT_EQ(render(file, "a.exr", {"--fresh"}).status, 0);
  ASSERT_EQ(render(file, "b.exr").status, 0);
  EXPECT_EQ(station::sha256_of_file(folder_ / "a.exr"), station::sha256_of_file(folder_ / "b.exr"));
  EXPECT_FALSE(std::filesystem::exists(checkpoint));
}

TEST_F(Render, APictureThatCannotBeWrittenStaysAsACheckpointFromWhichTheSameCommandWritesIt) {
  json scene = small_scene("plain_swatch");
  scene["samples_per_pixel"] = 32;
  const std::string file = written("scene.json", scene), picture = folder_ / "a.exr";
  ASSERT_EQ(render(file, "whole.exr").status, 0);
  std::filesystem::create_directory(picture);  // nothing can take its name
  try {
    station::render_scene({.scene = file, .out = picture, .progress = station::ProgressStyle::quiet});
    ADD_FAILURE() << "nothing was refused";
  } catch (const std::runtime_error& error) {
    const std::string line = error.what();
    EXPECT_NE(line.find("Is a directory"), std::string::npos) << line;
    EXPECT_NE(line.find("the same command then writes the picture"), std::string::npos) << line;
  }
  std::filesystem::remove(picture);
  const ProgramResult finished = render(file, "a.exr", {"--json"});
  ASSERT_EQ(finished.status, 0) << finished.error;
  EXPECT_EQ(json::parse(finished.out).at("samples"), 0) << "all of them were there";
  EXPECT_EQ(station::sha256_of_file(picture), station::sha256_of_file(folder_ / "whole.exr"));
  EXPECT_FALSE(std::filesystem::exists(picture + ".checkpoint"));
}

// A disk of its own, in memory, that is filled as soon as a rendering to $disk/a.exr has begun. The words of its script
// are $disk, $program, which renders, and `render`, which does the same once more.
class FullDisk : public Render {
 protected:
  void SetUp() override {
    if (run_shell("unshare -rm true").status != 0)
      GTEST_SKIP() << "this system lets its users have no disks of their own (unshare --map-root-user --mount)";
    json scene = small_scene("plain_swatch");
    scene["samples_per_pixel"] = 400;
    scene_ = written("scene.json", scene);
    ASSERT_EQ(render(scene_, "whole.exr").status, 0);
  }
  // `begun`: what happens once the disk is full and the rendering is not over yet.
  ProgramResult on_disk(const std::string& kilobytes, const std::string& begun, const std::string& then) {
    const std::string disk = folder_ / "disk";
    std::filesystem::create_directory(disk);
    std::ofstream script(folder_ / "script");
    script << "disk=" << disk << " pipe=" << folder_ / "pipe"
           << "\nrender() { " << THREADSTATION_PROGRAM << " render " << scene_ << " --out $disk/a.exr $*; }\n"
           << "mount -t tmpfs -o size=" << kilobytes << "k tmpfs $disk && mkfifo $pipe\n"
           << THREADSTATION_PROGRAM << " render " << scene_ << " --out $disk/a.exr 2> $pipe & program=$!\n"
           << "{ " << kUntilItGoesOn << "; kill -STOP $program; cat /dev/zero > $disk/fill 2> /dev/null\n"
           << begun << "\nkill -CONT $program; echo \"$said\"; cat; } < $pipe\n"
           << "wait $program; status=$?\n"
           << then << "\nexit $status\n";
    script.close();
    return run_shell("unshare -rm sh " + (folder_ / "script").string());
  }
  void expect_the_whole_picture() {
    EXPECT_EQ(station::sha256_of_file(folder_ / "a.exr"), station::sha256_of_file(folder_ / "whole.exr"));
  }
  std::string scene_;
};

TEST_F(FullDisk, AtTheEndOfARenderingThePictureFindsTheRoomThatWasHeldForIt) {
  const ProgramResult said = on_disk("400", "", "cp $disk/a.exr " + (folder_ / "a.exr").string());
  ASSERT_EQ(said.status, 0) << said.out << said.error;
  expect_the_whole_picture();
}

TEST_F(FullDisk, AnInterruptedRenderingLeavesItsCheckpointWithWhichTheSameCommandGoesOn) {
  const ProgramResult said = on_disk(
      "400", "kill -INT $program",
      "ls $disk/a.exr.checkpoint && rm $disk/fill && render --json && cp $disk/a.exr " + (folder_ / "a.exr").string());
  ASSERT_EQ(said.status, 1) << said.out << said.error;
  EXPECT_NE(said.out.find("the same command goes on with it"), std::string::npos) << said.out;
  expect_the_whole_picture();
}

TEST_F(FullDisk, WithoutRoomARenderingDoesNotEvenBegin) {
  const ProgramResult said = on_disk("64", "", "");
  EXPECT_EQ(said.status, 1) << said.out << said.error;
  EXPECT_NE(said.out.find("there is no room for 0.2 MB in"), std::string::npos) << said.out;
}

TEST_F(Render, CheckpointsNowAndThenDoNotChangeThePicture) {
  json scene = small_scene("plain_swatch");
  scene["samples_per_pixel"] = 32;
  const std::string file = written("scene.json", scene);
  ASSERT_EQ(render(file, "a.exr").status, 0);
  station::render_scene(
      {.scene = file, .out = folder_ / "b.exr", .checkpoint_every_s = 0.1, .progress = station::ProgressStyle::quiet});
  EXPECT_EQ(station::sha256_of_file(folder_ / "a.exr"), station::sha256_of_file(folder_ / "b.exr"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "b.exr.checkpoint"));
}

TEST_F(Render, LayersAreNamedChannelsBesideTheSameColours) {
  json scene = small_scene("satin_cylinder");
  scene["samples_per_pixel"] = 4;
  const std::string file = written("scene.json", scene);
  ASSERT_EQ(render(file, "a.exr").status, 0);
  ASSERT_EQ(render(file, "layers.exr", {"--layers"}).status, 0);
  ASSERT_EQ(render(file, "half.exr", {"--layers", "--half"}).status, 0);
  const cv::Mat3f colours = renderer::read_exr(folder_ / "a.exr");
  EXPECT_EQ(cv::norm(colours, renderer::read_exr(folder_ / "layers.exr"), cv::NORM_INF), 0);
  EXPECT_LT(cv::norm(colours, renderer::read_exr(folder_ / "half.exr")), 1e-3 * cv::norm(colours));
  EXPECT_LT(std::filesystem::file_size(folder_ / "half.exr"), std::filesystem::file_size(folder_ / "layers.exr"));
  std::map<std::string, renderer::ExrChannel> channels, halves;
  for (const auto& channel : renderer::read_exr_channels(folder_ / "layers.exr")) channels[channel.name] = channel;
  for (const auto& channel : renderer::read_exr_channels(folder_ / "half.exr")) halves[channel.name] = channel;
  EXPECT_EQ(channels.size(), 13u);
  // The cylinder's middle, 41 mm before its axis and 700 mm minus that from the eye, faces the camera.
  const auto middle = [&](const std::string& name) { return channels.at(name).plane.at<float>(25, 16); };
  EXPECT_NEAR(middle("depth.Z"), 665, 10);
  EXPECT_GT(middle("normal.X"), 0.5f);
  EXPECT_EQ(middle("cover.A"), 1);
  EXPECT_GT(middle("albedo.B"), middle("albedo.R")) << "blue warp";
  EXPECT_TRUE(halves.at("albedo.B").half && !halves.at("depth.Z").half);
  EXPECT_EQ(cv::norm(halves.at("yarn.id").plane, channels.at("yarn.id").plane, cv::NORM_INF), 0);
  std::set<int> threads, yarns;
  for (const int id : cv::Mat1i(channels.at("thread.id").plane)) threads.insert(id);
  for (const int id : cv::Mat1i(channels.at("yarn.id").plane)) yarns.insert(id);
  EXPECT_EQ(threads, (std::set<int>{0, 1, 2})) << "the table, warp, weft";
  EXPECT_GT(yarns.size(), 50u);
  expect_one_line(render(file, "a.png", {"--layers"}), "--layers and --half are for EXR files");
}

TEST_F(Render, SeveralScenesGoIntoOneFolderAndWhatIsThereIsKept) {
  json slow = small_scene("satin_swatch");
  slow["samples_per_pixel"] = 400;
  const std::string first = written("first.json", small_scene("plain_swatch")), second = written("second.json", slow),
                    third = written("third.json", small_scene("twill_swatch"));
  ASSERT_EQ(render(second, "alone.exr").status, 0);
  ASSERT_EQ(render(first, "pictures", {"--quiet"}).status, 0) << "a name without an ending is a folder";
  ASSERT_TRUE(std::filesystem::exists(folder_ / "pictures" / "first.png"));
  const auto written_at = std::filesystem::last_write_time(folder_ / "pictures" / "first.exr");
  const ProgramResult stopped = interrupted_render(first + " " + second + " " + third, "pictures");
  EXPECT_EQ(stopped.status, 1);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "pictures" / "second.exr.checkpoint"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "pictures" / "third.exr"));
  const ProgramResult finished = render(first, "pictures", {second, third, "--json"});
  ASSERT_EQ(finished.status, 0) << finished.error;
  const json reports = json::parse(finished.out);
  ASSERT_EQ(reports.size(), 3u);
  EXPECT_EQ(reports[0].at("kept"), true);
  EXPECT_EQ(std::filesystem::last_write_time(folder_ / "pictures" / "first.exr"), written_at);
  EXPECT_GT(reports[1].at("samples_before"), 0);
  EXPECT_EQ(reports[2].at("samples_before"), 0);
  EXPECT_EQ(station::sha256_of_file(folder_ / "pictures" / "second.exr"),
            station::sha256_of_file(folder_ / "alone.exr"));
  EXPECT_GT(std::filesystem::file_size(folder_ / "pictures" / "third.png"), 100u);
  const ProgramResult other_seed = render(first, "pictures", {"--seed", "2", "--json"});
  EXPECT_FALSE(json::parse(other_seed.out).contains("kept"));
  expect_one_line(render(first, "pictures", {(folder_ / "pictures" / ".." / "first.json").string()}), "rename one");
  expect_one_line(render(first, "pictures", {folder_ / "none.json"}), "no such file");
  expect_one_line(render(first, "a.exr", {third}), "a.exr");
}

TEST_F(Render, ADraftThatCannotBeWovenIsRefusedBeforeTheFirstSceneIsRendered) {
  json scene = small_scene("plain_swatch"), draft = station::read_json_file(scene["cloths"][0]["draft"]);
  draft["plies"] = {{"count", 2}, {"radius_mm", 5}};
  const std::string good = written("good.json", scene);
  scene["cloths"][0]["draft"] = written("draft.json", draft);
  expect_one_line(render(good, "pictures", {written("bad.json", scene)}), "thicker than its yarn");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "pictures"));
}

TEST_F(Render, ASquareMetreOfSilkTakesLittleMemory) {
  json scene = small_scene("square_metre/scene");
  for (json& thread : scene["threads"])
    thread = std::string(DATA_DIR) + "/scenes/square_metre/../../threads/" +
             std::filesystem::path(thread.get<std::string>()).filename().string();
  scene["cloths"][0]["draft"] = std::string(DATA_DIR) + "/scenes/square_metre/draft.json";
  const ProgramResult result = render(written("scene.json", scene), "a.exr", {"--json"});
  ASSERT_EQ(result.status, 0) << result.error;
  const json memory = json::parse(result.out).at("memory");
  EXPECT_LE(memory.at("control_points_bytes"), 10000);
  EXPECT_LE(memory.at("scene_bytes"), 50e6);
  EXPECT_GT(memory.at("trees_bytes"), 1e5);
  EXPECT_GT(memory.at("surfaces_bytes"), 1e6);
  // As many repeats as square millimetres.
  EXPECT_NEAR(memory.at("explicit_yarns_bytes").get<double>() / memory.at("control_points_bytes").get<double>(), 1e6,
              0.02e6);
}

TEST_F(Render, ANoiseToReachPutsSamplesWhereTheyAreNeeded) {
  const std::string file = written("scene.json", small_scene("satin_cylinder"));
  const ProgramResult result = render(file, "a.exr", {"--noise", "20%", "--spp", "2000", "--json"});
  ASSERT_EQ(result.status, 0) << result.error;
  const json report = json::parse(result.out);
  EXPECT_LT(report.at("noise"), 0.2);
  EXPECT_EQ(report.at("noisy"), 0);
  const double samples = report.at("samples").get<double>() / (33 * 50);
  EXPECT_GE(samples, 64);
  EXPECT_LT(samples, 1000);
  for (const char* wrong : {"0", "1 mm", "200%", "noise"})
    EXPECT_EQ(render(file, "b.exr", {"--noise", wrong}).status, 2) << wrong;
}

}  // namespace
}  // namespace station_test
