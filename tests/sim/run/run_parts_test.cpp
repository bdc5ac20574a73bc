// The small parts of a run that keep what its pictures need, however long it goes on.
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
  EXPECT_EQ(log.Take(2).p.x(), 2.0);  // 0 and 1 were lost, the very first frames too
  EXPECT_EQ(log.size(), 2U);
  EXPECT_EQ(log.Take(3).p.x(), 3.0);
  EXPECT_EQ(log.Take(4).p.x(), 4.0);
  EXPECT_EQ(log.size(), 0U);
}

TEST(FaultSettingsTest, CameraFaultsAndBaseTiltReachTheirParts) {
  FaultSettings f;
  f.freeze_s = {1.0, 2.0};
  f.freeze_pixels = true;
  f.replay_s = {3.0, 4.0};
  f.replay_delay_s = 0.5;
  f.stamp_s = {5.0, 6.0};
  f.stamp_ms = -60.0;
  f.mirror_s = {7.0, 8.0};
  f.gravity_s = {0.0, 9.0};
  f.gravity_tilt_deg = 90.0;
  f.encoder_stuck_s = {1.0, 2.0};
  f.encoder_stuck_joint = 0;
  const FrameFaults frames = MakeFrameFaults(f, 1);
  EXPECT_TRUE(frames.freeze_pixels);
  EXPECT_EQ(frames.replay.window.start_s, 3.0);
  EXPECT_EQ(frames.replay.delay_ns, 500'000'000);
  EXPECT_EQ(frames.stamp.window.end_s, 6.0);
  EXPECT_EQ(frames.stamp.by_ns, -60'000'000);
  EXPECT_EQ(MakePictureFaults(f).mirror.start_s, 7.0);
  EXPECT_EQ(MakeArmFaults(f, 1).stuck.joint, kAllJoints);
  WorldConfig world;
  SetBenchFaults(f, world);
  EXPECT_NEAR(world.base_tilt.tilt, 1.5707963267948966, 1e-15);
  EXPECT_EQ(FaultsOf(f).size(), 6U);
  EXPECT_NO_THROW(CheckFaults(f, 7));
  EXPECT_THROW(CheckServedFaults(f), config::InputError) << "stamps and encoders are none of the bench's";
  f.gravity_s = {0.0, 0.0};
  SetBenchFaults(f, world);
  EXPECT_EQ(world.base_tilt.tilt, 0.0);
  f.mirror_s = {8.0, 7.0};
  EXPECT_THROW(CheckFaults(f, 7), config::InputError);
}

}  // namespace
}  // namespace fovea::sim
