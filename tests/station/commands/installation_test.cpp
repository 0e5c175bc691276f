// The program as it is installed: in a folder of its own, and the checkout it was built from not to be seen.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <set>
#include <sstream>

#include "station/documents/reader.h"
#include "station/documents/thread_file.h"
#include "tests/places.h"
#include "tests/station/commands/help.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;

std::string content(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Installation : testing::Test {
  static void SetUpTestSuite() {
    folder = new TemporaryFolder;
    const ProgramResult installed =
        run_shell("cmake --install '" BUILD_DIR "' --strip --prefix '" + prefix().string() + "' 2>&1");
    ASSERT_EQ(installed.status, 0) << installed.out;
  }
  static void TearDownTestSuite() { delete folder; }
  static fs::path prefix() { return *folder / "usr"; }
  // A line of the shell with the installed program in its path, where the checkout is an empty folder.
  static ProgramResult run_without_checkout(const std::string& line) {
    std::ofstream(*folder / "line.sh") << "mount -t tmpfs none '" SOURCE_DIR "' || exit 9\ncd '"
                                       << folder->path().string() << "'\nPATH='" << (prefix() / "bin").string()
                                       << "':$PATH\n"
                                       << line << "\n";
    return run_shell("cd / && " + std::string(kUnshare) + " sh '" + (*folder / "line.sh").string() + "'");
  }
  // What is mounted there must not be seen outside, so the mounts become private, which a system may refuse.
  void SetUp() override {
    if (run_shell(std::string(kUnshare) + " true").status != 0)
      GTEST_SKIP() << "this system lets nobody hide the checkout from a program (" << kUnshare << ")";
  }
  static inline const char* const kUnshare = ::geteuid() == 0 ? "unshare -m" : "unshare -rm";
  static inline TemporaryFolder* folder = nullptr;
};

TEST_F(Installation, HasTheProgramItsDataAndWhatSystemAndShellsAskFor) {
  std::set<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(prefix()))
    if (!entry.is_directory()) files.insert(entry.path().lexically_relative(prefix()));
  const std::set<std::string> expected{"bin/threadstation",
                                       "bin/threadstation-page",
                                       "lib/systemd/user/threadstation.service",
                                       "lib/udev/rules.d/70-threadstation.rules",
                                       "share/applications/threadstation.desktop",
                                       "share/bash-completion/completions/threadstation",
                                       "share/doc/threadstation/changelog.gz",
                                       "share/doc/threadstation/copyright",
                                       "share/icons/hicolor/scalable/apps/threadstation.svg",
                                       "share/man/man1/threadstation-page.1.gz",
                                       "share/man/man1/threadstation-render.1.gz",
                                       "share/man/man1/threadstation-scatter-eval.1.gz",
                                       "share/man/man1/threadstation.1.gz",
                                       "share/zsh/vendor-completions/_threadstation"};
  EXPECT_THAT(files, IsSupersetOf(expected));
  std::set<std::string> data;
  for (const auto& entry : fs::recursive_directory_iterator(DATA_DIR)) {
    const std::string name = entry.path().lexically_relative(DATA_DIR), kind = entry.path().extension();
    if (entry.is_regular_file() && kind != ".h" && kind != ".cpp" && name != "CMakeLists.txt")
      data.insert("share/threadstation/" + name);
  }
  EXPECT_GT(data.size(), 80U);
  EXPECT_THAT(files, IsSupersetOf(data)) << "name the new folder in station/data/CMakeLists.txt";
}

// The example of demo, and more; nothing of it may need the checkout.
TEST_F(Installation, DoesTheWholeJobWithoutTheCheckoutAndRunAgainKeepsItsPictures) {
  const ProgramResult first = run_without_checkout(example_of({"demo"}) + " --quick --json");
  ASSERT_EQ(first.status, 0) << first.error;
  const json said = json::parse(first.out);
  const auto there = [](const json& file) { return fs::exists(*folder / file.get<std::string>()); };
  EXPECT_TRUE(there(said["report"]));
  EXPECT_EQ(station::read_thread(*folder / said["thread"].get<std::string>()).name, "silk, blue");
  EXPECT_LT(said["relative_rmse"].get<double>(), 0.25);  // noisy pictures; FittedThreads has the real ones
  ASSERT_EQ(said["cloth"].size(), 2U);
  for (const json& picture : said["cloth"]) EXPECT_TRUE(there(picture));
  EXPECT_TRUE(there("demo/session/result/contact_sheet.png"));
  EXPECT_EQ(run_without_checkout("threadstation verify demo/session").status, 0);
  const auto pictures = [] {
    return run_shell("cd '" + (*folder / "demo").string() + "' && sha256sum calibration/pictures/* session/raw/*").out;
  };
  const std::string before = pictures();
  const ProgramResult again = run_without_checkout(example_of({"demo"}) + " --quick --quiet");
  EXPECT_EQ(again.status, 0) << again.error;
  EXPECT_THAT(again.out, HasSubstr("kept"));
  EXPECT_EQ(pictures(), before);
  fs::create_directory(*folder / "somebody");
  std::ofstream(*folder / "somebody/letter.txt") << "not ours";
  const ProgramResult refused = run_without_checkout("threadstation demo --out somebody");
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.error, HasSubstr("not an earlier demo"));
  EXPECT_TRUE(there("somebody/letter.txt"));
}

TEST_F(Installation, RendersAReadySceneWithoutTheCheckout) {
  const ProgramResult rendered = run_without_checkout(
      "ls '" SOURCE_DIR "'; threadstation render '" +
      (prefix() / "share/threadstation/scenes/plain_swatch.json").string() + "' --spp 1 --out swatch.png");
  EXPECT_EQ(rendered.status, 0) << rendered.error;
  EXPECT_THAT(rendered.out, Not(HasSubstr("CMakeLists.txt"))) << "the checkout is hidden";
  EXPECT_TRUE(fs::exists(*folder / "swatch.png"));
}

TEST_F(Installation, NamesItsOwnFolderAndNotTheCheckout) {
  for (const char* file : {"share/bash-completion/completions/threadstation", "bin/threadstation-page",
                           "lib/systemd/user/threadstation.service", "share/applications/threadstation.desktop"})
    EXPECT_THAT(content(prefix() / file), Not(HasSubstr(SOURCE_DIR))) << file;
  const std::string pages = run_shell("zcat '" + (prefix() / "share/man/man1").string() + "'/*.gz").out;
  EXPECT_THAT(pages, Not(HasSubstr(SOURCE_DIR)));
}

TEST_F(Installation, HasManPagesThatSayWhatHelpSays) {
  const auto page = [](const std::string& name) {
    return run_shell("MANWIDTH=120 man -l '" + (prefix() / "share/man/man1" / (name + ".1.gz")).string() + "'").out;
  };
  EXPECT_THAT(page("threadstation-render"), HasSubstr("a scene of cloth to a picture"));
  EXPECT_THAT(page("threadstation-render"), HasSubstr("threadstation-render - a scene"));
  EXPECT_THAT(page("threadstation-render"), HasSubstr("--spp"));
  EXPECT_THAT(page("threadstation-render"),
              HasSubstr((prefix() / "share/threadstation/scenes/plain_swatch.json").string()));
  EXPECT_THAT(page("threadstation"), HasSubstr("validate-cloth"));
}

TEST_F(Installation, HasADesktopEntryAnIconAndAServiceThatAreWellFormed) {
  const ProgramResult entry = run_shell("desktop-file-validate '" +
                                        (prefix() / "share/applications/threadstation.desktop").string() + "' 2>&1");
  EXPECT_EQ(entry.status, 0) << entry.out;
  EXPECT_EQ(entry.out, "");
  EXPECT_THAT(content(prefix() / "share/icons/hicolor/scalable/apps/threadstation.svg"), HasSubstr("</svg>"));
  const std::string service = content(prefix() / "lib/systemd/user/threadstation.service");
  EXPECT_THAT(service, HasSubstr("ExecStart=threadstation-page --serve"));
  EXPECT_THAT(service, HasSubstr("KillMode=process")) << "a run goes on when the page ends";
}

// What udev would do: each rule is one line of keys with values in quotes.
TEST_F(Installation, HasRulesForCamerasAndSerialAdapters) {
  const std::string rules = content(prefix() / "lib/udev/rules.d/70-threadstation.rules");
  std::istringstream lines(rules);
  for (std::string line; std::getline(lines, line);)
    EXPECT_THAT(line,
                testing::AnyOf("", testing::StartsWith("#"),
                               testing::MatchesRegex("([A-Z]+(\\{[A-Za-z_]+\\})?(==|!=|=|\\+=)\"[^\"]*\"(, )?)+")))
        << line;
  EXPECT_THAT(rules, ContainsRegex("060101.*GROUP=\"plugdev\""));
  EXPECT_THAT(rules, ContainsRegex("SUBSYSTEMS==\"usb\".*GROUP=\"dialout\""));
  EXPECT_THAT(rules, ContainsRegex("0403.*ID_MM_DEVICE_IGNORE"));
}

TEST_F(Installation, ServesThePageOfTheSimulatedBenchToSomebodyWhoHasNoneYet) {
  const ProgramResult served = run_without_checkout(
      "export HOME=\"$PWD/home\" XDG_CONFIG_HOME=\"$PWD/config\"; mkdir -p home config/threadstation; "
      "echo port=0 >config/threadstation/page.conf; threadstation-page --serve >served & "
      "until grep -q http:// served; do kill -0 $! || break; sleep 0.1; done; kill -INT $!; wait $!; cat served");
  EXPECT_EQ(served.status, 0) << served.error;
  EXPECT_THAT(served.out, HasSubstr("is now the simulated bench"));
  EXPECT_EQ(station::read_json_file(*folder / "home/threadstation/rig.json"),
            station::read_json_file(std::string(DATA_DIR) + "/rigs/simulated.json"));
}

}  // namespace
}  // namespace station_test
