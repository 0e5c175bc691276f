// The handbook: its links lead somewhere, its drawings are those that its script makes, its commands exist, and the
// page serves it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>

#include "station/documents/disk/whole_file.h"
#include "station/serve/handbook_page.h"
#include "station/serve/page_answers.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
const fs::path kHandbook = fs::path(SOURCE_DIR) / "station/handbook";

std::vector<fs::path> pages() {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(kHandbook))
    if (entry.path().extension() == ".html") found.push_back(entry.path());
  return found;
}

std::set<std::string> all(const std::string& text, const std::string& pattern) {
  const std::regex wanted(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), wanted), end; it != end; ++it) found.insert((*it)[1]);
  return found;
}

TEST(Handbook, EveryLinkAndPictureIsThereAndEveryPageIsInTheContents) {
  const std::set<std::string> listed =
      all(station::text_of_file(kHandbook / "index.html"), "<li><a href=\"(\\w+\\.html)\"");
  EXPECT_EQ(listed.size() + 1, pages().size());
  std::set<std::string> shown;
  for (const fs::path& page : pages()) {
    const std::string text = station::text_of_file(page);
    for (const std::string& target : all(text, "(?:href|src)=\"([^\"#]+)")) {
      EXPECT_TRUE(fs::exists(kHandbook / target)) << page << ": " << target;
      shown.insert(target);
    }
    for (const std::string& image : all(text, "(<img [^>]*>)"))
      EXPECT_THAT(image, testing::HasSubstr("alt=\"")) << page;
  }
  for (const char* folder : {"drawings", "screens"})
    for (const auto& entry : fs::directory_iterator(kHandbook / folder))
      EXPECT_TRUE(shown.contains(std::string(folder) + "/" + entry.path().filename().string())) << entry.path();
}

TEST(Handbook, ItsDrawingsAreThoseThatItsScriptMakes) {
  const ProgramResult drawn = run_shell((kHandbook / "draw").string() + " --check");
  EXPECT_EQ(drawn.status, 0) << drawn.error;
}

TEST(Handbook, ItsCommandsAreThoseOfTheProgram) {
  std::set<std::string> commands;
  for (const fs::path& page : pages()) {
    const std::string text = station::text_of_file(page);
    for (const std::string& words : all(text, "(?:<code>|<pre>|\\n)threadstation ([a-z-]+(?: (?:new|set-up|camera))?)"))
      commands.insert(words);
  }
  EXPECT_GE(commands.size(), 8U);
  for (const std::string& words : commands) {
    const ProgramResult help = run_shell(std::string(THREADSTATION_PROGRAM) + " " + words + " --help");
    EXPECT_THAT(help.out, testing::HasSubstr("Usage: threadstation " + words)) << help.error;
  }
}

TEST(Handbook, ThePageServesItsFilesAndNoOthers) {
  EXPECT_EQ(station::handbook_page("index.html").content_type, "text/html; charset=utf-8");
  EXPECT_THAT(station::handbook_page("drawings/platform.svg").body, testing::HasSubstr("<svg"));
  for (const char* path : {"../rigs/simulated.json", "..", "", "draw", "drawings/../../rigs/README.md", "/etc/passwd",
                           "drawings/none.svg", "README.md"})
    EXPECT_THROW(station::handbook_page(path), station::Refused) << path;
}

TEST(Handbook, IsMadeIntoOnePdf) {
  const TemporaryFolder folder;
  const ProgramResult made = run_shell((kHandbook / "make_pdf").string() + " " + (folder / "handbook.pdf").string());
  ASSERT_EQ(made.status, 0) << made.error;
  const std::string pdf = station::text_of_file(folder / "handbook.pdf");
  EXPECT_TRUE(pdf.starts_with("%PDF-"));
  EXPECT_GT(pdf.size(), 200'000U) << "with its pictures";
}

}  // namespace
}  // namespace station_test
