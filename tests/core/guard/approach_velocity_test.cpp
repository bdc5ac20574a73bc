// SPDX-License-Identifier: Apache-2.0
// Joints that change their speed together: the motion keeps its direction, and takes no longer than its
// slowest joint.
#include "firmware/core/guard/approach_velocity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "firmware/core/trajectory/joint_pace.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::guard {
namespace {

constexpr int kMostTicks = 3000;
constexpr double kThere = 1e-6;  // [rad/s]

trajectory::Reference AtRest() {
  const model::VecN zero = model::VecN::Zero(7);
  return {test::Ready(), zero, zero};
}

struct Change {
  int ticks = 0;
  double aside = 0.0;  // largest part of the velocity across the wished change, of that change
  double past = 0.0;   // largest overshoot of a joint [rad/s]
};

template <class Step>
Change Approach(const config::ServoConfig& config, const model::VecN& wish, trajectory::Reference reference,
                Step step) {
  const model::VecN zero = model::VecN::Zero(7);
  const model::VecN from = reference.dq;
  const model::VecN way = wish - from;
  Change change;
  while (((wish - reference.dq).norm() > kThere || reference.ddq.norm() > kThere) &&
         change.ticks < kMostTicks) {
    step(config, wish, zero, reference);
    ++change.ticks;
    const model::VecN gone = reference.dq - from;
    change.aside =
        std::max(change.aside, (gone - gone.dot(way) / way.squaredNorm() * way).norm() / way.norm());
    for (int i = 0; i < 7; ++i) {
      const double past = (reference.dq[i] - wish[i]) * (way[i] > 0.0 ? 1.0 : -1.0);
      change.past = std::max(change.past, past);
    }
  }
  return change;
}

TEST(ApproachVelocityTest, KeepsTheDirectionAndTakesNoLongerThanTheSlowestJoint) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(41);
  Change together;
  Change alone;
  int later = 0;
  for (int k = 0; k < 500; ++k) {
    const model::VecN wish = random.Joints(config.arm, std::pow(10.0, random.Uniform(-2.0, 0.3)));
    const Change a = Approach(config, wish, AtRest(), ApproachTogether);
    const Change b = Approach(config, wish, AtRest(), ApproachAlone);
    together.aside = std::max(together.aside, a.aside);
    together.past = std::max(together.past, a.past);
    alone.aside = std::max(alone.aside, b.aside);
    alone.past = std::max(alone.past, b.past);
    later = std::max(later, a.ticks - b.ticks);
    ASSERT_LT(a.ticks, kMostTicks) << k;
  }
  std::cout << "aside at most " << together.aside << " of the change, alone " << alone.aside << "; " << later
            << " ticks later at most; past the wish by at most " << together.past << " rad/s, alone "
            << alone.past << "\n";
  EXPECT_LT(together.aside, 0.08);
  EXPECT_GT(alone.aside, 0.3) << "the comparison must differ";
  EXPECT_LE(later, 1);
  // Two ticks of the step by which the jerk limit lets an acceleration grow.
  const double step = trajectory::PaceOf(config, 0).dddq_max * hal::kTickPeriodS;
  EXPECT_LT(together.past, 2.0 * step * hal::kTickPeriodS);
}

// From any motion to any wish, which changes before it is reached: no joint exceeds its limits, and none
// passes the largest of its wishes.
TEST(ApproachVelocityTest, ChangingWishesExceedNoLimit) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(42);
  const model::VecN zero = model::VecN::Zero(7);
  trajectory::Reference reference = AtRest();
  model::VecN wish = zero;
  double acceleration = 0.0;
  double jerk = 0.0;
  double speed = 0.0;
  for (int tick = 0; tick < 200'000; ++tick) {
    if (tick % 61 == 0) {
      for (int i = 0; i < 7; ++i) {
        wish[i] = random.Uniform(-1.0, 1.0);
      }
    }
    const trajectory::Reference before = reference;
    ApproachTogether(config, wish, zero, reference);
    for (int i = 0; i < 7; ++i) {
      const trajectory::JointPace pace = trajectory::PaceOf(config, i);
      acceleration = std::max(acceleration, std::fabs(reference.ddq[i]) / pace.ddq_max);
      jerk =
          std::max(jerk, std::fabs(reference.ddq[i] - before.ddq[i]) / (pace.dddq_max * hal::kTickPeriodS));
      speed = std::max(speed, std::fabs(reference.dq[i]));
    }
  }
  std::cout << "largest use: acceleration " << acceleration << ", jerk " << jerk << ", speed " << speed
            << "\n";
  EXPECT_LE(acceleration, 1.0 + 1e-12);
  EXPECT_LE(jerk, 1.0 + 1e-12);
  EXPECT_GT(jerk, 0.99);
  EXPECT_LE(speed, 1.001);
}

TEST(ApproachVelocityTest, ReachesAWishWithinATickUnchanged) {
  const config::ServoConfig config = test::PandaConfig();
  const model::VecN zero = model::VecN::Zero(7);
  trajectory::Reference together = AtRest();
  trajectory::Reference alone = AtRest();
  const model::VecN wish = model::VecN::Constant(7, 1e-5);
  EXPECT_EQ(ApproachTogether(config, wish, zero, together), 0U);
  ApproachAlone(config, wish, zero, alone);
  EXPECT_EQ(together.dq, alone.dq);
  EXPECT_NEAR((together.dq - wish).norm(), 0.0, 1e-15);
}

// Velocities that are there already, but are left again at once: each joint still has its acceleration.
TEST(ApproachVelocityTest, KeepsTheJerkWhereTheWishIsThePresentVelocity) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(43);
  double most = 0.0;  // change of the acceleration in a tick, of what the jerk limit allows
  for (int k = 0; k < 500; ++k) {
    trajectory::Reference reference = AtRest();
    reference.dq = random.Joints(config.arm, 0.5);
    reference.ddq = random.Joints(config.arm, 2.0);
    const trajectory::Reference before = reference;
    const bool same_rate = k % 2 == 0;
    ApproachTogether(config, before.dq, same_rate ? before.ddq : model::VecN(model::VecN::Zero(7)),
                     reference);
    for (int i = 0; i < 7; ++i) {
      const double step = trajectory::PaceOf(config, i).dddq_max * hal::kTickPeriodS;
      most = std::max(most, std::fabs(reference.ddq[i] - before.ddq[i]) / step);
    }
  }
  std::cout << "largest change of the acceleration, of the limit: " << most << "\n";
  EXPECT_LE(most, 1.0 + 1e-9);
}

}  // namespace
}  // namespace fovea::guard
