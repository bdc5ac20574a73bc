// SPDX-License-Identifier: Apache-2.0
// The guard with wishes of every kind: no limit is ever exceeded.
#include "firmware/core/guard/guard_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <iostream>

#include "firmware/core/barriers/barrier_speed.hpp"
#include "firmware/core/guard/approach_velocity.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"
#include "fovea/hal/types.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::guard {
namespace {

constexpr double kTick = hal::kTickPeriodS;

// Moves a reference that the arm follows perfectly, and keeps the largest share used of each limit.
class Walker {
 public:
  explicit Walker(const config::ServoConfig& config, const model::VecN& q) : config_(config) {
    reference_.q = q;
    reference_.dq = model::VecN::Zero(q.size());
    reference_.ddq = model::VecN::Zero(q.size());
    Update();
  }

  hal::LimitSet Step(const model::VecN& dq_des) { return Step(MotionWish::Velocity(dq_des)); }
  void BrakeJointByJoint() {
    const model::VecN rest = model::VecN::Zero(reference_.dq.size());
    ApproachAlone(config_, rest, rest, reference_);
    Update();
  }
  hal::LimitSet Stop() { return Step(StopTogether(config_, reference_)); }
  hal::LimitSet Step(const MotionWish& wish) {
    const trajectory::Reference before = reference_;
    const hal::LimitSet limits = GuardMotion(config_, wish, poses_.X_BE.p, J_E_B_, known_, reference_);
    for (int i = 0; i < reference_.q.size(); ++i) {
      const model::Joint& joint = config_.arm.joints[static_cast<std::size_t>(i)];
      const double half = 0.5 * (joint.q_max - joint.q_min) - config_.guard.joint_position_margin;
      const double middle = 0.5 * (joint.q_max + joint.q_min);
      Use(position, std::abs(reference_.q[i] - middle) / half);
      Use(velocity, std::abs(reference_.dq[i]) / (config_.guard.joint_velocity_fraction * joint.dq_max));
      Use(acceleration,
          std::abs(reference_.ddq[i]) / (config_.guard.joint_acceleration_fraction * joint.ddq_max));
      Use(jerk, std::abs(reference_.ddq[i] - before.ddq[i]) /
                    (config_.guard.joint_jerk_fraction * joint.dddq_max * kTick));
      // The reference is consistent: each derivative is the change of the quantity above.
      EXPECT_NEAR(reference_.q[i] - before.q[i], reference_.dq[i] * kTick, 1e-12);
      EXPECT_NEAR(reference_.dq[i] - before.dq[i], reference_.ddq[i] * kTick, 1e-12);
    }
    Update();
    Use(speed, (J_E_B_.lazyProduct(reference_.dq)).norm() / config_.guard.cartesian_speed);
    Use(turn,
        model::AngularVelocity(config_.arm, poses_, reference_.dq).norm() / config_.guard.rotation_speed);
    radius = std::max(radius, poses_.X_BE.p.norm());
    all_limits |= limits;
    return limits;
  }

  // The joint velocity that moves the end effector with `v_B` [m/s] as well as possible.
  [[nodiscard]] model::VecN Towards(const model::Vec3& v_B) const {
    const Eigen::MatrixXd J = J_E_B_;
    return J.completeOrthogonalDecomposition().solve(Eigen::VectorXd(v_B));
  }

  [[nodiscard]] const model::Vec3& p_BE() const { return poses_.X_BE.p; }
  [[nodiscard]] const trajectory::Reference& reference() const { return reference_; }

  double position = 0.0, velocity = 0.0, acceleration = 0.0, jerk = 0.0, speed = 0.0,
         turn = 0.0;    // largest share used of each limit
  double radius = 0.0;  // largest |p_BE|
  hal::LimitSet all_limits = 0;

 private:
  static void Use(double& most, double now) { most = std::max(most, now); }
  void Update() {
    model::ComputePoses(config_.arm, reference_.q, poses_);
    model::ComputeLinearJacobian(config_.arm, poses_, poses_.X_BE.p, J_E_B_);
  }

  config::ServoConfig config_;
  trajectory::Reference reference_;
  model::ArmPoses poses_;
  KnownClearances known_;
  model::LinearJacobian J_E_B_;
};

void ExpectAllHeld(const Walker& walker, const config::ServoConfig& config) {
  std::cout << "largest use: position " << walker.position << ", velocity " << walker.velocity
            << ", acceleration " << walker.acceleration << ", jerk " << walker.jerk << ", hand's speed "
            << walker.speed << ", its turn " << walker.turn << ", |p_BE| " << walker.radius << " m\n";
  EXPECT_LE(walker.position, 1.0 + 1e-3);
  EXPECT_LE(walker.velocity, 1.0 + 0.01);  // braking at full jerk may end slightly later
  EXPECT_LE(walker.acceleration, 1.0 + 1e-9);
  EXPECT_LE(walker.jerk, 1.0 + 1e-9);
  EXPECT_LE(walker.speed, 1.0);
  EXPECT_LE(walker.turn, 1.0);
  EXPECT_LE(walker.radius, config.guard.workspace_radius + 1e-3);
}

TEST(GuardMotionTest, KeepsEveryLimitUnderRandomCommands) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(31);
  Walker walker(config, test::Ready());
  model::VecN wish = model::VecN::Zero(7);
  for (int tick = 0; tick < test::Repetitions(200'000); ++tick) {
    if (tick % 97 == 0) {
      wish = random.Joints(config.arm, random.Uniform(0.0, 1.0) < 0.1 ? 1e6 : 3.0);
    }
    walker.Step(wish);
  }
  ExpectAllHeld(walker, config);
}

// Joints reach their velocities at different times: the hand would be faster in between than at either end.
TEST(GuardMotionTest, HandKeepsItsSpeedLimitUnderRandomWishes) {
  config::ServoConfig config = test::PandaConfig();
  config.guard.cartesian_speed = 0.3;
  test::RandomStates random(32);
  Walker walker(config, test::Ready());
  model::VecN wish = model::VecN::Zero(7);
  for (int tick = 0; tick < test::Repetitions(200'000); ++tick) {
    if (tick % 97 == 0) {
      wish = random.Joints(config.arm, 3.0);
    }
    walker.Step(wish);
  }
  ExpectAllHeld(walker, config);
  EXPECT_GT(walker.speed, 0.9) << "the wishes must reach the limit";
  EXPECT_NE(walker.all_limits & hal::Bit(hal::Limit::kCartesianSpeed), 0U);
}

TEST(GuardMotionTest, HandKeepsItsRotationLimitUnderRandomWishes) {
  for (const double most : {0.5, 1.2, 2.5}) {
    config::ServoConfig config = test::PandaConfig();
    config.guard.rotation_speed = most;
    test::RandomStates random(33);
    Walker walker(config, test::Ready());
    model::VecN wish = model::VecN::Zero(7);
    for (int tick = 0; tick < test::Repetitions(100'000); ++tick) {
      if (tick % 97 == 0) {
        wish = random.Joints(config.arm, 3.0);
      }
      walker.Step(wish);
    }
    ExpectAllHeld(walker, config);
    EXPECT_GT(walker.turn * most, 0.9 * config::TurnLimitOfReference(config.guard))
        << "the wishes must reach the limit";
    // Slightly more is possible between the points that the proof of a stop samples.
    EXPECT_LT(walker.turn * most, 1.05 * config::kTurnShareMost * config::TurnLimitOfReference(config.guard));
    EXPECT_NE(walker.all_limits & hal::Bit(hal::Limit::kRotationSpeed), 0U);
  }
}

// THEORY B5: towards the boundary, along it, and obliquely, at 1 m/s, from many places.
TEST(GuardMotionTest, AttacksOnTheWorkspaceStopInsideIt) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(32);
  double worst = 0.0;
  int reached = 0;
  constexpr int kAttacks = test::Repetitions(300);
  for (int attack = 0; attack < kAttacks; ++attack) {
    Walker walker(config, test::Ready() + random.Joints(config.arm, 0.3));
    const model::Vec3 direction = random.Vector(1.0).normalized();
    const double turn = random.Uniform(-2.0, 2.0);
    for (int tick = 0; tick < 3000; ++tick) {
      // Outward at first, then more and more along the boundary.
      const model::Vec3 outward = walker.p_BE().normalized();
      const double share = attack % 3 == 0 ? 0.0 : std::min(1.0, tick / 1500.0);
      const model::Vec3 along = model::Cross(outward, direction).normalized() * (turn > 0 ? 1.0 : -1.0);
      const model::Vec3 v =
          attack % 3 == 2 ? direction : model::Vec3((1.0 - share) * outward + share * along);
      const model::VecN wish = walker.Towards(v.normalized());
      walker.Step(wish.allFinite() ? wish : model::VecN(model::VecN::Zero(7)));
    }
    worst = std::max(worst, walker.radius);
    reached += walker.radius > config.guard.workspace_radius - 0.01 ? 1 : 0;
  }
  std::cout << kAttacks << " attacks, " << reached << " reached the last centimetre; furthest |p_BE| "
            << worst << " m, boundary " << config.guard.workspace_radius << " m\n";
  EXPECT_LE(worst, config.guard.workspace_radius + 1e-3);
  EXPECT_GT(reached, kAttacks / 6) << "too few attacks reach the boundary";
}

TEST(GuardMotionTest, JointsStopBeforeTheEndOfTheirRange) {
  const config::ServoConfig config = test::PandaConfig();
  for (int joint = 0; joint < 7; ++joint) {
    for (const double sign : {-1.0, 1.0}) {
      config::ServoConfig far = config;
      far.guard.workspace_radius = 10.0;  // only joint limits shall act
      far.guard.self_clearance = 0.0;
      Walker walker(far, test::Ready());
      model::VecN wish = model::VecN::Zero(7);
      wish[joint] = sign * 10.0;
      hal::LimitSet last = 0;
      for (int tick = 0; tick < 5000; ++tick) {
        last = walker.Step(wish);
      }
      EXPECT_LE(walker.position, 1.0 + 1e-3) << "joint " << joint + 1;
      EXPECT_GE(walker.position, 1.0 - 1e-2) << "the joint reaches the end of its range";
      EXPECT_LT(walker.reference().dq.norm(), 1e-2) << "the joint stands there";
      EXPECT_TRUE(last & hal::Bit(hal::Limit::kJointPosition)) << "the limit is reported";
    }
  }
}

// The barriers brake in time with the configured deceleration. The proof of a stop behind them covers what
// they cannot foresee, and brakes with all available acceleration.
TEST(GuardMotionTest, JointBrakesBeforeItsEndWithTheBarriersDeceleration) {
  config::ServoConfig config = test::PandaConfig();
  config.guard.workspace_radius = 10.0;
  config.guard.self_clearance = 0.0;
  double most = 0.0;
  for (int joint = 0; joint < 7; ++joint) {
    for (const double sign : {-1.0, 1.0}) {
      Walker walker(config, test::Ready());
      model::VecN wish = model::VecN::Zero(7);
      wish[joint] = sign * 10.0;
      for (int tick = 0; tick < 5000; ++tick) {
        walker.Step(wish);
        most =
            std::max(most, -sign * walker.reference().ddq[joint] / trajectory::PaceOf(config, joint).ddq_max);
      }
    }
  }
  std::cout << "brakes with " << most
            << " of the available acceleration, configured: " << config.guard.braking_fraction << "\n";
  EXPECT_LT(most, 1.2 * config.guard.braking_fraction);
}

TEST(GuardMotionTest, HandSpeedTowardsTheWorkspaceEdgeKeepsTheBarrier) {
  const config::ServoConfig config = test::PandaConfig();
  const config::GuardConfig& guard = config.guard;
  Walker walker(config, test::Ready());
  double most = 0.0;
  for (int tick = 0; tick < 3000; ++tick) {
    const model::Vec3 p = walker.p_BE();
    walker.Step(walker.Towards(p.normalized()));
    const double left = guard.workspace_radius - guard.workspace_margin - p.norm();
    const double allowed =
        barriers::BarrierSpeed(left, guard.workspace_deceleration, trajectory::SlowestReaction(config));
    most = std::max(most, (walker.p_BE() - p).dot(p.normalized()) / kTick - allowed);
  }
  std::cout << "at most " << most << " m/s faster\n";
  EXPECT_LT(most, 0.12);  // since jerk is limited; without the barrier 0.23, then the proof of a stop acts
}

// From random motions, with every limit in force: joints that stop together stop the hand at most 10 ms later
// than independent ones, and do not speed it up. Independent joints do: the test prints both.
TEST(GuardMotionTest, JointsStoppingTogetherDoNotSpeedUpTheHand) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(35);
  double most_gained = 0.0;
  double most_gained_alone = 0.0;
  int latest = 0;
  int longest = 0;
  constexpr double kSteady = 1.0;  // rad/s^2
  for (int k = 0; k < test::Repetitions(300); ++k) {
    Walker together(config, test::Ready());
    const model::VecN wish = random.Joints(config.arm, 1.5);
    int run_up = 0;
    do {  // until the joints have reached their speeds
      together.Step(wish);
    } while (++run_up < 100 || (together.reference().ddq.norm() > kSteady && run_up < 2000));
    ASSERT_LE(together.reference().ddq.norm(), kSteady) << "in repetition " << k;
    longest = std::max(longest, run_up);
    Walker alone = together;
    const auto stop = [](Walker& walker, auto step) {
      double gained = 0.0;
      int ticks = 0;
      double start = -1.0;
      while (walker.reference().dq.norm() > 1e-6 && ticks < 2000) {
        const model::Vec3 p = walker.p_BE();
        step(walker);
        const double speed = (walker.p_BE() - p).norm() / kTick;
        start = start < 0.0 ? speed : start;
        gained = std::max(gained, speed - start);
        ++ticks;
      }
      return std::pair(gained, ticks);
    };
    const auto [gained, ticks] = stop(together, [](Walker& w) { w.Stop(); });
    const auto [gained_alone, ticks_alone] = stop(alone, [](Walker& w) { w.BrakeJointByJoint(); });
    most_gained = std::max(most_gained, gained);
    most_gained_alone = std::max(most_gained_alone, gained_alone);
    latest = std::max(latest, ticks - ticks_alone);
    EXPECT_LE(together.jerk, 1.0 + 1e-9);
    EXPECT_LE(together.acceleration, 1.0 + 1e-9);
  }
  std::cout << "the hand gains at most " << most_gained << " m/s, joint by joint " << most_gained_alone
            << " m/s; at rest at most " << latest << " ms later; run-up at most " << longest << " ms\n";
  EXPECT_LT(most_gained, 0.015);
  EXPECT_GT(most_gained_alone, 0.06) << "the comparison must differ";
  EXPECT_LE(latest, 10);
}

TEST(GuardMotionTest, PassesAGentleCommandUnchanged) {
  const config::ServoConfig config = test::PandaConfig();
  Walker walker(config, test::Ready());
  const model::VecN wish = model::VecN::Constant(7, 0.05);
  for (int tick = 0; tick < 500; ++tick) {
    walker.Step(wish);
  }
  EXPECT_LT((walker.reference().dq - wish).norm(), 1e-9);
  EXPECT_EQ(walker.Step(wish), 0U);
}

TEST(GuardMotionTest, ScalesTheVelocityWithoutChangingItsDirection) {
  config::ServoConfig config = test::PandaConfig();
  config.guard.rotation_speed = 100.0;  // only the joints' own limits shall act
  config.guard.workspace_radius = 10.0;
  Walker walker(config, test::Ready());
  model::VecN wish(7);
  wish << 8.0, 1.0, -2.0, 0.5, 0.0, 3.0, -4.0;
  for (int tick = 0; tick < 400; ++tick) {
    walker.Step(wish);
  }
  const model::VecN dq = walker.reference().dq;
  EXPECT_GT(dq.dot(wish) / (dq.norm() * wish.norm()), 1.0 - 1e-9);
  EXPECT_NEAR(dq[0], config.guard.joint_velocity_fraction * config.arm.joints[0].dq_max, 1e-9);
}

// Below all limits of speed, a motion that begins, changes and ends does so on its way.
TEST(GuardMotionTest, KeepsTheDirectionWhileTheSpeedChanges) {
  const config::ServoConfig config = test::PandaConfig();
  Walker walker(config, test::Ready());
  model::VecN way(7);
  way << 0.3, 0.02, -0.1, 0.05, 0.2, -0.15, 0.4;
  double aside = 0.0;
  for (int tick = 0; tick < 900; ++tick) {
    const double share = tick < 300 ? 1.0 : tick < 600 ? -0.5 : 0.0;
    walker.Step(share * way);
    const model::VecN dq = walker.reference().dq;
    aside = std::max(aside, (dq - dq.dot(way) / way.squaredNorm() * way).norm() / way.norm());
  }
  std::cout << "aside at most " << aside << " of the speed\n";
  EXPECT_LT(aside, 0.1);
  EXPECT_LT(walker.reference().dq.norm(), 1e-9);
}

TEST(GuardMotionTest, OutsideTheWorkspaceOnlyInwardMotionIsAllowed) {
  config::ServoConfig config = test::PandaConfig();
  config.guard.workspace_radius = 0.5;  // the arm stands outside it
  Walker walker(config, test::Ready());
  ASSERT_GT(walker.p_BE().norm(), 0.5);
  const double start = walker.p_BE().norm();
  for (int tick = 0; tick < 300; ++tick) {
    walker.Step(walker.Towards(walker.p_BE().normalized() * 0.3));
  }
  EXPECT_LE(walker.p_BE().norm(), start + 1e-4);
  for (int tick = 0; tick < 2000; ++tick) {
    walker.Step(walker.Towards(-walker.p_BE().normalized() * 0.3));
  }
  EXPECT_LT(walker.p_BE().norm(), start - 0.05);
}

TEST(BarrierSpeedTest, SpeedLimitStopsExactlyAtTheBarrier) {
  for (const double distance : {1e-6, 1e-3, 0.05, 1.0}) {
    for (const double deceleration : {0.5, 3.0, 20.0}) {
      const double reaction = 0.02;
      const double v = barriers::BarrierSpeed(distance, deceleration, reaction);
      EXPECT_NEAR(v * reaction + v * v / (2.0 * deceleration), distance, 1e-12);
    }
  }
  EXPECT_EQ(barriers::BarrierSpeed(0.0, 3.0, 0.01), 0.0);
  EXPECT_EQ(barriers::BarrierSpeed(-1.0, 3.0, 0.01), 0.0);
  EXPECT_EQ(barriers::BarrierSpeed(std::nan(""), 3.0, 0.01), 0.0);
}

}  // namespace
}  // namespace fovea::guard
