// SPDX-License-Identifier: Apache-2.0
// [truth] changes the bench, and nothing that the servo believes.
#include "sim/scenario/true_bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "fovea/hal/types.hpp"
#include "sim/scenario/compose.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/world_config.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::sim {
namespace {

using testing::HasSubstr;

RunDescription Described(const std::vector<std::string>& assignments) {
  return DescribeRun(LoadScenario("ball", assignments));
}

TEST(TrueBench, WithoutTruthWorldAndBeliefAreOne) {
  const RunDescription run = Described({});
  EXPECT_TRUE(run.truth.empty());
  EXPECT_FALSE(run.robot_truth.believed.has_value());
  EXPECT_EQ(run.eye.pinhole.f_px, run.pinhole.f_px);
  EXPECT_TRUE(run.eye.X_EC.isApprox(run.scene.X_EC, 0.0));
  EXPECT_EQ(run.stamps.ErrorNs(0, 1'000'000'000), 0);
}

// A row's time is believed of the camera, and true of it unless [truth] says otherwise.
TEST(TrueBench, RowsAreExposedAsTheServoBelievesOrOtherwise) {
  const RunDescription both = Described({"camera.row_time_us=30"});
  EXPECT_NEAR(both.servo.predict.row_time, 30e-6 * both.intrinsics.f_v_px, 1e-15);
  EXPECT_EQ(both.servo.predict.row_y, 0.0);
  EXPECT_DOUBLE_EQ(MakeScenarioShutter(both.bench).row_time_ns, 30e3);
  EXPECT_EQ(MakeWorldConfig(both).exposure_reach_ns, 2'500'000 + 7'185'000);
  const RunDescription unknown = Described({"truth.camera.row_time_us=20"});
  EXPECT_EQ(unknown.servo.predict.row_time, 0.0);
  EXPECT_DOUBLE_EQ(MakeScenarioShutter(unknown.bench).row_time_ns, 20e3);
  const RunDescription imagined = Described({"camera.row_time_us=30", "truth.camera.row_time_us=0"});
  EXPECT_GT(imagined.servo.predict.row_time, 0.0);
  EXPECT_TRUE(MakeScenarioShutter(imagined.bench).IsSharp());
  const RunDescription off_centre =
      Described({"camera.row_time_us=30", "camera.f_u_px=571.3", "camera.f_v_px=566.9", "camera.c_u_px=301.7",
                 "camera.c_v_px=252.2"});
  EXPECT_NEAR(off_centre.servo.predict.row_time, 30e-6 * 566.9, 1e-15);
  EXPECT_NEAR(off_centre.servo.predict.row_y, (239.5 - 252.2) / 566.9, 1e-15);
}

TEST(TrueBench, ChangesTheBenchAndNotTheBelief) {
  const RunDescription honest = Described({});
  const RunDescription run = Described(
      {"truth.camera.mount_xyz.offset=[0.005, 0, 0]", "truth.camera.mount_turn_deg=[0, 0, 1]",
       "truth.camera.f_px.scale=1.02", "truth.camera.c_px.offset=[3, -2]",
       "truth.camera.lens=[-0.1, 0, 0, 0, 0]", "truth.camera.latency_ms=58", "truth.arm.link_mass.scale=1.2",
       "truth.arm.load_mass.offset=0.2", "truth.target.size_scale=1.05", "truth.arm.encoder_zero=0.01",
       "truth.arm.base_tilt_deg=[1, 2]"});
  EXPECT_EQ(run.truth.size(), 11U);
  // Belief
  EXPECT_EQ(run.servo.X_EC.p, honest.servo.X_EC.p);
  EXPECT_EQ(run.servo.X_EC.R, honest.servo.X_EC.R);
  EXPECT_EQ(run.intrinsics.f_u_px, honest.intrinsics.f_u_px);
  EXPECT_EQ(run.intrinsics.lens.k1, honest.intrinsics.lens.k1);
  EXPECT_EQ(run.servo.feature.radius, honest.servo.feature.radius);
  for (int i = 0; i < run.servo.arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_EQ(run.servo.arm.links[k].mass, honest.servo.arm.links[k].mass);
  }
  // Truth
  EXPECT_NEAR(run.eye.X_EC.translation().x(), honest.eye.X_EC.translation().x() + 0.005, 1e-15);
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(honest.eye.X_EC.linear().transpose() * run.eye.X_EC.linear()));
  EXPECT_NEAR(turn.angle(), std::numbers::pi / 180.0, 1e-12);
  EXPECT_NEAR(turn.axis().z(), 1.0, 1e-9);
  EXPECT_DOUBLE_EQ(run.eye.pinhole.f_px, 1.02 * honest.pinhole.f_px);
  EXPECT_DOUBLE_EQ(run.eye.pinhole.FocalV(), 1.02 * honest.pinhole.FocalV());
  EXPECT_DOUBLE_EQ(run.eye.pinhole.c_v_px, honest.pinhole.c_v_px - 2.0);
  EXPECT_EQ(run.eye.lens.k1, -0.1);
  EXPECT_EQ(run.stamps.late_ns, 18'000'000);
  EXPECT_EQ(run.bench.camera.latency_ms, 58.0);
  EXPECT_DOUBLE_EQ(run.scene.target.radius, 1.05 * honest.scene.target.radius);
  EXPECT_DOUBLE_EQ(run.bench.target.position[2], honest.bench.target.position[2] + 0.05 * 0.04);
  const auto mass_of = [](const SimRobot& robot) {
    double sum = 0.0;
    for (const SimLink& link : robot.links) {
      sum += link.mass;
    }
    return sum;
  };
  // The base link's mass is not a moving link's.
  const double base = honest.scene.robot.links.front().mass;
  const double moving = mass_of(*run.robot_truth.believed) - base - 0.25;
  EXPECT_NEAR(mass_of(run.scene.robot), base + 1.2 * moving + 0.45, 1e-9);
}

TEST(TrueBench, FocalLengthKeepsTheAspectAndTheAspectTheFocalLength) {
  const Pinhole believed = Described({}).pinhole;
  const Pinhole longer = Described({"truth.camera.f_px.scale_sigma=0.1"}).eye.pinhole;
  EXPECT_GT(std::abs(longer.f_px - believed.f_px), 1.0);
  EXPECT_NEAR(longer.FocalV() / longer.f_px, believed.FocalV() / believed.f_px, 1e-15);
  const Pinhole wider = Described({"truth.camera.aspect=1.01"}).eye.pinhole;
  EXPECT_EQ(wider.f_px, believed.f_px);
  EXPECT_DOUBLE_EQ(wider.FocalV(), 1.01 * believed.f_px);
}

TEST(TrueBench, ReadsInlineTablesAndRefusesWhatCannotBe) {
  const test::TempFolder folder;
  const auto load = [&](const std::string& text) {
    const auto file = folder.path() / "mine.toml";
    std::ofstream(file) << text;
    return DescribeRun(LoadScenario(file.string(), {}));
  };
  const RunDescription run = load(
      "[truth]\ncamera.mount_xyz = { sigma = 0.005 }\narm.link_mass = { scale = 1.2 }\n"
      "camera.latency_ms = { offset = 5, sigma = 2 }\n");
  EXPECT_EQ(run.truth.size(), 3U);
  EXPECT_THAT(test::InputErrorOf([&] { load("[truth]\ncamera.mount_xzy = { sigma = 0.005 }\n"); }),
              HasSubstr("mine.toml:2: unknown key truth.camera.mount_xzy.sigma; did you mean "
                        "truth.camera.mount_xyz.sigma?"));
  EXPECT_THAT(test::InputErrorOf([&] { load("[truth]\nservo.lambda = 3\n"); }),
              HasSubstr("unknown key truth.servo.lambda"));
  EXPECT_THAT(test::InputErrorOf([&] { load("[truth]\narm.link_mass = { sigma = -1 }\n"); }),
              HasSubstr("truth.arm.link_mass.sigma = -1 is not allowed"));
  EXPECT_THAT(test::InputErrorOf([&] { load("[truth]\narm.link_mass = { offset = -3 }\n"); }),
              HasSubstr("truth.arm.link_mass is not allowed: entry"));
  EXPECT_THAT(test::InputErrorOf([&] { load("[truth]\narm.encoder_zero = [0.01, 0.02]\n"); }),
              HasSubstr("truth.arm.encoder_zero has 2 entries: 1 or 7 are allowed"));
  EXPECT_THAT(test::InputErrorOf([&] { load("[truth]\ncamera.latency_ms = nan\n"); }),
              HasSubstr("truth.camera.latency_ms = nan is not allowed"));
  EXPECT_THAT(test::InputErrorOf([&] { load("[truth]\ncamera.latency_ms = { range = [-40, 0] }\n"); }),
              HasSubstr("allowed is 2.5 to 500 ms"))
      << "half of the exposure";
  EXPECT_THAT(test::InputErrorOf([&] { load("[truth]\ncamera.c_px = { sigma = 150 }\n"); }),
              HasSubstr("truth.camera.c_px is not allowed: entry 1 could be from -130.5 to 769.5 px"));
  EXPECT_THAT(test::InputErrorOf([&] { load("[truth]\ncamera.latency_jitter_ms = 20\n"); }),
              HasSubstr("truth.camera.latency_jitter_ms = 20 is not allowed: with a latency of 40 ms"));
  EXPECT_THAT(
      test::InputErrorOf([&] {
        load(
            "[camera]\nenabled = false\n[motion]\nkind = \"home\"\n[truth]\ncamera.f_px = { scale = 1.1 }\n");
      }),
      HasSubstr("truth.camera.f_px has no effect: camera.enabled = false"));
  EXPECT_THAT(
      test::InputErrorOf([&] { load("[truth]\narm.load_mass = 0\narm.load_com = { offset = 0.1 }\n"); }),
      HasSubstr("truth.arm.load_com has no effect: the hand carries no load"));
}

TEST(TrueBench, AValueEqualToTheBeliefIsNoDifference) {
  EXPECT_TRUE(Described({"truth.camera.latency_ms.offset=0", "truth.arm.torque_scale=1"}).truth.empty());
}

// What the sensors of a standing arm read, and how it moves off, against the model by hand.
TEST(TrueBench, EncodersReadTheirZerosAndTheArmStartsWhereTheyRead) {
  const RunDescription run =
      Described({"truth.arm.encoder_zero=[0.01, -0.02, 0, 0, 0, 0, 0.03]", "arm.encoder_noise=0"});
  const World world(MakeWorldConfig(run));
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_NEAR(world.MeasuredState().q[i], run.scenario.arm.q_start[i], 1e-12) << i;
  }
  EXPECT_NEAR(world.truth().q[6], run.scenario.arm.q_start[6] - 0.03, 1e-12);
}

TEST(TrueBench, StampsFollowLatencyJitterAndDrift) {
  const RunDescription run = Described(
      {"truth.camera.latency_ms=30", "truth.camera.latency_jitter_ms=2", "truth.camera.clock_drift_ppm=100"});
  double sum2 = 0.0;
  constexpr int kFrames = 5000;
  for (std::uint64_t k = 0; k < kFrames; ++k) {
    const auto jitter = static_cast<double>(run.stamps.JitterNs(k));
    sum2 += jitter * jitter / kFrames;
    EXPECT_LE(std::fabs(jitter), 6e6);
    EXPECT_NEAR(static_cast<double>(run.stamps.ErrorNs(run.stamps.JitterNs(k), 10'000'000'000)),
                -10e6 + jitter + 1e6, 2.0);
  }
  EXPECT_NEAR(std::sqrt(sum2), 2e6, 1e5);
}

}  // namespace
}  // namespace fovea::sim
