// SPDX-License-Identifier: Apache-2.0
// Small parts of a run that keep data for its pictures, bounded for any duration.
#include <gtest/gtest.h>

#include "firmware/host/config/input_error.hpp"
#include "sim/run/path.hpp"
#include "sim/scenario/fault_settings.hpp"
#include "sim/verdict/target_log.hpp"

namespace fovea::sim {
namespace {

TEST(PathTest, LongPathIsThinnedEvenlyToItsEnd) {
  Path path;
  constexpr std::int64_t kTicks = 3'000'000;  // 50 minutes
  for (std::int64_t k = 0; k <= kTicks; ++k) {
    path.Add(k * 1'000'000, Eigen::Vector3d(static_cast<double>(k), 0.0, 0.0));
  }
  const auto& points = path.points();
  ASSERT_GT(points.size(), 1000U);
  EXPECT_LE(points.size(), 4000U);
  EXPECT_EQ(points.front().x(), 0.0);
  const double step = points[1].x();
  for (std::size_t i = 1; i < points.size(); ++i) {
    ASSERT_EQ(points[i].x() - points[i - 1].x(), step) << "point " << i;
  }
  EXPECT_GT(points.back().x(), static_cast<double>(kTicks) - 2.0 * step) << "the end is missing";
}

TEST(TargetLogTest, LostFramesAreForgottenAndOthersKeepTheirTarget) {
  TargetLog log;
  for (std::uint64_t i = 0; i < 5; ++i) {
    log.Put(i, {model::Mat3::Identity(), model::Vec3::Constant(static_cast<double>(i))});
  }
  EXPECT_EQ(log.Take(2).p.x(), 2.0);  // frames 0 and 1 were lost
  EXPECT_EQ(log.size(), 2U);
  EXPECT_EQ(log.Take(3).p.x(), 3.0);
  EXPECT_EQ(log.Take(4).p.x(), 4.0);
  EXPECT_EQ(log.size(), 0U);
}

TEST(FaultSettingsTest, CameraFaultsAndBaseTiltReachTheirParts) {
  FaultSettings f;
  config::KeyTable keys;
  AddFaultKeys(f, keys);
  for (const char* assignment :
       {"faults.freeze_s=[1, 2]", "faults.freeze_pixels=true", "faults.replay_s=[3, 4]",
        "faults.replay_delay_s=0.5", "faults.stamp_s=[5, 6]", "faults.stamp_ms=-60", "faults.mirror_s=[7, 8]",
        "faults.gravity_s=[0, 9]", "faults.gravity_tilt_deg=90", "faults.encoder_stuck_s=[1, 2]",
        "faults.encoder_stuck_joint=0", "faults.encoder_nan_joint=3", "faults.wrong_detection_shift=[0, -2]",
        "faults.push=[1, 2, 3]", "faults.glare_px=[1, 2, 3]"}) {
    keys.Apply(config::ParseAssignment(assignment));
  }
  EXPECT_TRUE(f.frames.freeze_pixels);
  EXPECT_EQ(f.frames.replay.window.start_s, 3.0);
  EXPECT_EQ(f.frames.replay.delay_ns, 500'000'000);
  EXPECT_EQ(f.frames.stamp.window.end_s, 6.0);
  EXPECT_EQ(f.frames.stamp.by_ns, -60'000'000);
  EXPECT_EQ(f.picture.mirror.start_s, 7.0);
  EXPECT_EQ(f.picture.glare.radius_px, 3.0);
  EXPECT_EQ(f.arm.stuck.joint, kAllJoints);
  EXPECT_EQ(f.arm.not_a_number.joint, 2);
  EXPECT_EQ(f.detector.wrong.shift[0], 0.0) << "the default's first entry is replaced";
  EXPECT_EQ(f.detector.wrong.shift[1], -2.0);
  EXPECT_EQ(f.bench.push.tau, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_NEAR(f.bench.base_tilt.tilt, 1.5707963267948966, 1e-15);
  EXPECT_EQ(FaultsOf(f).size(), 6U);
  EXPECT_NO_THROW(CheckFaults(f, 7));
  EXPECT_THROW(CheckServedFaults(f), config::InputError) << "serve cannot inject stamp and encoder faults";
  f.picture.mirror = {8.0, 7.0};
  EXPECT_THROW(CheckFaults(f, 7), config::InputError);
  f.picture.mirror = {7.0, 8.0};
  f.arm.not_a_number = {{0.0, 1.0}, 6};
  EXPECT_NO_THROW(CheckFaults(f, 7));
  EXPECT_THROW(CheckFaults(f, 6), config::InputError) << "no such joint";
  f.picture.occluder.height_px = 0.0;
  EXPECT_THROW(CheckFaults(f, 7), config::InputError);
}

}  // namespace
}  // namespace fovea::sim
