// SPDX-License-Identifier: Apache-2.0
// fovea compare: a log against the simulator's arm. The wrong arms of the logs are known; the comparison sees
// only their motion and their commands.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/run.pb.h"
#include "tests/support/program.hpp"

namespace fovea {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::vector<std::string> kNoNoise{"arm.encoder_noise=0", "arm.velocity_noise=0"};

class CompareTest : public testing::Test {
 protected:
  // Runs a scenario; returns the folder with its log.
  fs::path Run(const std::string& scenario, const std::vector<std::string>& settings) {
    const fs::path out = folder_.path() / std::to_string(++runs_);
    std::vector<std::string> arguments{FOVEA_SIM_PROGRAM, "run", scenario, "--out", out.string()};
    for (const std::string& setting : settings) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    const test::ProgramResult result = test::RunProgram(arguments);
    EXPECT_NE(result.exit_code, 2) << result.err;
    return out;
  }

  static test::ProgramResult Compare(const fs::path& log, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {FOVEA_PROGRAM, "compare", log.string()});
    return test::RunProgram(more);
  }

  static json Figures(const fs::path& log, std::vector<std::string> more = {}) {
    more.emplace_back("--json");
    const test::ProgramResult result = Compare(log, std::move(more));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out);
  }

  static double WorstOf(const json& figures, const char* quantity) {
    double worst = 0.0;
    for (const json& joint : figures["joints"]) {
      worst = std::max(worst, std::fabs(joint[quantity]["worst"].get<double>()));
    }
    return worst;
  }

  // The log has no likely cause in any joint but `joint`, and there `cause` with at least 0.9 of the torque.
  static void ExpectOnly(const json& figures, std::size_t joint, const std::string& cause) {
    std::printf("%.2g Nm at most\n", WorstOf(figures, "missing_torque"));
    for (std::size_t i = 0; i < figures["joints"].size(); ++i) {
      const std::string likely = figures["joints"][i]["likely_cause"];
      std::printf("joint %zu: %.2g Nm rms, %s\n", i + 1,
                  figures["joints"][i]["missing_torque"]["rms"].get<double>(), likely.c_str());
      if (i == joint) {
        EXPECT_GE(figures["joints"][i]["shares"][cause].get<double>(), 0.9);
        EXPECT_EQ(likely.find(','), cause == "friction" ? likely.find(" Nm,") + 3 : std::string::npos)
            << "one cause";
      } else {
        EXPECT_EQ(likely, "-") << "joint " << i + 1;
      }
    }
  }

  static void ExpectRefused(const test::ProgramResult& result, const std::string& says) {
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << "one line: " << result.err;
  }

  const test::TempFolder folder_;
  int runs_ = 0;
};

TEST_F(CompareTest, RightBeliefsLeaveTheIntegratorAlone) {
  // Without noise in the log, the two arms take the same steps, also with drives and rotors.
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{},
        {"arm.realism=panda", "arm.encoder_quantum=0", "arm.velocity_filter_hz=0"},
        {"arm.integrator=rk4"}}) {
    std::vector<std::string> settings = kNoNoise;
    settings.insert(settings.end(), more.begin(), more.end());
    const json figures = Figures(Run("home", settings));
    const double torque = WorstOf(figures, "missing_torque");
    std::printf("%s: positions %.2g rad, velocities %.2g rad/s, torques %.2g Nm at most\n",
                more.empty() ? "ideal" : more.front().c_str(), WorstOf(figures, "position"),
                WorstOf(figures, "velocity"), torque);
    EXPECT_GE(figures["ticks"].get<int>(), 3900);
    EXPECT_LE(WorstOf(figures, "position"), 1e-12);
    EXPECT_LE(WorstOf(figures, "velocity"), 1e-11);
    EXPECT_LE(torque, 1e-10);
    for (const json& joint : figures["joints"]) {
      EXPECT_EQ(joint["likely_cause"], "-");
    }
  }
}

TEST_F(CompareTest, NoiseOfEncodersHasNoCause) {
  const json figures = Figures(Run("home", {}));
  std::printf("torques %.2g Nm at most\n", WorstOf(figures, "missing_torque"));
  EXPECT_LE(WorstOf(figures, "missing_torque"), 0.02);
  EXPECT_GT(WorstOf(figures, "missing_torque"), 0.0);
  for (const json& joint : figures["joints"]) {
    EXPECT_EQ(joint["likely_cause"], "-");
  }
}

TEST_F(CompareTest, FrictionOfOneJoint) {
  const fs::path run = Run("home", {"truth.arm.coulomb=[0.5,1.5,0.4,0.4,0.25,0.2,0.2]"});
  ExpectOnly(Figures(run), 1, "friction");
  // The arm as it truly is explains all.
  const json right = Figures(run, {"--set", "arm.coulomb=[0.5,1.5,0.4,0.4,0.25,0.2,0.2]"});
  EXPECT_LE(WorstOf(right, "missing_torque"), 0.02);
}

TEST_F(CompareTest, RotorOfOneJoint) {
  const json figures = Figures(Run("home", {"truth.arm.rotor_inertia=[0,0,0,0,0,0,0.1]"}));
  ExpectOnly(figures, 6, "rotor_inertia");
  EXPECT_NEAR(figures["joints"][6]["rotor_inertia"].get<double>(), 0.1, 0.003);
}

TEST_F(CompareTest, TorqueBiasOfOneJoint) {
  const json figures = Figures(Run("home", {"truth.arm.torque_bias=[0,0,0,1,0,0,0]"}));
  ExpectOnly(figures, 3, "torque_bias");
  EXPECT_NEAR(figures["joints"][3]["torque_bias"].get<double>(), 1.0, 0.01);
}

TEST_F(CompareTest, LoadOnAllJoints) {
  const fs::path run = Run("home", {"truth.arm.load_mass=0.75"});
  const json figures = Figures(run);
  std::printf("%.2g Nm at most; load %+.3f kg\n", WorstOf(figures, "missing_torque"),
              figures["load_mass"].get<double>());
  EXPECT_NEAR(figures["load_mass"].get<double>(), 0.5, 0.01);
  for (const json& joint : figures["joints"]) {
    EXPECT_GE(joint["shares"]["load"].get<double>(), 0.9) << joint["name"];
  }
  const json right = Figures(run, {"--set", "arm.load_mass=0.75"});
  std::printf("with that load: %.2g Nm at most\n", WorstOf(right, "missing_torque"));
  EXPECT_LE(WorstOf(right, "missing_torque"), 0.02);
}

TEST_F(CompareTest, DelayOfAllTorques) {
  const json figures = Figures(Run("home", {"arm.torque_delay_ms=5"}), {"--set", "arm.torque_delay_ms=0"});
  std::printf("%.2g Nm at most; delay %.2f ms\n", WorstOf(figures, "missing_torque"),
              figures["torque_delay_ms"].get<double>());
  EXPECT_NEAR(figures["torque_delay_ms"].get<double>(), 5.0, 0.2);
  for (const json& joint : figures["joints"]) {
    EXPECT_GE(joint["shares"]["torque_delay"].get<double>(), 0.9) << joint["name"];
  }
}

TEST_F(CompareTest, TwoCausesAtOnce) {
  const json figures =
      Figures(Run("home", {"truth.arm.load_mass=0.45", "truth.arm.coulomb=[0.5,0.5,0.4,2.4,0.25,0.2,0.2]"}));
  std::printf("load %+.3f kg; joint 4: %s\n", figures["load_mass"].get<double>(),
              figures["joints"][3]["likely_cause"].get<std::string>().c_str());
  EXPECT_NEAR(figures["load_mass"].get<double>(), 0.2, 0.02);
  EXPECT_GE(figures["joints"][3]["shares"]["friction"].get<double>(), 0.5);
  EXPECT_GE(figures["joints"][1]["shares"]["load"].get<double>(), 0.9);
}

TEST_F(CompareTest, ThePageAndTheFiguresAreWritten) {
  const fs::path run = Run("home", {"run.duration_s=1"});
  const fs::path out = folder_.path() / "compared";
  const test::ProgramResult result = Compare(run, {"--out", out.string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find((out / "compare.html").string()), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("panda_joint7"), std::string::npos) << result.out;
  EXPECT_EQ(json::parse(std::ifstream(out / "compare.json")), Figures(run));
  EXPECT_GT(fs::file_size(out / "compare.html"), 100'000U) << "the page includes its libraries";
}

TEST_F(CompareTest, BadInputIsRefusedInOneLine) {
  const fs::path run = Run("home", {"run.duration_s=0.5"});
  ExpectRefused(Compare("nothing.mcap"), "nothing.mcap: no such file");
  ExpectRefused(Compare(run, {"--scenario", "ball-ur5e"}),
                "the log is of an arm with the joints panda_joint1");
  ExpectRefused(Compare(run, {"--scenario", "bal"}), "unknown scenario \"bal\"");
  ExpectRefused(Compare(run, {"--set", "servo.lambda=3"}), "a comparison accepts the keys of [arm]");
  ExpectRefused(Compare(run, {"--set", "truth.arm.load_mass=1"}), "a comparison accepts the keys of [arm]");
  ExpectRefused(Compare(run, {"--set", "arm.load_mas=1"}), "did you mean arm.load_mass");
  ExpectRefused(Compare(run, {"--set", "arm.load_mass=-1"}), "arm.load_mass = -1 is not allowed");
  ExpectRefused(Compare(run, {"--window-ms", "33"}), "it must be even");
  ExpectRefused(Compare(run, {"--window-ms", "1000"}), "nowhere 1000 ms of states and commands follow");
  ExpectRefused(Compare(Run("theory/pd-regulator", {})), "is the log of a theory run");

  const fs::path cut = folder_.path() / "cut.mcap";
  fs::copy_file(run / "log.mcap", cut);
  fs::resize_file(cut, fs::file_size(cut) * 2 / 3);
  ExpectRefused(Compare(cut), "cut.mcap: is cut off");
}

TEST_F(CompareTest, ALogWithoutAnArmIsRefused) {
  log::RunLogConfig config;
  config.path = folder_.path() / "empty.mcap";
  config.library = "test";
  log::RunLog log(config);
  log::Setup setup;
  setup.set_name("empty");
  log.Add(log::kSetupTopic, 0, setup);
  log.Finish();
  ExpectRefused(Compare(config.path), "holds no states of an arm");
}

}  // namespace
}  // namespace fovea
