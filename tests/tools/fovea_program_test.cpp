// The program fovea as a user meets it: what it is given, and what it says when that is not a run.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "fovea/log/run_log.hpp"
#include "fovea/log/topics.hpp"
#include "fovea/run.pb.h"
#include "support/program.hpp"

namespace fovea {
namespace {

namespace fs = std::filesystem;

class FoveaProgramTest : public testing::Test {
 protected:
  static test::ProgramResult Fovea(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), FOVEA_PROGRAM);
    return test::RunProgram(arguments);
  }

  // A run's folder with a short log in it.
  fs::path MakeRun(const std::string& name) const {
    const fs::path run = folder_.path() / name;
    fs::create_directories(run);
    log::RunLogConfig config;
    config.path = run / "log.mcap";
    config.library = "test";
    config.arm.num_joints = 1;
    log::RunLog log(config);
    log::Setup setup;
    setup.set_name(name);
    setup.add_joints()->set_name("only");
    log.Add(log::kSetupTopic, 0, setup);
    for (int i = 0; i < 100; ++i) {
      hal::TickRecord record;
      record.stamp_ns = i * hal::kTickPeriodNs;
      record.arm.num_joints = record.command.num_joints = 1;
      log.AddTick(record);
    }
    log.Finish();
    return run;
  }

  static void ExpectRefused(const test::ProgramResult& result, const std::string& says) {
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << "one line: " << result.err;
  }

  const test::TempFolder folder_;
};

TEST_F(FoveaProgramTest, PutsTheReportBesideTheLog) {
  const fs::path run = MakeRun("swing");
  for (const fs::path& given : {run, run / "log.mcap"}) {
    fs::remove(run / "report.html");
    const test::ProgramResult result = Fovea({"report", given.string()});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, (run / "report.html").string() + "\n");
    EXPECT_GT(fs::file_size(run / "report.html"), 1'000'000U) << "its libraries are in it";
  }
}

TEST_F(FoveaProgramTest, LaysTwoRunsBesideEachOther) {
  const fs::path out = folder_.path() / "both.html";
  const test::ProgramResult result =
      Fovea({"report", MakeRun("one").string(), MakeRun("two").string(), "--out", out.string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::ifstream stream(out);
  const std::string page{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_NE(page.find("<title>one and two"), std::string::npos);
}

TEST_F(FoveaProgramTest, SaysWhatIsNoLog) {
  ExpectRefused(Fovea({"report", "nothing.mcap"}), "nothing.mcap: no such file");
  ExpectRefused(Fovea({"report", folder_.path().string()}), "log.mcap: no such file");
  const fs::path text = folder_.path() / "text.mcap";
  std::ofstream(text) << "words";
  ExpectRefused(Fovea({"report", text.string()}), "text.mcap: not an MCAP file");
}

TEST_F(FoveaProgramTest, SaysWhereItCannotWrite) {
  const test::ProgramResult result =
      Fovea({"report", MakeRun("swing").string(), "--out", "/nowhere/report.html"});
  ExpectRefused(result, "/nowhere/report.html: cannot be written");
}

TEST_F(FoveaProgramTest, HelpShowsExamples) {
  const test::ProgramResult help = Fovea({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("fovea report out/ball"), std::string::npos);
  EXPECT_EQ(Fovea({"report"}).exit_code, 2);
  EXPECT_EQ(Fovea({}).exit_code, 2);
}

}  // namespace
}  // namespace fovea
