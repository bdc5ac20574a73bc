// SPDX-License-Identifier: Apache-2.0
// Encoders that hang, and encoders whose joint only rests.
#include "firmware/core/estimate/encoder_watch.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <iostream>
#include <random>

#include "firmware/core/estimate/contact.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::estimate {
namespace {

class EncoderWatchTest : public testing::Test {
 protected:
  EncoderWatchTest() {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, q_, poses);
    model::ComputeDynamics(config_.arm, poses, dq_, dynamics_);
  }
  // Ticks until a joint is reported to hang; -1: not within `most`.
  int TicksUntil(int most) {
    for (int tick = 1; tick <= most; ++tick) {
      joint_ = WatchEncoders(config_, {q_, dq_, dynamics_, residual_, reference_, drives_}, watch_);
      if (joint_ >= 0) {
        return tick;
      }
    }
    return -1;
  }

  config::ServoConfig config_ = test::PandaConfig();
  model::VecN q_ = test::Ready();
  model::VecN dq_ = model::VecN::Zero(7);
  model::VecN residual_ = model::VecN::Zero(7);
  model::VecN reference_ = test::Ready();
  bool drives_ = true;
  model::ArmDynamics dynamics_;
  EncoderWatch watch_;
  std::int32_t joint_ = -1;
};

TEST_F(EncoderWatchTest, RestingJointUnderLoadIsSound) {
  for (int tick = 0; tick < 600; ++tick) {  // an unknown load, picked up while the joint moves
    residual_[1] += 0.03 * (30.0 - residual_[1]);
    q_[1] += 1e-3;
    ASSERT_EQ(TicksUntil(1), -1);
  }
  EXPECT_EQ(TicksUntil(20'000), -1);
}

TEST_F(EncoderWatchTest, UnbalancedTorqueWithoutMotionIsDetected) {
  for (int joint = 0; joint < 7; ++joint) {
    watch_ = EncoderWatch{};
    residual_.setZero();
    ASSERT_EQ(TicksUntil(100), -1);
    residual_[joint] = -0.2 * config_.arm.joints[static_cast<std::size_t>(joint)].tau_max;
    const int ticks = TicksUntil(1000);
    std::cout << "joint " << joint + 1 << ": after " << ticks << " ticks\n";
    EXPECT_EQ(joint_, joint);
    EXPECT_GT(ticks, 0);
    EXPECT_LE(ticks, 20);
  }
}

// The observer reports a push with a time constant. The watch knows this constant, so it detects the fault as
// soon as if the push were seen at once.
TEST_F(EncoderWatchTest, ObserverDelayDoesNotDelayDetection) {
  const double share = 1e-3 * config_.safety.contact_gain;
  for (int joint = 0; joint < 7; ++joint) {
    const double pushed = -0.2 * config_.arm.joints[static_cast<std::size_t>(joint)].tau_max;
    watch_ = EncoderWatch{};
    residual_.setZero();
    ASSERT_EQ(TicksUntil(100), -1);
    int ticks = 0;
    do {
      residual_[joint] += share * (pushed - residual_[joint]);
      ++ticks;
    } while (TicksUntil(1) < 0 && ticks < 1000);
    // Best possible: the time in which this torque moves a free joint by three quanta.
    const double M = 1.0 / dynamics_.M.inverse()(joint, joint);
    const double way = 3.0 * config_.safety.encoder_quantum;
    const double least = 1e3 * std::sqrt(2.0 * way * M / std::fabs(pushed));
    std::cout << "joint " << joint + 1 << ": after " << ticks << " ticks, " << least << " at best\n";
    EXPECT_EQ(joint_, joint);
    EXPECT_LE(ticks, std::max(1.3 * least, 8.0));
  }
}

// A load is released while the joint gives way to it: the joint goes on, reverses and comes back within one
// encoder step. A velocity that changes shows that the encoder works; a hanging one stays the same.
TEST_F(EncoderWatchTest, JointReversingWithinOneEncoderStepIsSound) {
  for (const bool lives : {true, false}) {
    watch_ = EncoderWatch{};
    residual_.setZero();
    dq_.setZero();
    dq_[1] = 0.012;
    ASSERT_EQ(TicksUntil(1), -1);
    const double ddq = 5.0;
    const double M = 1.0 / dynamics_.M.inverse()(1, 1);
    int tick = 0;
    for (; tick < 30; ++tick) {
      residual_[1] -= 1e-3 * config_.safety.contact_gain * (M * ddq + residual_[1]);
      dq_[1] -= lives ? 1e-3 * ddq : 0.0;
      q_[1] = test::Ready()[1] + 1e-4 * std::round(1e4 * (0.012 * 0.012 - dq_[1] * dq_[1]) / (2.0 * ddq));
      if (TicksUntil(1) >= 0) {
        break;
      }
    }
    std::cout << (lives ? "works" : "hangs") << ": " << tick << " ticks\n";
    EXPECT_EQ(tick < 30, !lives);
  }
}

TEST_F(EncoderWatchTest, TorqueWithinStictionIsSound) {
  ASSERT_EQ(TicksUntil(100), -1);
  residual_[0] = 0.9 * (config_.safety.stiction_fraction * config_.arm.joints[0].coulomb +
                        0.01 * config_.arm.joints[0].tau_max);
  EXPECT_EQ(TicksUntil(10'000), -1);
}

TEST_F(EncoderWatchTest, VelocityWithoutMotionIsDetectedWithoutTheObserver) {
  drives_ = false;
  dq_[3] = 0.4;
  const int ticks = TicksUntil(1000);
  std::cout << "after " << ticks << " ticks\n";
  EXPECT_EQ(joint_, 3);
  EXPECT_LE(ticks, 10);
}

// A light joint needs so little torque that the observer sees nothing, but its reference moves on.
TEST_F(EncoderWatchTest, AdvancingReferenceWithoutMotionIsDetected) {
  for (int joint = 0; joint < 7; ++joint) {
    watch_ = EncoderWatch{};
    reference_ = test::Ready();
    ASSERT_EQ(TicksUntil(100), -1);
    double gone = 0.0;
    do {
      gone += 3e-4;
      reference_[joint] += 3e-4;
    } while (TicksUntil(1) < 0 && gone < 1.0);
    std::cout << "joint " << joint + 1 << ": after " << gone << " rad\n";
    EXPECT_EQ(joint_, joint);
    EXPECT_LT(gone, 0.08);
  }
}

// The noise of a resting joint ceases: nothing pushed it, and yet its encoder hangs. An encoder that never
// had noise may stay constant for ever, and so may one that only moved.
TEST_F(EncoderWatchTest, CeasedEncoderNoiseIsDetected) {
  test::RandomStates random(7);
  for (int tick = 0; tick < 5000; ++tick) {
    q_[2] += random.Uniform(-1e-6, 1e-6);
    dq_[2] = random.Uniform(-1e-4, 1e-4);
    q_[4] += 1e-6;
    dq_[4] = 0.01 * std::sin(1e-2 * tick);
    ASSERT_EQ(TicksUntil(1), -1) << tick;
  }
  dq_[4] = 0.0;
  EXPECT_EQ(TicksUntil(1000), config_.safety.frozen_ticks);
  EXPECT_EQ(joint_, 2);
  config_.safety.frozen_ticks = 0;
  dq_[2] = 0.0;
  EXPECT_EQ(TicksUntil(10'000), -1);
}

// The watch knows the noise at rest a fifth of a second after the start, before anything moves the arm.
TEST_F(EncoderWatchTest, NoiseIsLearnedWithinAFifthOfASecond) {
  test::RandomStates random(11);
  for (int tick = 0; tick < 200; ++tick) {
    for (int joint = 0; joint < 7; ++joint) {
      q_[joint] += random.Uniform(-1e-6, 1e-6);
      dq_[joint] = random.Uniform(-1e-4, 1e-4);
    }
    ASSERT_EQ(TicksUntil(1), -1) << tick;
  }
  for (const EncoderWatch::Joint& joint : watch_.joints) {
    EXPECT_TRUE(joint.is_noisy || &joint - watch_.joints.data() >= 7);
  }
  EXPECT_EQ(TicksUntil(1000), config_.safety.frozen_ticks);
}

// An encoder with coarse steps, whose velocity is their difference, flickers while its joint moves and jumps
// by a step now and then at rest. Then it stays constant for ever: it has no noise that could cease.
TEST_F(EncoderWatchTest, FlickeringStepsAreNotTakenForNoise) {
  const double quantum = config_.safety.encoder_quantum;
  test::RandomStates random(12);
  double true_q = q_[3];
  double before = q_[3];
  for (int tick = 0; tick < 20'000; ++tick) {
    const bool moves = tick / 2000 % 2 == 0;
    true_q += moves ? 0.37 * quantum : 0.0;
    q_[3] = quantum * std::round((true_q + 0.4 * quantum * random.Uniform(-1.0, 1.0)) / quantum);
    dq_[3] = (q_[3] - before) / 1e-3;
    before = q_[3];
    residual_[3] = reference_[3] = 0.0;
    reference_[3] = q_[3];
    ASSERT_EQ(TicksUntil(1), -1) << tick;
    ASSERT_FALSE(watch_.joints[3].is_noisy) << tick;
  }
  dq_[3] = 0.0;
  EXPECT_EQ(TicksUntil(10'000), -1);
}

// A resting joint's velocity has noise. The contact observer sees it, too: from tick to tick the momentum
// changes by M times the noise's change.
class NoisyVelocityTest : public EncoderWatchTest {
 protected:
  // The readings of one tick at rest, `sigma` [rad/s].
  void Rest(double sigma) {
    for (int i = 0; i < 7; ++i) {
      dq_[i] = sigma * noise_(random_);
    }
    ObserveContact(config_.safety.contact_gain, dynamics_, dq_, model::VecN::Zero(7), contact_);
    residual_ = contact_.residual;
  }

  ContactState contact_ = [] {
    ContactState contact;
    contact.Reset(7, false);
    return contact;
  }();
  std::mt19937_64 random_{5};
  std::normal_distribution<double> noise_;
};

TEST_F(NoisyVelocityTest, VelocityNoiseAtRestIsSound) {
  for (const double sigma : {5e-4, 1e-3, 2e-3, 5e-3}) {
    watch_ = EncoderWatch{};
    contact_.Reset(7, false);
    int tick = 0;
    for (; tick < 60'000; ++tick) {
      Rest(sigma);
      if (TicksUntil(1) >= 0) {
        break;
      }
    }
    std::cout << sigma << " rad/s: " << 1e-3 * tick << " s without an alarm\n";
    EXPECT_EQ(tick, 60'000) << "joint " << joint_ + 1;
  }
}

// An encoder that hangs after such noise is detected nearly as soon as without.
TEST_F(NoisyVelocityTest, HangAfterVelocityNoiseIsDetected) {
  for (const double sigma : {0.0, 5e-4, 2e-3, 5e-3}) {
    for (int joint = 0; joint < 7; ++joint) {
      config_.safety.frozen_ticks = 0;  // the sign that needs no motion is not tested here
      watch_ = EncoderWatch{};
      contact_.Reset(7, false);
      for (int tick = 0; tick < 1000; ++tick) {
        Rest(sigma);
        ASSERT_EQ(TicksUntil(1), -1);
      }
      const double unbalanced = -0.2 * config_.arm.joints[static_cast<std::size_t>(joint)].tau_max;
      int ticks = 0;
      do {
        residual_[joint] += 1e-3 * config_.safety.contact_gain * (unbalanced - residual_[joint]);
        ++ticks;
      } while (TicksUntil(1) < 0 && ticks < 1000);
      std::cout << sigma << " rad/s, joint " << joint + 1 << ": after " << ticks << " ticks\n";
      EXPECT_EQ(joint_, joint);
      EXPECT_LE(ticks, 60);
    }
  }
}

// A reading that changes by one encoder step now and then is sound.
TEST_F(EncoderWatchTest, ReadingChangingByOneStepIsSound) {
  for (int step = 0; step < 50; ++step) {
    residual_[1] = step % 2 == 0 ? 1.5 : -1.5;
    q_[1] += 1.01 * config_.safety.encoder_quantum;
    ASSERT_EQ(TicksUntil(config_.safety.non_finite_ticks), -1) << step;
  }
}

}  // namespace
}  // namespace fovea::estimate
