// Figures made by commands: small ones of our own, in a folder of data beside the program's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "station/documents/reader.h"
#include "station/reproduce/figure_file.h"
#include "tests/station/commands/own_figures.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using station_test::run_threadstation;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string text_in(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

json drafts(const std::vector<std::string>& names) {
  return json::array({json::array({"draft", names})});
}

struct Reproduce : testing::Test {
  Reproduce() {
    weave = {{"format", "threadstation/figure"},
             {"version", 1},
             {"figure", "8"},
             {"title", "weaves & drafts"},
             {"paper", "shows <two> of them"},
             {"different", "there are fewer"},
             {"steps",
              {{{"for", drafts({"plain", "basket_2_2"})},
                {"quick_for", drafts({"plain"})},
                {"run", "weave --draft {draft} --out {draft}.json --view {draft}.png --json"},
                {"whole", "--height-scale 0.5"}}}},
             {"pictures",
              {{{"for", drafts({"plain", "basket_2_2"})},
                {"quick_for", drafts({"plain"})},
                {"file", "{draft}.png"},
                {"caption", "a patch of {draft}"}},
               {{"pictures", {{{"file", "DATA/motifs/leaf.jpg"}, {"caption", "given"}}}}}}},
             {"numbers",
              {{{"name", "period"},
                {"file", "plain.json"},
                {"at", "/period_x_mm"},
                {"digits", 2},
                {"unit", "mm"},
                {"paper", "1.9 mm"}},
               {{"name", "mean radius"}, {"file", "plain.json"}, {"at", "/yarns/*/radius_mm"}, {"digits", 3}},
               {{"name", "what is not there"}, {"file", "plain.json"}, {"at", "/nothing"}}}}};
  }

  void write(const std::string& name, const json& figure) { figures.write(name, figure); }
  station_test::ProgramResult make(std::vector<std::string> words) {
    words.insert(words.begin(), "reproduce");
    words.insert(words.end(), {"--out", out()});
    return run_threadstation(words);
  }
  std::string out() const { return folder / "figures"; }
  fs::path in_figure(const std::string& name) const { return fs::path(out()) / "figure-8" / name; }

  station_test::TemporaryFolder folder;
  station_test::OwnFigures figures;
  json weave;
};

TEST_F(Reproduce, FiguresAreMadeByTheirCommandsAndShownWithTheirNumbers) {
  write("1.json", weave);
  const auto made = make({});
  ASSERT_EQ(made.status, 0) << made.error;
  const json patch = read_json_file(in_figure("plain.json"));
  EXPECT_EQ(patch.at("height_scale"), 0.5);
  EXPECT_TRUE(fs::exists(in_figure("basket_2_2.png")));
  EXPECT_TRUE(fs::exists(in_figure("given/leaf.jpg")));
  char period[40];
  std::snprintf(period, sizeof period, "period: %.2f mm (paper: 1.9 mm)", patch.at("period_x_mm").get<double>());
  EXPECT_THAT(made.out, AllOf(HasSubstr(period), HasSubstr("mean radius: 0.250"), HasSubstr("not there: not said")));
  const std::string page = text_in(fs::path(out()) / "index.html");
  EXPECT_THAT(page, AllOf(HasSubstr("weaves &amp; drafts"), HasSubstr("shows &lt;two&gt; of them"),
                          HasSubstr("src=\"figure-8/basket_2_2.png\""), HasSubstr("src=\"figure-8/given/leaf.jpg\""),
                          HasSubstr("threadstation weave --draft plain"), HasSubstr("threadstation reproduce 8")));
  const std::string pdf = text_in(fs::path(out()) / "figures.pdf");
  EXPECT_TRUE(pdf.starts_with("%PDF"));
  EXPECT_THAT(pdf, HasSubstr("DCTDecode")) << "pictures are stored as JPEG";
}

TEST_F(Reproduce, WhatIsMadeStaysAndWhatIsOtherwiseIsMadeAnew) {
  write("1.json", weave);
  ASSERT_EQ(make({"--quick"}).status, 0);
  EXPECT_FALSE(fs::exists(in_figure("basket_2_2.json"))) << "quick has fewer";
  EXPECT_EQ(read_json_file(in_figure("plain.json")).at("height_scale"), 1);
  const auto before = fs::last_write_time(in_figure("plain.json"));
  ASSERT_EQ(make({"--quick"}).status, 0);
  EXPECT_EQ(fs::last_write_time(in_figure("plain.json")), before);
  ASSERT_EQ(make({}).status, 0);
  EXPECT_EQ(read_json_file(in_figure("plain.json")).at("height_scale"), 0.5);
  const auto whole = fs::last_write_time(in_figure("plain.json"));
  weave["steps"].push_back({{"run", "weave --draft plain --out other.json"}});
  write("1.json", weave);
  ASSERT_EQ(make({}).status, 0);
  EXPECT_EQ(fs::last_write_time(in_figure("plain.json")), whole);
  EXPECT_TRUE(fs::exists(in_figure("other.json")));
}

TEST_F(Reproduce, AFailureIsThatFigureAndWhatNeedsItOnly) {
  write("1.json", weave);
  json fails = weave, after = weave;
  fails["figure"] = "9", after["figure"] = "10";
  fails["steps"] = json::array({{{"run", "weave --draft plain.json --out x.json"}}});
  after["needs"] = json::array({"9"}), after["steps"] = json::array();
  write("2.json", fails), write("3.json", after);
  const auto made = make({"--quick"});
  EXPECT_EQ(made.status, 1);
  EXPECT_THAT(made.error, AllOf(HasSubstr("2 figure(s) could not be made"), HasSubstr("plain.json")));
  EXPECT_THAT(made.out, HasSubstr("it needs 9"));
  EXPECT_TRUE(fs::exists(in_figure("plain.json")));
  const std::string page = text_in(fs::path(out()) / "index.html");
  EXPECT_THAT(page, AllOf(HasSubstr("It could not be made"), HasSubstr("figure-8/plain.png")));
}

TEST_F(Reproduce, OneFigureIsMadeAloneWithWhatItNeeds) {
  json first = weave, other = weave, last = weave;
  first["figure"] = "1", other["figure"] = "2", last["needs"] = json::array({"1"});
  write("1.json", first), write("2.json", other), write("3.json", last);
  ASSERT_EQ(make({"8", "--quick"}).status, 0);
  EXPECT_TRUE(fs::exists(fs::path(out()) / "figure-1"));
  EXPECT_FALSE(fs::exists(fs::path(out()) / "figure-2"));
  EXPECT_THAT(make({"77"}).error,
              AllOf(HasSubstr("no figure '77'"), HasSubstr("1, 2, 8"), Not(HasSubstr("terminate"))));
}

TEST_F(Reproduce, AFigureThatIsNoneIsOneLine) {
  weave["steps"][0]["for"] = json::array({"draft"});
  write("1.json", weave);
  const auto made = make({});
  EXPECT_EQ(made.status, 1);
  EXPECT_THAT(made.error, AllOf(HasSubstr("1.json"), HasSubstr("[name, [values]]")));
}

// The paper's own: each says what it is made of, its commands name files that are there, its pictures are made.
TEST(ReproduceFigures, AreThoseOfThePaper) {
  for (const bool quick : {false, true}) {
    std::vector<std::string> ids;
    for (const Figure& figure : read_figures(DATA_DIR, quick)) {
      ids.push_back(figure.id);
      EXPECT_FALSE(figure.paper.empty() || figure.different.empty()) << figure.id;
      for (const std::vector<std::string>& words : figure.steps)
        for (const std::string& word : words)
          if (word.starts_with(kData))
            EXPECT_TRUE(fs::exists(fs::path(DATA_DIR) / word.substr(std::string(kData).size()))) << word;
    }
    EXPECT_THAT(ids,
                testing::ElementsAre("1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "numbers"));
  }
}

}  // namespace
}  // namespace station
