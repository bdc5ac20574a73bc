// SPDX-License-Identifier: Apache-2.0
// The detector of pushes: large torques, sudden torques, and the arm's own slow errors.
#include "firmware/core/estimate/push.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>
#include <limits>

#include "tests/support/panda.hpp"

namespace fovea::estimate {
namespace {

constexpr PushShares kLimits{.total = 0.2, .sudden = 0.1};

class PushTest : public testing::Test {
 protected:
  // The first tick [ms] in which a joint is pushed, -1: none within `ms`. `share_at`: of joint 2's torque.
  int PushedAfter(int ms, const std::function<double(double t_s)>& share_at) {
    for (int tick = 0; tick < ms; ++tick) {
      tau_ext_[1] = share_at(1e-3 * tick) * config_.arm.joints[1].tau_max;
      WatchPush(tau_ext_, watch_);
      joint_ = PushedJoint(config_.arm, kLimits, tau_ext_, watch_);
      if (joint_ >= 0) {
        return tick;
      }
    }
    return -1;
  }

  config::ServoConfig config_ = test::PandaConfig();
  model::VecN tau_ext_ = model::VecN::Zero(7);
  PushWatch watch_;
  std::int32_t joint_ = -1;
};

TEST_F(PushTest, SlowErrorsBelowTheTotalLimitAreNoPush) {
  // 0.19 of the joint's torque from the start, then to the other sign at the speed of a quick motion.
  EXPECT_EQ(PushedAfter(1000, [](double) { return 0.19; }), -1);
  EXPECT_EQ(PushedAfter(2000, [](double t_s) { return 0.19 * std::cos(2.0 * t_s); }), -1);
}

TEST_F(PushTest, TotalLimitHoldsHoweverSlowlyTheTorqueGrows) {
  const int ms = PushedAfter(5000, [](double t_s) { return 0.05 * t_s; });
  EXPECT_EQ(joint_, 1);
  EXPECT_NEAR(ms, 4000, 2);
}

TEST_F(PushTest, SuddenTorqueIsAPushBelowTheTotalLimit) {
  // The observer shows a push of 0.15 with a time constant of 17 ms, on an error of -0.08.
  const auto share_at = [](double t_s) {
    return t_s < 1.0 ? -0.08 : 0.07 - 0.15 * std::exp(-60.0 * (t_s - 1.0));
  };
  const int ms = PushedAfter(2000, share_at);
  std::cout << "detected after " << ms - 1000 << " ms\n";
  EXPECT_EQ(joint_, 1);
  EXPECT_GT(ms, 1000);
  EXPECT_LT(ms, 1030);
}

// An observer that begins approaches the arm's own error within some of its time constants.
TEST_F(PushTest, BeginOfTheObserverIsNoPush) {
  EXPECT_EQ(PushedAfter(1000, [](double t_s) { return 0.18 * (1.0 - std::exp(-60.0 * t_s)); }), -1);
}

TEST_F(PushTest, TorqueThatIsNoNumberIsAPush) {
  EXPECT_EQ(PushedAfter(10, [](double) { return std::numeric_limits<double>::quiet_NaN(); }), 0);
}

}  // namespace
}  // namespace fovea::estimate
