// SPDX-License-Identifier: Apache-2.0
// Faults in closed loop. Each is provoked while the arm in Bullet moves, and must be latched after a stated
// number of ticks. The arm must come to rest, its brakes close, and only a reset ends the fault.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

#include "tests/closed_loop/guard_bench.hpp"
#include "tests/closed_loop/guard_provocations.hpp"

namespace fovea::test {
namespace {

using hal::Fault;
using hal::Mode;

constexpr double kStart = 0.5;  // when the provocation begins [s]
constexpr int kStartMs = 500;
constexpr double kNever = 1e6;

// An arm in full motion at kStart.
GuardSetup Moving() {
  GuardSetup setup;
  Eigen::VectorXd goal = setup.world.q_start;
  goal[0] += 1.2;
  goal[3] += 0.3;
  setup.motion = GoTo(0.1, goal);
  return setup;
}

// Checks that the fault comes `ticks` after `begin_ms`, that the arm stops, and that only a reset frees it.
void ExpectStop(GuardBench& bench, Fault fault, int begin_ms, int ticks, int tolerance,
                PushedBy by = PushedBy::kServo, double faster = 0.05) {
  bench.RunUntil(2.5);
  const int at = bench.FirstFault();
  ASSERT_GE(at, 0) << "no fault came";
  const auto first = std::find_if(bench.ticks().begin(), bench.ticks().end(),
                                  [&](const GuardTick& tick) { return tick.ms == at; });
  EXPECT_EQ(first->record.fault, fault) << hal::Name(first->record.fault);
  EXPECT_NEAR(at, begin_ms + ticks, tolerance);

  const double speed = bench.speeds()[static_cast<std::size_t>(at)];
  const auto fastest = std::max_element(bench.speeds().begin() + at, bench.speeds().end());
  const auto braked = std::find_if(bench.ticks().begin(), bench.ticks().end(),
                                   [](const GuardTick& tick) { return tick.record.command.engage_brakes; });
  ASSERT_NE(braked, bench.ticks().end()) << "the brakes never closed";
  PrintFigures(std::string(hal::Name(fault)) + ": latched " + std::to_string(at - begin_ms) +
                   " ticks after the provocation, at " + std::to_string(speed) +
                   " rad/s; fastest after that " + std::to_string(*fastest) + " rad/s, at rest " +
                   std::to_string(bench.AtRest() - at) + " and brakes " + std::to_string(braked->ms - at) +
                   " ticks after the fault",
               bench);
  EXPECT_LE(*fastest, 1.05 * speed + faster) << "the arm must not speed up";
  EXPECT_LT(bench.AtRest() - at, 700);
  EXPECT_EQ(bench.speeds().back(), 0.0);
  ExpectInsideLimits(bench, by);

  bench.Ask(task::Request::kTrack);
  bench.RunUntil(2.6);
  EXPECT_EQ(bench.last().record.mode, Mode::kFault) << "only a reset ends a fault";
  bench.Ask(task::Request::kReset);
  bench.RunUntil(2.7);
  EXPECT_EQ(bench.last().record.mode == Mode::kFault, bench.last().record.fault != Fault::kNone);
}

}  // namespace

void ProvokeArmLost() {
  GuardSetup setup = Moving();
  setup.arm_faults.packet_loss = {{kStart, 1.0}, 1.0};
  GuardBench bench(setup);
  ExpectStop(bench, Fault::kArmLost, kStartMs, setup.servo.safety.arm_lost_ticks - 1, 0);
}

void ProvokeArmStale() {
  GuardSetup setup = Moving();
  setup.arm_faults.clock_jump = {{kStart, 1.0}, -hal::kNsPerSecond};
  GuardBench bench(setup);
  ExpectStop(bench, Fault::kArmStale, kStartMs, setup.servo.safety.arm_lost_ticks - 1, 0);
}

void ProvokeNonFiniteSensor() {
  GuardSetup setup = Moving();
  setup.arm_faults.not_a_number = {{kStart, 1.0}, 3};
  GuardBench bench(setup);
  ExpectStop(bench, Fault::kNonFiniteSensor, kStartMs, setup.servo.safety.non_finite_ticks, 0);
  EXPECT_EQ(bench.ticks()[static_cast<std::size_t>(bench.FirstFault())].record.fault_joint, 3);
}

namespace {

// The arm tracks a target when the detector reports NaN.
void SpoilAFeature(bool plans) {
  GuardSetup setup;
  setup.servo.auto_track = true;
  setup.servo.law.plans = plans;
  setup.target = [](double) { return Eigen::Vector3d(0.56, 0.14, 0.04); };
  setup.spoil = [](hal::FeatureMeasurement& m) {
    if (m.stamp_ns >= (kStartMs - 40) * hal::kNsPerMs) {
      m.s[1] = std::numeric_limits<double>::quiet_NaN();
    }
  };
  GuardBench bench(setup);
  // With the next frame. On a plan the arm is accelerating: it goes on until the torque has changed, at its
  // rate.
  ExpectStop(bench, Fault::kNonFiniteFeature, kStartMs, 17, 17, PushedBy::kServo, plans ? 0.20 : 0.05);
  const auto said = std::find_if(bench.ticks().begin(), bench.ticks().end(), [](const GuardTick& tick) {
    return tick.record.has_feature && std::isnan(tick.record.feature.s[1]);
  });
  ASSERT_NE(said, bench.ticks().end());
  EXPECT_EQ(said->ms, bench.FirstFault()) << "in the tick that receives NaN";
}

}  // namespace

void ProvokeNonFiniteFeature() {
  SpoilAFeature(false);
  SpoilAFeature(true);
}

// The computer stalls for 30 ticks, the last command stays in force: a fault. One tick below the limit: none.
void ProvokeDeadlineMissed() {
  GuardSetup setup = Moving();
  setup.stall.window = {kStart, kStart + 0.030};
  GuardBench bench(setup);
  ExpectStop(bench, Fault::kDeadlineMissed, kStartMs, 30, 0);

  GuardSetup shorter = Moving();
  shorter.stall.window = {kStart, kStart + 0.001 * (shorter.servo.safety.missed_ticks - 1)};
  GuardBench goes_on(shorter);
  goes_on.RunUntil(2.5);
  PrintFigures("one missed tick less", goes_on);
  EXPECT_EQ(goes_on.last().record.mode, Mode::kHold) << hal::Name(goes_on.last().record.fault);
  ExpectInsideLimits(goes_on);
}

namespace {

// A floating arm, pushed at joint 1 only.
GuardSetup Pushed(double q1, double tau, double for_s) {
  GuardSetup setup;
  setup.servo.motion_law.kind = config::MotionLawKind::kFloat;
  setup.world.q_start[0] = q1;
  setup.world.push.tau = tau * Eigen::VectorXd::Unit(7, 0);
  setup.world.push.window = {0.3, 0.3 + for_s};
  return setup;
}

// World time [ms] of the first state in which `passed` holds; -1: never. The fault must come in that tick.
template <typename Passed>
int FirstPassed(const GuardBench& bench, Passed passed) {
  const auto found = std::find_if(bench.ticks().begin(), bench.ticks().end(),
                                  [&](const GuardTick& tick) { return passed(tick.record.arm); });
  return found == bench.ticks().end() ? -1 : found->ms;
}

}  // namespace

// A model with friction so large that a law which compensates it overflows once a joint moves. This stands
// for a defect of a law: no finite input makes the shipped laws overflow. The arm floats, and moves when the
// law is switched.
void ProvokeNonFiniteControl() {
  GuardSetup setup = Pushed(-1.5, 4.0, 0.05);
  setup.servo.motion_law.friction_compensation = 1.0;
  setup.servo.arm.joints[0].coulomb = std::numeric_limits<double>::max();
  setup.servo.arm.joints[0].viscous = std::numeric_limits<double>::max();
  GuardBench bench(setup);
  bench.RunUntil(kStart);
  ASSERT_EQ(bench.last().record.mode, Mode::kHold);
  bench.Ask(config::MotionLawKind::kComputedTorque);
  ExpectStop(bench, Fault::kNonFiniteControl, kStartMs, 0, 0);
}

void ProvokeJointOutside() {
  const model::Joint& joint = Panda().model.joints[0];
  GuardBench bench(Pushed(joint.q_max - 0.1, 2.0, 0.12));
  ExpectStop(bench, Fault::kJointPosition, 300, 160, 40, PushedBy::kWorld);
  EXPECT_EQ(bench.FirstFault(),
            FirstPassed(bench, [&](const hal::ArmState& arm) { return arm.q[0] > joint.q_max; }));
  std::cout << "stopped " << bench.truth().q[0] - joint.q_max << " rad past its end\n";
  EXPECT_LT(bench.truth().q[0], joint.q_max + 0.12);
}

void ProvokeJointTooFast() {
  const model::Joint& joint = Panda().model.joints[0];
  GuardBench bench(Pushed(-1.5, 7.0, 0.08));
  ExpectStop(bench, Fault::kJointVelocity, 300, 77, 4, PushedBy::kWorld);
  EXPECT_EQ(bench.FirstFault(),
            FirstPassed(bench, [&](const hal::ArmState& arm) { return arm.dq[0] > joint.dq_max; }));
}

// The motor of joint 1 gives no torque. The contact check, which would notice this sooner, is off.
void ProvokeNotFollowing() {
  GuardSetup setup = Moving();
  setup.servo.safety.contact_torque_fraction = setup.servo.safety.contact_sudden_fraction = 1e3;
  setup.world.torque_loss = {{0.1, kNever}, 0, 1.0};
  GuardBench bench(setup);
  ExpectStop(bench, Fault::kNotFollowing, 100, 143, 20);
  const auto& at = bench.ticks()[static_cast<std::size_t>(bench.FirstFault())].record;
  EXPECT_EQ(at.fault_joint, 0);
  const auto off = std::find_if(bench.ticks().begin(), bench.ticks().end(), [&](const GuardTick& tick) {
    return std::fabs(tick.record.q_cmd[0] - tick.record.arm.q[0]) > setup.servo.safety.following_error;
  });
  EXPECT_EQ(off->ms, bench.FirstFault()) << "in the first tick beyond following_error";
}

// Joint 2 of a standing arm is pushed with 1.5 times the allowed external torque. The observer's share of the
// push is 1 - exp(-K t): it exceeds the limit of a sudden torque first.
void ProvokeContact() {
  GuardSetup setup;
  const config::SafetyConfig& safety = setup.servo.safety;
  const double most = safety.contact_torque_fraction * Panda().model.joints[1].tau_max;
  setup.world.push.tau = 1.5 * most * Eigen::VectorXd::Unit(7, 1);
  const double share = safety.contact_sudden_fraction / (1.5 * safety.contact_torque_fraction);
  const double after_ms = -1e3 * std::log(1.0 - share) / safety.contact_gain;
  setup.world.push.window = {kStart, kStart + 1e-3 * (after_ms + 1.0)};  // then the arm must not speed up
  GuardBench bench(setup);
  std::cout << "expected after " << after_ms << " ticks\n";
  ExpectStop(bench, Fault::kContact, kStartMs, static_cast<int>(std::lround(after_ms)), 3);
  EXPECT_EQ(bench.ticks()[static_cast<std::size_t>(bench.FirstFault())].record.fault_joint, 1);
}

// The motor of a joint that carries the arm fails: damping cannot stop that joint, only the brakes can.
TEST(GuardFault, DeadMotorUnderLoadFaultsAndTheBrakesHold) {
  for (const int joint : {1, 3}) {
    GuardSetup setup;
    setup.world.torque_loss = {{kStart, kNever}, joint, 1.0};
    GuardBench bench(setup);
    bench.RunUntil(2.5);
    const int at = bench.FirstFault();
    ASSERT_GE(at, kStartMs);
    const double speed = bench.speeds()[static_cast<std::size_t>(at)];
    const double fastest = *std::max_element(bench.speeds().begin() + at, bench.speeds().end());
    PrintFigures("joint " + std::to_string(joint + 1) +
                     " without torque: " + hal::Name(bench.last().record.fault) + " latched " +
                     std::to_string(at - kStartMs) + " ticks later at " + std::to_string(speed) +
                     " rad/s, fastest " + std::to_string(fastest) + " rad/s, at rest " +
                     std::to_string(bench.AtRest() - at) + " ticks after the fault",
                 bench);
    EXPECT_LT(bench.AtRest() - kStartMs, joint == 1 ? 250 : 50) << "from the failure to rest";
    EXPECT_LT(fastest, speed + 2.4) << "the gain until the torque has faded and the brakes close";
    EXPECT_EQ(bench.speeds().back(), 0.0);
  }
}

// The encoder of a joint hangs while the joint moves or is about to. Undetected, the joint would run through
// its whole range within a second.
TEST(GuardFault, StuckEncoderFaultsBeforeTheJointRunsAway) {
  const Eigen::VectorXd q_start = GuardSetup().world.q_start;
  for (const double start_s : {0.05, 0.3, kStart, 0.8}) {
    for (const int joint : {0, 1, 3}) {
      GuardSetup setup;
      Eigen::VectorXd goal = q_start;
      goal[joint] += 0.6;
      setup.motion = GoTo(0.1, goal);
      setup.arm_faults.stuck = {{start_s, start_s + 1.0}, joint};
      GuardBench bench(setup);
      bench.RunUntil(3.0);
      const int at = bench.FirstFault();
      PrintFigures("joint " + std::to_string(joint + 1) + " hangs from " + std::to_string(start_s) +
                       " s: " + hal::Name(bench.last().record.fault) + " at " + std::to_string(at) + " ms",
                   bench);
      if (start_s < 0.1) {  // later, the joint stops as if it had hit something: `contact`
        ASSERT_GE(at, 0);
        const auto& found = bench.ticks()[static_cast<std::size_t>(at)].record;
        EXPECT_EQ(found.fault, Fault::kArmStale);
        EXPECT_EQ(found.fault_joint, joint);
        EXPECT_TRUE(bench.last().record.command.engage_brakes);
        EXPECT_EQ(bench.speeds().back(), 0.0);
      }
      EXPECT_LE(bench.figures().position, 1.0);
      EXPECT_LE(bench.figures().velocity, 1.0);
    }
  }
}

// The encoder hangs for 20 ms while the joint is fast. If the servo believed it, the law would push the joint
// past its speed limit.
TEST(GuardFault, BrieflyStuckEncoderStopsTheArmAsStale) {
  GuardSetup setup;
  setup.servo.safety.encoder_quantum = 2e-5;  // the resolution of these encoders
  Eigen::VectorXd goal = setup.world.q_start;
  goal[3] -= 0.1;
  setup.motion = GoTo(0.1, goal);
  setup.arm_faults.stuck = {{0.2, 0.22}, 3};
  GuardBench bench(setup);
  ExpectStop(bench, Fault::kArmStale, 200, setup.servo.safety.non_finite_ticks, 2);
}

// An encoder hangs while a push too weak to be noticed moves its joint. When it works again, the position
// jumps faster than any joint moves. Correcting that error would throw the light joints past their limits.
TEST(GuardFault, EncoderJumpKeepsJointsWithinTheirSpeedLimits) {
  GuardSetup setup;
  setup.servo.safety.frozen_ticks = 0;  // otherwise the missing noise reveals it at once
  setup.arm_faults.stuck = {{0.3, 0.6}, 3};
  setup.world.push.tau = 0.5 * Eigen::VectorXd::Unit(7, 3);
  setup.world.push.window = {0.3, 0.6};
  GuardBench bench(setup);
  ExpectStop(bench, Fault::kJointVelocity, 600, 0, 0, PushedBy::kWorld);
  EXPECT_LE(bench.figures().velocity, 1.0);
}

// The arm falls in Boot because a motor is weak. The servo holds the arm from the first state on, notices the
// external torque, and stops the arm long before it is too fast.
TEST(GuardFault, ArmFallingInBootIsStoppedWithinItsLimits) {
  for (const double lost : {0.5, 1.0}) {
    GuardSetup setup;
    setup.world.q_start << 1.0, 0.2, -0.6, -2.2, 0.4, 2.0, -0.6;
    setup.world.torque_loss = {{0.01, 1.0}, 1, lost};
    GuardBench bench(setup);
    bench.RunUntil(1.5);
    PrintFigures("joint 2 loses " + std::to_string(lost) +
                     " of its torque: " + hal::Name(bench.last().record.fault) + " after " +
                     std::to_string(bench.FirstFault()) + " ticks",
                 bench);
    EXPECT_EQ(bench.last().record.fault, Fault::kContact);
    ExpectInsideLimits(bench);
    EXPECT_EQ(bench.speeds().back(), 0.0);
    EXPECT_TRUE(bench.last().record.command.engage_brakes);
  }
}

}  // namespace fovea::test
