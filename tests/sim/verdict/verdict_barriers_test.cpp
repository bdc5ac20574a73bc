// SPDX-License-Identifier: Apache-2.0
// Limits on the ground truth, one after the other, and the arm's motion when it should be at rest.
#include "sim/verdict/barriers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>

#include "sim/verdict/unwanted_motion.hpp"
#include "tests/support/panda.hpp"

namespace fovea::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

constexpr std::int64_t kMs = 1'000'000;

Truth StandingAt(std::int64_t k, const Eigen::Vector3d& p_BE) {
  Truth truth;
  truth.stamp_ns = k * kMs;
  truth.q = test::Ready();
  truth.dq = truth.tau_cmd = Eigen::VectorXd::Zero(7);
  truth.X_BE.translation() = p_BE;
  return truth;
}

class VerdictBarriersTest : public testing::Test {
 protected:
  VerdictBarriersTest() {
    config_.arm = test::Panda().model;
    config_.obstacles.num_planes = 1;
    config_.obstacles.planes[0] = {model::Vec3::UnitZ(), 0.1};
    config_.obstacles.num_boxes = 1;
    config_.obstacles.boxes[0] = {{0.4, -0.1, 0.0}, {0.6, 0.1, 0.3}};
  }
  // A run of 100 ms, modified by `change`, with the servo in `mode`.
  Summary Judge(const std::function<void(std::int64_t k, Truth&)>& change,
                hal::Mode mode = hal::Mode::kTrack) const {
    TruthBarriers barriers(config_);
    for (std::int64_t k = 0; k <= 100; ++k) {
      Truth truth = StandingAt(k, {0.3, 0.0, 0.5});
      change(k, truth);
      barriers.Add(truth, mode);
    }
    Summary summary;
    barriers.book().AddTo(summary);
    summary.limit_violations = barriers.book().passed_ns().size();
    return summary;
  }

  BarrierConfig config_;
};

// A box on the bench counts, whether the servo knows it or not.
TEST_F(VerdictBarriersTest, TrueBoxesCount) {
  config_.boxes = {{Eigen::Vector3d(0.25, -0.1, 0.4), Eigen::Vector3d(0.35, 0.1, 0.47)},
                   {Eigen::Vector3d(0.25, -0.1, 0.4), Eigen::Vector3d(0.35, 0.1, 0.51)}};
  const Summary s = Judge([](std::int64_t /*k*/, Truth& /*truth*/) {});
  EXPECT_NEAR(s.clearances_m.at("hand.bench.boxes[0]"), 0.03, 1e-12);
  EXPECT_NEAR(s.clearances_m.at("hand.bench.boxes[1]"), -0.01, 1e-12);
  EXPECT_EQ(s.violations.at("hand.bench.boxes[1]"), 101U);
}

TEST_F(VerdictBarriersTest, ArmClearOfAllBarriersViolatesNone) {
  const Summary s = Judge([](auto, Truth&) {});
  EXPECT_EQ(s.limit_violations, 0U);
  EXPECT_THAT(s.violations, IsEmpty());
  EXPECT_NEAR(s.clearances_m.at("hand.planes[0]"), 0.4, 1e-12);
  EXPECT_NEAR(s.clearances_m.at("hand.boxes[0]"), std::hypot(0.1, 0.2), 1e-12);
  EXPECT_EQ(s.limits.at("cartesian_speed"), 0.0);
}

// The flange is clear, but the camera bolted to it is not.
TEST_F(VerdictBarriersTest, CameraBelowAPlaneOrInABoxIsCounted) {
  ASSERT_TRUE(config_.hand.AddCapsule(model::Vec3::Zero(), {0.15, 0.0, -0.25}, 0.03));
  const Summary s = Judge([](auto, Truth&) {});  // the camera is at (0.45, 0, 0.25)
  EXPECT_NEAR(s.clearances_m.at("hand.planes[0]"), 0.12, 0.005);
  EXPECT_NEAR(s.clearances_m.at("hand.boxes[0]"), -0.08, 0.005);
  EXPECT_EQ(s.violations.at("hand.boxes[0]"), 101U);
}

TEST_F(VerdictBarriersTest, HandBelowAPlaneOrInABoxIsCounted) {
  const Summary below = Judge([](auto k, Truth& t) { t.X_BE.translation().z() -= 0.0045 * double(k); });
  EXPECT_NEAR(below.clearances_m.at("hand.planes[0]"), -0.05, 1e-12);
  EXPECT_THAT(below.violations, ElementsAre(Pair("cartesian_speed", 100), Pair("hand.planes[0]", 12)));
  EXPECT_EQ(below.limit_violations, 100U);

  const Summary within = Judge([](auto k, Truth& t) {
    if (k > 50) {
      t.X_BE.translation() = Eigen::Vector3d(0.41, 0.0, 0.2);
    }
  });
  EXPECT_NEAR(within.clearances_m.at("hand.boxes[0]"), -0.01, 1e-12);
  EXPECT_EQ(within.violations.at("hand.boxes[0]"), 50U);
}

TEST_F(VerdictBarriersTest, HandAboveItsSpeedLimitIsCounted) {
  const auto at = [&](double speed) {
    return Judge([speed](auto k, Truth& t) { t.X_BE.translation().y() = 1e-3 * speed * double(k); });
  };
  EXPECT_THAT(at(1.69).violations, IsEmpty());
  EXPECT_NEAR(at(1.69).limits.at("cartesian_speed"), 1.69 / 1.7, 1e-9);
  EXPECT_THAT(at(1.71).violations, ElementsAre(Pair("cartesian_speed", 100)));
}

TEST_F(VerdictBarriersTest, HandTurningFasterThanItMayIsCounted) {
  const auto at = [&](double turn) {
    return Judge([turn](auto k, Truth& t) {
      t.X_BE.linear() = Eigen::AngleAxisd(1e-3 * turn * double(k), Eigen::Vector3d(0.6, 0.0, 0.8)).matrix();
    });
  };
  EXPECT_THAT(at(2.49).violations, IsEmpty());
  EXPECT_NEAR(at(2.49).limits.at("rotation_speed"), 2.49 / 2.5, 1e-6);
  EXPECT_THAT(at(2.51).violations, ElementsAre(Pair("rotation_speed", 100)));
}

TEST_F(VerdictBarriersTest, EveryKindOfContactIsCounted) {
  const auto touches = [&](const Contacts& contacts) {
    return Judge([&](auto k, Truth& t) { t.contacts = k == 30 || k == 31 ? contacts : Contacts{}; });
  };
  EXPECT_THAT(touches({3, false, false}).violations, ElementsAre(Pair("contact_bench", 2)));
  EXPECT_THAT(touches({0, true, false}).violations, ElementsAre(Pair("contact_target", 2)));
  EXPECT_THAT(touches({0, false, true}).violations, ElementsAre(Pair("contact_self", 2)));
  EXPECT_EQ(touches({1, true, true}).limit_violations, 2U) << "a tick counts once";
}

// Joint 1's limit is 15 rad/s^2. The average over 10 ms counts, so a short peak is no
// violation. In Fault and up to 10 ms after it nothing counts.
TEST_F(VerdictBarriersTest, TrueAccelerationIsAveragedOverTenMilliseconds) {
  const auto with = [&](double ddq, std::int64_t ticks, hal::Mode mode) {
    double dq = 0.0;
    return Judge(
        [&, ddq, ticks](auto k, Truth& t) {
          dq += k > 20 && k <= 20 + ticks ? 1e-3 * ddq : 0.0;
          t.dq[0] = dq;
        },
        mode);
  };
  EXPECT_THAT(with(14.9, 40, hal::Mode::kTrack).violations, IsEmpty());
  EXPECT_NEAR(with(14.9, 40, hal::Mode::kTrack).limits.at("true_joint_acceleration"), 14.9 / 15.0, 1e-9);
  EXPECT_THAT(with(15.1, 40, hal::Mode::kTrack).violations, ElementsAre(Pair("true_joint_acceleration", 31)));
  EXPECT_THAT(with(60.0, 2, hal::Mode::kTrack).violations, IsEmpty());
  EXPECT_THAT(with(60.0, 3, hal::Mode::kTrack).violations, ElementsAre(Pair("true_joint_acceleration", 8)));
  EXPECT_THAT(with(60.0, 3, hal::Mode::kFault).violations, IsEmpty());
}

TEST_F(VerdictBarriersTest, TrueJerkIsShownAndNotJudged) {
  const Summary s = Judge([](auto k, Truth& t) { t.dq[0] = k > 50 ? 0.1 : 0.0; });
  EXPECT_THAT(s.violations, IsEmpty());
  EXPECT_NEAR(s.unjudged.at("true_joint_jerk"), 100.0 / (config_.arm.joints[0].dddq_max * 1e-3), 1e-9);
}

TEST_F(VerdictBarriersTest, NonFiniteVelocityIsAViolation) {
  const Summary s = Judge([](auto k, Truth& t) { t.dq[3] = k == 7 ? std::nan("") : 0.0; }, hal::Mode::kFault);
  EXPECT_EQ(s.violations.at("joint_velocity"), 1U);
}

// A failed motor accelerates its joint: no violation, as long as the
// acceleration without the disturbance is within the limit.
TEST_F(VerdictBarriersTest, AccelerationByADisturbanceIsNoViolation) {
  const auto with = [&](double ddq, double disturbed) {
    double dq = 0.0;
    return Judge([&, ddq, disturbed](auto k, Truth& t) {
      const bool pulled = k > 20 && k <= 60;
      dq += pulled ? 1e-3 * ddq : 0.0;
      t.dq[0] = dq;
      if (pulled) {
        t.ddq_disturbed.setConstant(7, disturbed);
      }
    });
  };
  EXPECT_THAT(with(-40.0, -40.0).violations, IsEmpty());
  EXPECT_NEAR(with(-40.0, -30.0).limits.at("true_joint_acceleration"), 10.0 / 15.0, 1e-9);
  EXPECT_THAT(with(-40.0, -24.0).violations, ElementsAre(Pair("true_joint_acceleration", 31)));
  EXPECT_THAT(with(-40.0, -80.0).violations, IsEmpty()) << "the servo works against the disturbance";
  EXPECT_THAT(with(16.0, -40.0).violations, ElementsAre(Pair("true_joint_acceleration", 31)))
      << "beyond the limit, against the disturbance";
  EXPECT_THAT(with(0.0, -40.0).violations, IsEmpty()) << "the joint is held";
  // After a disturbance the joint may spring back; this allowance fades.
  const auto let_go = [&](std::int64_t at, double beside = 0.0) {
    double dq = 0.0;
    return Judge([&, at, beside](auto k, Truth& t) {
      dq += k > at && k <= at + 15 ? 1e-3 * 20.0 : 0.0;
      t.dq[0] = dq;
      if (k <= 20) {
        t.ddq_disturbed.setConstant(7, -10.0);
      } else if (beside != 0.0) {
        t.ddq_disturbed.setConstant(7, beside);
      }
    });
  };
  EXPECT_THAT(let_go(21).violations, IsEmpty());
  EXPECT_THAT(let_go(21, -1e-6).violations, IsEmpty()) << "a simultaneous small disturbance changes nothing";
  EXPECT_THAT(let_go(85).violations, ElementsAre(Pair("true_joint_acceleration", 6)));
}

StopRules Rules() {
  StopRules rules;
  rules.ddq_max.setConstant(7, 10.0);
  rules.dddq_max.setConstant(7, 1000.0);
  rules.brake_after_s = 0.3;
  return rules;
}

// A hand that moves along x, and joint 3 with it.
struct Walk {
  UnwantedMotion unwanted{Rules()};
  std::int64_t k = 0;
  double x = 0.0;
  double joint_share = 0.0;  // joint 3's speed over the hand's [rad/m]

  void Go(hal::Mode mode, std::int64_t ticks, double speed) {
    for (std::int64_t i = 0; i < ticks; ++i) {
      x += 1e-3 * speed;
      Truth truth = StandingAt(k++, {x, 0.0, 0.5});
      truth.dq[2] = joint_share * speed;
      unwanted.Add(truth, mode);
    }
  }
};

TEST(UnwantedMotionTest, StoppingDistanceIsSubtracted) {
  Walk walk;
  walk.joint_share = -2.0;
  walk.Go(hal::Mode::kTrack, 10, 1.0);
  walk.Go(hal::Mode::kHold, 200, 1.0);  // a stop may take 0.5 * 2 / 10 s + 0.02 s
  walk.Go(hal::Mode::kTrack, 10, 0.5);
  walk.Go(hal::Mode::kFault, 400, 0.5);
  const UnwantedMotion& unwanted = walk.unwanted;
  EXPECT_NEAR(unwanted.by_mode().at("hold").most_mm, 200.0, 1e-9);
  EXPECT_NEAR(unwanted.by_mode().at("hold").beyond_stop_mm, 200.0 - 120.0, 1e-9);
  EXPECT_NEAR(unwanted.by_mode().at("fault").beyond_stop_mm, 200.0 - 150.0, 1e-9);
  EXPECT_NEAR(unwanted.by_mode().at("hold").gained_m_per_s, 0.0, 1e-9);
  // Accelerating at 5 m/s^2: reversing that within 0.02 s allows a gain of 0.05 m/s.
  UnwantedMotion accelerating(Rules());
  double x = 0.0;
  for (std::int64_t i = 0; i <= 120; ++i) {
    x += 1e-3 * 5e-3 * static_cast<double>(i);
    accelerating.Add(StandingAt(i, {x, 0.0, 0.5}), i < 100 ? hal::Mode::kTrack : hal::Mode::kHold);
  }
  EXPECT_NEAR(accelerating.by_mode().at("hold").gained_m_per_s, 0.6 - 0.495 - 0.05, 1e-6);
}

TEST(UnwantedMotionTest, IsMeasuredFromTheStartOfTheMode) {
  Walk walk;
  walk.Go(hal::Mode::kBoot, 1, 0.0);
  walk.Go(hal::Mode::kBoot, 50, 0.1);    // falls by 5 mm
  walk.Go(hal::Mode::kTrack, 100, 1.0);  // wanted motion
  walk.Go(hal::Mode::kFault, 20, 1.2);   // 24 mm more, faster at first
  walk.Go(hal::Mode::kFault, 20, 0.2);   // 4 mm more
  walk.Go(hal::Mode::kTrack, 10, 0.3);
  walk.Go(hal::Mode::kFault, 10, 0.3);
  const auto& by_mode = walk.unwanted.by_mode();
  ASSERT_EQ(by_mode.size(), 2U);
  EXPECT_NEAR(by_mode.at("boot").most_mm, 5.0, 1e-9);
  EXPECT_NEAR(by_mode.at("boot").beyond_stop_mm, 5.0, 1e-9) << "at rest when Boot starts";
  EXPECT_NEAR(by_mode.at("boot").most_m_per_s, 0.1, 1e-9);
  EXPECT_NEAR(by_mode.at("boot").gained_m_per_s, 0.1, 1e-9);
  EXPECT_NEAR(by_mode.at("fault").most_mm, 28.0, 1e-9);
  EXPECT_NEAR(by_mode.at("fault").most_m_per_s, 1.2, 1e-9);
  EXPECT_NEAR(by_mode.at("fault").gained_m_per_s, 0.2, 1e-9);
}

}  // namespace
}  // namespace fovea::sim
