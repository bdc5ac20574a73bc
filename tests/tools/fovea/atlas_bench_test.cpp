// SPDX-License-Identifier: Apache-2.0
// The sampler's objects on the bench match those that the simulator draws.
#include "tools/fovea/atlas/bench.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "firmware/core/model/rotation.hpp"
#include "sim/render/bench.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::atlas {
namespace {

using model::Vec3;

bool IsIn(const BenchThing& thing, const Vec3& p_B, double clear) {
  const Vec3 p = model::RotationOf({0.0, 0.0, thing.yaw}).transpose() * (p_B - thing.centre_B);
  return (p.cwiseAbs().array() <= 0.5 * thing.size.array() + clear).all();
}

bool IsInOne(const Vec3& p_B, double clear) {
  const auto things = BenchThings();
  return std::any_of(things.begin(), things.end(),
                     [&](const BenchThing& thing) { return IsIn(thing, p_B, clear); });
}

// Objects of the simulator's bench, within the table.
TEST(AtlasBenchTest, EveryObjectOnTheTableIsInTheAtlas) {
  constexpr double kSlack = 0.002;
  int high = 0;
  for (const sim::Mesh& thing : sim::MakeBench(false).things) {
    for (const auto& vertex : thing.vertices) {
      const Vec3 p_B = vertex.position.cast<double>();
      const bool on_table = std::fabs(p_B.x() - 0.42) < 0.8 && std::fabs(p_B.y()) < 0.65;
      if (on_table && p_B.z() > kThingHeight) {
        ++high;
        EXPECT_TRUE(IsInOne(p_B, kSlack)) << p_B.transpose();
      }
    }
  }
  EXPECT_GT(high, 100);
}

// What the servo is told: each upright box holds its thing and touches it on all sides.
TEST(AtlasBenchTest, BoxesOfThingsFitThem) {
  const std::vector<double> boxes = BoxesOfThings();
  const auto things = BenchThings();
  ASSERT_EQ(boxes.size(), 6 * things.size());
  for (std::size_t k = 0; k < things.size(); ++k) {
    Vec3 low = Vec3::Constant(HUGE_VAL);
    Vec3 high = -low;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                      (corner & 4) != 0 ? 0.5 : -0.5);
      const Vec3 p_B = things[k].centre_B +
                       model::RotationOf({0.0, 0.0, things[k].yaw}) * sign.cwiseProduct(things[k].size);
      low = low.cwiseMin(p_B);
      high = high.cwiseMax(p_B);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(boxes[6 * k + axis], low[static_cast<Eigen::Index>(axis)], 1e-12);
      EXPECT_NEAR(boxes[6 * k + 3 + axis], high[static_cast<Eigen::Index>(axis)], 1e-12);
    }
  }
}

TEST(AtlasBenchTest, SegmentMeetsAnObjectThatHoldsOneOfItsPoints) {
  test::RandomStates random(91);
  int met = 0;
  for (int k = 0; k < 2000; ++k) {
    const auto point = [&](double z) {
      return Vec3(random.Uniform(-0.4, 1.2), random.Uniform(-0.7, 0.7), random.Uniform(0.0, z));
    };
    const Vec3 a = point(0.6);
    const Vec3 b = point(0.2);
    constexpr int kPoints = 400;
    bool inside = false;
    bool near = false;
    for (int i = 0; i <= kPoints; ++i) {
      const Vec3 p = a + i / double{kPoints} * (b - a);
      inside = inside || IsInOne(p, 0.01);
      near = near || IsInOne(p, 0.014);  // larger by half the distance between points
    }
    const bool meets = ThingInTheWay(a, b, 0.01);
    EXPECT_TRUE(!inside || meets);
    EXPECT_TRUE(!meets || near);
    met += meets ? 1 : 0;
  }
  EXPECT_GT(met, 50);
  EXPECT_LT(met, 1000);
}

}  // namespace
}  // namespace fovea::atlas
