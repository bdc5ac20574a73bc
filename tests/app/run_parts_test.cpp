// The small parts of a run that keep what its pictures need, however long it goes on.
#include <gtest/gtest.h>

#include "sim/app/path.hpp"
#include "sim/app/target_log.hpp"

namespace fovea::sim {
namespace {

TEST(PathTest, StaysSmallEvenAndWhole) {
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

TEST(TargetLogTest, FramesThatWereLostAreForgottenAndTheOthersKeepTheirTarget) {
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

}  // namespace
}  // namespace fovea::sim
