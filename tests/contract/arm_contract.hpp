// SPDX-License-Identifier: Apache-2.0
// Requirements for every arm driver, real or simulated. A test of a driver defines a fixture
//
//   struct MyArmFixture {
//     hal::Arm& arm();
//     void Advance();              // one period of the arm's own time passes
//   };
//   INSTANTIATE_TYPED_TEST_SUITE_P(My, ArmContract, MyArmFixture);
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fovea/hal/arm.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::test {

template <typename Fixture>
class ArmContract : public testing::Test {
 protected:
  Fixture fixture_;

  hal::ArmState Read() {
    hal::ArmState state;
    EXPECT_TRUE(fixture_.arm().Read(state).ok());
    return state;
  }
  hal::ArmCommand Command(double tau) {
    hal::ArmCommand command;
    command.num_joints = fixture_.arm().num_joints();
    command.tau_cmd[0] = tau;
    return command;
  }
};

TYPED_TEST_SUITE_P(ArmContract);

TYPED_TEST_P(ArmContract, StatesAreFiniteAndZeroPastTheLastJoint) {
  const hal::ArmState state = this->Read();
  const int n = this->fixture_.arm().num_joints();
  EXPECT_GE(n, 1);
  EXPECT_LE(n, hal::kMaxJoints);
  EXPECT_EQ(state.num_joints, n);
  for (int i = 0; i < hal::kMaxJoints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (const double value : {state.q[k], state.dq[k], state.tau_meas[k], state.tau_applied[k]}) {
      EXPECT_TRUE(std::isfinite(value));
      if (i >= n) {
        EXPECT_EQ(value, 0.0) << "entries past the last joint are zero";
      }
    }
  }
}

TYPED_TEST_P(ArmContract, StampsAndSequencesIncrease) {
  hal::ArmState before = this->Read();
  for (int i = 0; i < 10; ++i) {
    this->fixture_.Advance();
    const hal::ArmState now = this->Read();
    EXPECT_GT(now.stamp_ns, before.stamp_ns);
    EXPECT_GT(now.sequence, before.sequence);
    before = now;
  }
}

TYPED_TEST_P(ArmContract, CommandStaysInForceUntilTheNext) {
  ASSERT_TRUE(this->fixture_.arm().Write(this->Command(0.5)).ok());
  for (int i = 0; i < 3; ++i) {
    this->fixture_.Advance();
    EXPECT_EQ(this->Read().tau_applied[0], 0.5);
  }
  ASSERT_TRUE(this->fixture_.arm().Write(this->Command(-0.25)).ok());
  this->fixture_.Advance();
  EXPECT_EQ(this->Read().tau_applied[0], -0.25);
}

TYPED_TEST_P(ArmContract, RefusedCommandLeavesTheLastOneInForce) {
  ASSERT_TRUE(this->fixture_.arm().Write(this->Command(0.5)).ok());
  hal::ArmCommand wrong_size = this->Command(9.0);
  wrong_size.num_joints += 1;
  EXPECT_EQ(this->fixture_.arm().Write(wrong_size).code(), hal::StatusCode::kInvalidArgument);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(this->fixture_.arm().Write(this->Command(bad)).code(), hal::StatusCode::kNonFinite);
  }
  this->fixture_.Advance();
  EXPECT_EQ(this->Read().tau_applied[0], 0.5);
}

TYPED_TEST_P(ArmContract, StandsStillUnderZeroTorque) {
  // The arm itself compensates gravity and friction.
  ASSERT_TRUE(this->fixture_.arm().Write(this->Command(0.0)).ok());
  const hal::ArmState before = this->Read();
  for (int i = 0; i < 200; ++i) {
    this->fixture_.Advance();
  }
  const hal::ArmState after = this->Read();
  for (int i = 0; i < before.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_NEAR(after.q[k], before.q[k], 2e-3) << "joint " << i + 1;
  }
}

TYPED_TEST_P(ArmContract, PositiveTorqueMovesItsJointForward) {
  const double start = this->Read().q[0];
  ASSERT_TRUE(this->fixture_.arm().Write(this->Command(4.0)).ok());
  for (int i = 0; i < 100; ++i) {
    this->fixture_.Advance();
  }
  EXPECT_GT(this->Read().q[0], start + 1e-3);
  EXPECT_GT(this->Read().dq[0], 0.0);
}

TYPED_TEST_P(ArmContract, BrakesStopTheArm) {
  ASSERT_TRUE(this->fixture_.arm().Write(this->Command(4.0)).ok());
  for (int i = 0; i < 100; ++i) {
    this->fixture_.Advance();
  }
  hal::ArmCommand brake = this->Command(0.0);
  brake.engage_brakes = true;
  ASSERT_TRUE(this->fixture_.arm().Write(brake).ok());
  for (int i = 0; i < 300; ++i) {
    this->fixture_.Advance();
  }
  const double stopped = this->Read().q[0];
  for (int i = 0; i < 100; ++i) {
    this->fixture_.Advance();
  }
  EXPECT_NEAR(this->Read().q[0], stopped, 2e-4);
}

REGISTER_TYPED_TEST_SUITE_P(ArmContract, StatesAreFiniteAndZeroPastTheLastJoint, StampsAndSequencesIncrease,
                            CommandStaysInForceUntilTheNext, RefusedCommandLeavesTheLastOneInForce,
                            StandsStillUnderZeroTorque, PositiveTorqueMovesItsJointForward, BrakesStopTheArm);

}  // namespace fovea::test
