// SPDX-License-Identifier: Apache-2.0
// Tables, JSON, CSV and charts of a robustness study whose results are known.
#include "tools/fovea/robustness/text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "tools/fovea/robustness/chart.hpp"
#include "tools/fovea/robustness/page.hpp"

namespace fovea::robustness {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

atlas::Figures FiguresWith(int converged, int runs, double px) {
  atlas::Figures f;
  f.heading = {"sphere", 7, {}, "0123456789abcdef", {}, ""};
  f.scenario = "ball";
  f.runs = runs;
  f.converged = converged;
  f.wilson_95 = atlas::Wilson95(converged, runs);
  f.error_px = atlas::Spread{px, px, 2.0 * px};
  f.error_mm = atlas::Spread{10.0 * px, 10.0 * px, 20.0 * px};
  f.settle_s = atlas::Spread{2.0, 2.0, 2.5};
  if (converged < runs) {
    f.failures.push_back(
        {0, 0, "lost <the target>", "a way exists", "fovea-sim run ball --seed 3", "runs/x.0000"});
  }
  return f;
}

BarFigures BarWith(const std::string& quantity, double end, double px, int lost, const Margin& low,
                   const Margin& high) {
  BarFigures one;
  one.bar.quantity = quantity;
  one.bar.unit = "ms";
  one.bar.low = -end;
  one.bar.high = end;
  one.sides[0] = SideFigures{FiguresWith(3, 3, 0.5 * px), low};
  one.sides[1] = SideFigures{FiguresWith(3 - lost, 3, px), high};
  return one;
}

Tornado SomeTornado() {
  Tornado tornado{FiguresWith(20, 20, 0.15), FiguresWith(3, 3, 0.1), FiguresWith(19, 20, 0.3), {}, 3};
  tornado.bars.push_back(
      BarWith("little", 5.0, 0.2, 0, {2.0, 2.8, false, "", ""}, {32.0, {}, false, "", ""}));
  tornado.bars.push_back(BarWith("much", 10.0, 0.4, 0, {0.0, 0.25, false, "", ""}, {1.0, {}, true, "", ""}));
  tornado.bars.push_back(
      BarWith("fatal", 20.0, 0.2, 1, {0.5, 0.7, false, "", ""}, {0.7, 1.0, false, "", ""}));
  return tornado;
}

const Spec& SomeSpec() {
  static const Spec kSpec{"some", {{"camera.latency_ms", "range", {-10.0, 10.0}, true}}};
  return kSpec;
}

TEST(RobustnessText, CostliestQuantityComesFirst) {
  const Tornado tornado = SomeTornado();
  std::vector<std::string> names;
  for (const BarFigures* one : ByCost(tornado)) {
    names.push_back(one->bar.quantity);
  }
  EXPECT_THAT(names, testing::ElementsAre("fatal", "much", "little"));
  EXPECT_EQ(CostOf(tornado.bars[1]), "0.4 px, 4 mm, 2.0 s");
}

TEST(RobustnessText, FailedRunsAreCountedForEachSide) {
  BarFigures bar = SomeTornado().bars[2];
  EXPECT_EQ(CostOf(bar), "1 of 3 failed at +20");
  bar.sides[0] = SideFigures{FiguresWith(1, 3, 0.2), std::nullopt};
  EXPECT_EQ(CostOf(bar), "2 of 3 failed at -20, 1 of 3 failed at +20");
}

TEST(RobustnessText, BorneRangesSayWhatBoundsThem) {
  const Tornado tornado = SomeTornado();
  EXPECT_EQ(StatedRange(tornado.bars[0].bar), "-5 to +5 ms");
  EXPECT_EQ(BorneRange(tornado.bars[0]), "-10 to >+160 ms");
  EXPECT_EQ(BorneRange(tornado.bars[1]), "0 to +10 (end) ms");
  EXPECT_EQ(BorneRange(tornado.bars[2]), "-10 to +14 ms");
}

TEST(RobustnessText, CsvHasOneFieldPerColumn) {
  std::istringstream lines(ToCsv({SomeTornado()}));
  std::string line;
  std::getline(lines, line);
  const auto columns = std::count(line.begin(), line.end(), ',');
  int rows = 0;
  while (std::getline(lines, line)) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns) << line;
    ++rows;
  }
  EXPECT_EQ(rows, 2 + 2 * 3);  // none, all, two sides of each bar
  EXPECT_THAT(ToCsv({SomeTornado()}),
              HasSubstr("sphere,little,,high,5,ms,160,,3,3,3,0,0,2,2.5,0.2,0.4,2,4,,"));
}

TEST(RobustnessText, JsonHasEveryFigure) {
  const json told = json::parse(ToJson(SomeSpec(), std::vector{SomeTornado()}));
  EXPECT_EQ(told["truth"][0], "truth.camera.latency_ms.range=[-10,10]");
  const json& target = told["targets"][0];
  EXPECT_EQ(target["target"], "sphere");
  EXPECT_EQ(target["none"]["converged"], 20);
  EXPECT_EQ(target["all"]["converged"], 19);
  const json& high = target["alone"][2]["high"];
  EXPECT_EQ(high["figures"]["converged"], 2);
  EXPECT_DOUBLE_EQ(high["margin"]["borne"], 14.0);
  EXPECT_DOUBLE_EQ(high["margin"]["lost"], 20.0);
  EXPECT_TRUE(target["alone"][1]["high"]["margin"]["larger_is_impossible"]);
}

TEST(RobustnessText, MarkdownTablesHaveEqualColumns) {
  const std::string page = ToMarkdown(SomeSpec(), {SomeTornado(), SomeTornado()});
  std::istringstream lines(page);
  std::string line;
  std::ptrdiff_t columns = -1;
  int tables = 0;
  while (std::getline(lines, line)) {
    if (line.empty() || line[0] != '|') {
      columns = -1;
      continue;
    }
    const auto count = std::count(line.begin(), line.end(), '|');
    tables += columns < 0 ? 1 : 0;
    columns = columns < 0 ? count : columns;
    EXPECT_EQ(count, columns) << line;
  }
  EXPECT_EQ(tables, 3);
  EXPECT_THAT(page, HasSubstr("\nfovea atlas --robustness --runs 20 --alone 3 --seed 7 --markdown"));
  EXPECT_THAT(page, HasSubstr("| `much` | -10 to +10 ms | 0.4 px, 4 mm, 2.0 s |"));
  EXPECT_THAT(page, HasSubstr("| `much` | 0 to +10 (end) ms |"));
}

TEST(RobustnessPage, ChartsAreNamedAndStayInTheirFrame) {
  const std::string page = ToHtml(SomeSpec(), std::vector{SomeTornado()});
  EXPECT_THAT(page, HasSubstr("lost &lt;the target&gt;"));
  EXPECT_THAT(page, Not(HasSubstr("<the target>")));
  int charts = 0;
  double most_x = 0.0;
  const std::regex svg("<svg viewBox=\"0 0 ([0-9.]+) [0-9.]+\" role=\"img\" aria-label=\"[^\"]+\"");
  for (auto it = std::sregex_iterator(page.begin(), page.end(), svg); it != std::sregex_iterator(); ++it) {
    ++charts;
  }
  const std::regex rect("<rect x=\"([0-9.-]+)\" y=\"[0-9.-]+\" width=\"([0-9.-]+)\"");
  for (auto it = std::sregex_iterator(page.begin(), page.end(), rect); it != std::sregex_iterator(); ++it) {
    EXPECT_GE(std::stod((*it)[1]), 0.0);
    most_x = std::max(most_x, std::stod((*it)[1]) + std::stod((*it)[2]));
  }
  std::cout << charts << " charts, bars end at " << most_x << " of 380\n";
  EXPECT_EQ(charts, 3);
  EXPECT_GT(most_x, 100.0);
  EXPECT_LE(most_x, 380.0);
}

// The length of a bar is the difference of two medians, on the axis on which all bars are drawn.
TEST(RobustnessPage, BarLengthsAreInProportion) {
  const std::string chart = TornadoChart(SomeTornado(), Measures()[0]);
  const std::regex rect("<rect x=\"([0-9.-]+)\" y=\"[0-9.-]+\" width=\"([0-9.-]+)\"");
  std::vector<double> widths;
  for (auto it = std::sregex_iterator(chart.begin(), chart.end(), rect); it != std::sregex_iterator(); ++it) {
    widths.push_back(std::stod((*it)[2]));
  }
  // Bars are sorted by their longest side: "much" (0.2 and 0.4 px), then two of 0.1 and 0.2 px; without
  // errors from the same starts: 0.1 px.
  ASSERT_EQ(widths.size(), 6U);
  EXPECT_NEAR(widths[1], 3.0 * widths[0], 0.3);
  EXPECT_NEAR(widths[3], widths[0], 0.1);
  EXPECT_LE(widths[2], 0.5);
}

TEST(RobustnessPage, SizesAreShownWithTheirInterval) {
  const std::vector<SizeFigures> sizes{{0.0, FiguresWith(20, 20, 0.1)}, {2.0, FiguresWith(10, 20, 0.2)}};
  const std::string page = ToHtml(SomeSpec(), sizes);
  EXPECT_THAT(page, HasSubstr("10 of 20 (29.9 to 70.1 %)"));
  EXPECT_THAT(page, HasSubstr("size 2, run 0"));
  const std::string csv = ToCsv(sizes);
  EXPECT_THAT(csv, HasSubstr("\n2,0.299"));
  EXPECT_EQ(json::parse(ToJson(SomeSpec(), sizes))["sizes"][1]["figures"]["converged"], 10);
}

}  // namespace
}  // namespace fovea::robustness
