// SPDX-License-Identifier: Apache-2.0
// fovea atlas with wrong beliefs: what each run drew, sizes, single deviations and margins.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.hpp"

namespace fovea {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

std::string Content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class RobustnessProgram : public testing::Test {
 protected:
  // Runs too short to converge, unless `more` has a longer duration.
  test::ProgramResult Atlas(const std::string& folder, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{
        FOVEA_PROGRAM,           "atlas", "--target",          "sphere", "--seed", "1", "--json", "--out",
        folder_.path() / folder, "--set", "run.duration_s=0.1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::RunProgram(arguments, {}, std::chrono::seconds(600));
  }
  // The rows of a case, by their start: they are written when they end.
  std::vector<json> Rows(const std::string& folder, const std::string& name) const {
    std::istringstream lines(Content(folder_.path() / folder / "rows.jsonl"));
    std::string line;
    std::getline(lines, line);  // the heading
    std::vector<json> rows;
    while (std::getline(lines, line)) {
      const json row = json::parse(line);
      if (row.value("case", "of a judgement") == name) {
        rows.push_back(row);
      }
    }
    std::sort(rows.begin(), rows.end(), [](const json& a, const json& b) { return a["run"] < b["run"]; });
    return rows;
  }
  void ExpectRefused(const std::vector<std::string>& more, const std::string& says) const {
    const test::ProgramResult result = Atlas("refused", more);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr(says));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(Rows("refused", "").empty()) << "no run was done";
  }

  const test::TempFolder folder_;
};

// Each row has what the run drew: within its range, other values for each start, and the very values that the
// listed command draws.
TEST_F(RobustnessProgram, RowsHaveWhatEachRunDrew) {
  const test::ProgramResult atlas = Atlas("drawn", {"--truth", "uncertain", "--runs", "2"});
  ASSERT_EQ(atlas.exit_code, 1) << atlas.err;  // such short runs fail
  const std::vector<json> rows = Rows("drawn", "");
  ASSERT_EQ(rows.size(), 2U);
  const std::map<std::string, double> factor_bounds{{"camera.f_px", 0.02}, {"arm.link_mass", 0.1}};
  const std::map<std::string, double> bounds{{"camera.mount_xyz", 0.005},
                                             {"camera.mount_turn_deg", 1.0},
                                             {"camera.latency_ms", 10.0},
                                             {"arm.load_mass", 0.2}};
  for (const json& row : rows) {
    ASSERT_EQ(row["truth"].size(), 3U + 3U + 1U + 1U + 7U + 1U);
    for (const json& drawn : row["truth"]) {
      const std::string key = drawn["key"];
      const double believed = drawn["believed"];
      const double off = drawn["true"].get<double>() - believed;
      const auto factor = factor_bounds.find(key);
      EXPECT_LE(std::fabs(off), factor != factor_bounds.end() ? factor->second * believed : bounds.at(key))
          << key;
      EXPECT_NE(off, 0.0);
    }
  }
  EXPECT_NE(rows[0]["truth"], rows[1]["truth"]);

  const json figures = json::parse(atlas.out);
  EXPECT_EQ(figures["deviations"].size(), 16U);
  EXPECT_THAT(Content(folder_.path() / "drawn" / "atlas.html"), HasSubstr("Results against each deviation"));
  const std::string command = figures["failures"][0]["command"];
  const test::ProgramResult again =
      test::RunProgram({"sh", "-c",
                        fs::path(FOVEA_PROGRAM).parent_path().string() + "/" + command +
                            " --json --no-report --out " + (folder_.path() / "again").string()});
  const json summary = json::parse(again.out);
  EXPECT_EQ(summary["log_hash"], rows[0]["log_hash"]);
  EXPECT_EQ(summary["truth"]["camera.latency_ms"]["true"][0],
            std::find_if(rows[0]["truth"].begin(), rows[0]["truth"].end(), [](const json& drawn) {
              return drawn["key"] == "camera.latency_ms";
            })->at("true"));
}

// All sizes draw from the same random numbers, so a deviation is proportional to the size. Without
// deviations, the run is that of an atlas without wrong beliefs.
TEST_F(RobustnessProgram, SizesScaleEveryDeviation) {
  const std::vector<std::string> words{"--truth", "uncertain", "--truth-size", "0,0.5,1",
                                       "--runs",  "2",         "--jobs",       "2"};
  const test::ProgramResult atlas = Atlas("sizes", words);
  ASSERT_EQ(atlas.exit_code, 1) << atlas.err;
  const std::vector<json> none = Rows("sizes", "size-0");
  const std::vector<json> half = Rows("sizes", "size-0.5");
  const std::vector<json> whole = Rows("sizes", "size-1");
  ASSERT_EQ(half.size(), 2U);
  double worst = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(none.at(i)["truth"].empty());
    ASSERT_EQ(half.at(i)["truth"].size(), whole.at(i)["truth"].size());
    for (std::size_t k = 0; k < half[i]["truth"].size(); ++k) {
      const auto off = [&](const json& row) {
        const json& drawn = row["truth"][k];
        return drawn["true"].get<double>() - drawn["believed"].get<double>();
      };
      worst = std::max(worst, std::fabs(2.0 * off(half[i]) / off(whole[i]) - 1.0));
    }
  }
  std::cout << "half the size: deviations differ from a half by " << worst << "\n";
  EXPECT_LT(worst, 1e-9);

  ASSERT_EQ(Atlas("plain", {"--runs", "2"}).exit_code, 1);
  const std::vector<json> plain = Rows("plain", "");
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(none[i]["log_hash"], plain.at(i)["log_hash"]);
    EXPECT_NE(whole[i]["log_hash"], plain[i]["log_hash"]);
  }

  // Kept runs are not repeated, and one at a time gives the same figures.
  const fs::path rows = folder_.path() / "sizes" / "rows.jsonl";
  const std::string before = Content(rows);
  std::vector<std::string> more = words;
  more.back() = "1";
  more.emplace_back("--resume");
  EXPECT_EQ(Atlas("sizes", more).out, atlas.out);
  EXPECT_EQ(Content(rows), before);
}

// In each case one part of one quantity differs, by its stated end.
TEST_F(RobustnessProgram, TornadoMovesOnePartAtATime) {
  const test::ProgramResult atlas =
      Atlas("tornado", {"--set", "truth.camera.mount_xyz.range=[-0.005,0.005]", "--set",
                        "truth.arm.load_mass.offset=0.2", "--tornado", "--runs", "1"});
  ASSERT_EQ(atlas.exit_code, 0) << atlas.err;  // no limit was exceeded
  const json target = json::parse(atlas.out)["targets"][0];
  ASSERT_EQ(target["alone"].size(), 4U);
  EXPECT_TRUE(target["alone"][3]["low"].is_null());
  EXPECT_EQ(target["alone"][1]["high"]["figures"]["runs"], 1);
  for (const auto& [name, key, entry, off] :
       {std::tuple{"camera.mount_xyz.x.low.1", "camera.mount_xyz", 1, -0.005},
        {"camera.mount_xyz.y.high.1", "camera.mount_xyz", 2, 0.005},
        {"arm.load_mass.high.1", "arm.load_mass", 1, 0.2}}) {
    const std::vector<json> rows = Rows("tornado", name);
    ASSERT_EQ(rows.size(), 1U) << name;
    ASSERT_EQ(rows[0]["truth"].size(), 1U) << name;
    const json& drawn = rows[0]["truth"][0];
    EXPECT_EQ(drawn["key"], key);
    EXPECT_EQ(drawn["entry"], entry);
    EXPECT_NEAR(drawn["true"].get<double>() - drawn["believed"].get<double>(), off, 1e-12);
  }
  EXPECT_THAT(Content(folder_.path() / "tornado" / "atlas.csv"),
              HasSubstr("sphere,arm.load_mass,,high,0.2,kg"));
  EXPECT_THAT(Content(folder_.path() / "tornado" / "atlas.html"), HasSubstr("Tornado chart"));
}

// The margin of a mass ends where it would be negative: 0.2 kg of 0.25 kg are borne, 0.28 kg cannot be. That
// of a latency lies between two runs: one that converges, and one with 1.41 times the deviation that does
// not.
TEST_F(RobustnessProgram, MarginLiesBetweenARunThatConvergesAndOneThatDoesNot) {
  const test::ProgramResult atlas =
      Atlas("margin", {"--set", "run.duration_s=5", "--set", "truth.arm.load_mass.range=[-0.2,0]", "--set",
                       "truth.camera.latency_ms.range=[0,80]", "--margin", "--runs", "1", "--jobs", "2"});
  ASSERT_NE(atlas.exit_code, 2) << atlas.err;
  const json target = json::parse(atlas.out)["targets"][0];
  ASSERT_EQ(target["none"]["converged"], 1);
  const json& load = target["alone"][0]["low"]["margin"];
  EXPECT_TRUE(load["larger_is_impossible"]);
  EXPECT_NEAR(load["borne"].get<double>(), -0.2, 1e-9);
  EXPECT_THAT(load["why"].get<std::string>(), HasSubstr("truth.arm.load_mass is not allowed"));
  const json& latency = target["alone"][1]["high"]["margin"];
  std::cout << "latency: " << latency["borne"] << " ms borne, " << latency["lost"] << " ms not\n";
  ASSERT_TRUE(latency["lost"].is_number());
  const auto converged = [&](double multiple) {
    std::ostringstream name;
    name.precision(3);
    name << "camera.latency_ms.high." << multiple;
    const std::vector<json> rows = Rows("margin", name.str());
    EXPECT_EQ(rows.size(), 1U) << name.str();
    return !rows.empty() && rows[0]["converged"].get<bool>();
  };
  EXPECT_FALSE(converged(latency["lost_multiple"]));
  ASSERT_GT(latency["borne_multiple"].get<double>(), 0.0);
  EXPECT_TRUE(converged(latency["borne_multiple"]));
  EXPECT_NEAR(latency["lost"].get<double>() / latency["borne"].get<double>(), std::sqrt(2.0), 1e-9);
  EXPECT_THAT(latency["command"].get<std::string>(), HasSubstr("truth.camera.latency_ms.offset="));
}

TEST_F(RobustnessProgram, BadInputIsRefusedBeforeTheFirstRun) {
  ExpectRefused({"--set", "truth.camera.fpx.sigma=1"}, "did you mean truth.camera.f_px");
  ExpectRefused({"--truth", "uncertian"}, "did you mean uncertain");
  ExpectRefused({"--truth", "uncertain", "--truth-size", "1,2"},
                "uncertain at size 2: truth.arm.load_mass is not");
  ExpectRefused({"--set", "truth.arm.load_mass=0.4", "--tornado"}, "use truth.arm.load_mass.offset");
  ExpectRefused({"--tornado"}, "no uncertainty is given");
  ExpectRefused({"--truth", "uncertain", "--tornado", "--truth-size", "1"}, "excludes");
}

}  // namespace
}  // namespace fovea
