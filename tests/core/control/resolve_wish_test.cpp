// SPDX-License-Identifier: Apache-2.0
// Null-space wishes and the singularity measure against finite differences, and the limit based on it.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <iostream>

#include "firmware/core/barriers/singularity.hpp"
#include "firmware/core/control/null_space_wish.hpp"
#include "firmware/core/control/resolve_constrained.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::control {
namespace {

constexpr double kLength = 0.3;

model::Mat6N JacobianAt(const config::ServoConfig& config, const model::VecN& q) {
  model::ArmPoses poses;
  model::Mat6N J;
  model::ComputePoses(config.arm, q, poses);
  model::ComputeJacobian(config.arm, poses, config.X_EC, J);
  return J;
}

Eigen::MatrixXd ScaledAt(const config::ServoConfig& config, const model::VecN& q) {
  Eigen::MatrixXd J = JacobianAt(config, q);
  J.topRows(3) /= kLength;
  return J;
}

double LogManipulability(const config::ServoConfig& config, const model::VecN& q, double soft) {
  const Eigen::MatrixXd J = ScaledAt(config, q);
  return 0.5 * std::log((J * J.transpose() + soft * soft * Eigen::MatrixXd::Identity(6, 6)).determinant());
}

// Derivative of `f` along joint `i` at `q`, by differences of fourth order.
template <typename F>
double Difference(const F& f, const model::VecN& q, int i) {
  constexpr double kStep = 1e-3;
  const auto at = [&](double steps) {
    model::VecN moved = q;
    moved[i] += steps * kStep;
    return f(moved);
  };
  return (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * kStep);
}

TEST(ColumnChangeTest, MatchesFiniteDifferencesOfTheJacobian) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(521);
  double worst = 0.0;
  for (int state = 0; state < test::Repetitions(500); ++state) {
    const model::VecN q = random.Position(config.arm);
    const model::Mat6N J = JacobianAt(config, q);
    for (int k = 0; k < 7; ++k) {
      for (int j = 0; j < 7; ++j) {
        const model::Vec6 change = model::ColumnChange(J, j, k);
        for (int row = 0; row < 6; ++row) {
          const double expected =
              Difference([&](const model::VecN& at) { return JacobianAt(config, at)(row, j); }, q, k);
          worst = std::max(worst, std::abs(expected - change[row]));
        }
      }
    }
  }
  std::cout << "differs from finite differences by " << worst << "\n";
  EXPECT_LT(worst, 1e-10);
}

TEST(ManipulabilityGradientTest, AgreesWithFiniteDifferences) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(522);
  double worst = 0.0;
  for (int state = 0; state < test::Repetitions(2000); ++state) {
    const model::VecN q = random.Position(config.arm);
    const model::VecN gradient = ManipulabilityGradient(JacobianAt(config, q), kLength, 0.05);
    for (int k = 0; k < 7; ++k) {
      const double expected =
          Difference([&](const model::VecN& at) { return LogManipulability(config, at, 0.05); }, q, k);
      worst = std::max(worst, std::abs(expected - gradient[k]) / (1.0 + std::abs(expected)));
    }
  }
  std::cout << "differs from finite differences by " << worst << " relative\n";
  EXPECT_LT(worst, 1e-5);
}

TEST(ManipulabilityGradientTest, StaysBoundedWhereTheArmIsSingular) {
  const config::ServoConfig config = test::PandaConfig();
  double largest = 0.0;
  for (int k = 0; k <= 200; ++k) {
    model::VecN q(7);
    q << 0.3, 0.0, 0.0, -0.5 + 0.005 * k, 0.0, 0.8, 0.1;
    largest = std::max(largest, ManipulabilityGradient(JacobianAt(config, q), kLength, 0.05).norm());
  }
  std::cout << "largest |dm/dq| on the way through " << largest << " 1/rad\n";
  EXPECT_LT(largest, 40.0);
}

TEST(JointLimitWishTest, PushesSmoothlyInwardOnlyNearTheEnds) {
  const model::ArmModel& arm = test::PandaConfig().arm;
  constexpr double kOnset = 0.8;
  for (int i = 0; i < 7; ++i) {
    const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    const double half = 0.5 * (joint.q_max - joint.q_min);
    const double middle = 0.5 * (joint.q_max + joint.q_min);
    double before = 0.0;
    for (int k = -1100; k <= 1100; ++k) {
      const double at = 0.001 * k;
      model::VecN q = test::Ready();
      q[i] = middle + at * half;
      const double wish = JointLimitWish(arm, q, kOnset)[i];
      EXPECT_LE(wish * at, 0.0);
      EXPECT_LE(std::abs(wish), (1.0 - kOnset) * half + 1e-12);
      if (std::abs(std::abs(at) - kOnset) > 1e-9) {
        EXPECT_EQ(wish == 0.0, std::abs(at) < kOnset);
      }
      if (k > -1100) {
        EXPECT_LE(std::abs(wish - before), 0.002 * half + 1e-12) << "slope at most 2";
      }
      before = wish;
    }
  }
}

TEST(NullSpaceWishTest, EqualsTheWeightedSumUpToTheSpeedLimit) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(523);
  NullSpaceConfig wishes;
  wishes.q_posture = config.arm.q_ready;
  for (int state = 0; state < 100; ++state) {
    const model::VecN q = random.Position(config.arm);
    const model::Mat6N J = JacobianAt(config, q);
    const model::VecN sum =
        wishes.posture_gain * (test::Ready() - q) +
        wishes.joint_limit_gain * JointLimitWish(config.arm, q, wishes.joint_limit_onset) +
        wishes.manipulability_gain * ManipulabilityGradient(J, wishes.length, wishes.manipulability_soft);
    const model::VecN wish = NullSpaceWish(wishes, config.arm, q, J);
    EXPECT_LT(wish.norm(), wishes.speed_max);
    EXPECT_NEAR(wish.dot(sum), wish.norm() * sum.norm(), 1e-12) << "the same direction";
    NullSpaceConfig fast = wishes;
    fast.speed_max = 1e9;
    EXPECT_LT((NullSpaceWish(fast, config.arm, q, J) - sum).norm(), 1e-12);
  }
  const model::VecN q = random.Position(config.arm);
  wishes.posture_gain = wishes.joint_limit_gain = wishes.manipulability_gain = 0.0;
  EXPECT_EQ(NullSpaceWish(wishes, config.arm, q, JacobianAt(config, q)).norm(), 0.0);
}

TEST(SingularityTest, AgreesWithEigenAndFiniteDifferences) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(524);
  double worst_sigma = 0.0;
  double worst_gradient = 0.0;
  int tried = 0;
  const auto sigmas = [&](const model::VecN& q) {
    return Eigen::VectorXd(Eigen::JacobiSVD<Eigen::MatrixXd>(ScaledAt(config, q)).singularValues());
  };
  for (int state = 0; state < test::Repetitions(1000); ++state) {
    const model::VecN q = random.Position(config.arm);
    barriers::Singularity singularity;
    barriers::ComputeSingularity(JacobianAt(config, q), kLength, singularity);
    const Eigen::VectorXd expected = sigmas(q);
    worst_sigma = std::max(worst_sigma, std::abs(expected[5] - singularity.sigma));
    if (expected[4] - expected[5] < 0.02 || expected[5] < 0.01) {
      continue;  // too near a kink for differences
    }
    ++tried;
    for (int k = 0; k < 7; ++k) {
      const double slope = Difference([&](const model::VecN& at) { return sigmas(at)[5]; }, q, k);
      worst_gradient = std::max(worst_gradient, std::abs(slope - singularity.gradient[k]));
    }
  }
  std::cout << "sigma differs by " << worst_sigma << ", its gradient by " << worst_gradient << " in " << tried
            << " postures\n";
  EXPECT_GT(tried, test::Repetitions(1000) / 2);
  EXPECT_LT(worst_sigma, 1e-14);
  EXPECT_LT(worst_gradient, 1e-4);

  barriers::Singularity of_nothing;
  model::Mat6N zero = model::Mat6N::Zero(6, 7);
  barriers::ComputeSingularity(zero, kLength, of_nothing);
  EXPECT_EQ(of_nothing.sigma, 0.0);
  EXPECT_EQ(of_nothing.gradient.norm(), 0.0);
}

// Moves the hand in a random direction for 2 s, limited only by speed ranges and the singularity row.
TEST(SingularityTest, RowKeepsTheSmallestSingularValueAboveItsLimit) {
  const config::ServoConfig config = test::PandaConfig();
  const barriers::SingularityConfig limit;
  test::RandomStates random(525);
  double deepest = 1.0;
  double deepest_without = 1.0;
  for (int walk = 0; walk < test::Repetitions(20); ++walk) {
    model::Vec6 v;
    v << random.Vector(0.4), random.Vector(0.8);
    const model::VecN start = test::Ready() + random.Joints(config.arm, 0.3);
    for (const bool limited : {true, false}) {
      model::VecN q = start;
      for (int tick = 0; tick < 2000; ++tick) {
        const model::Mat6N J = JacobianAt(config, q);
        MotionTask task;
        task.J = J;
        task.v = v;
        task.dq_0 = model::VecN::Zero(7);
        task.weight = model::VecN::Ones(7);
        barriers::MotionLimits limits;
        limits.dq_min = model::VecN::Constant(7, -2.0);
        limits.dq_max = model::VecN::Constant(7, 2.0);
        barriers::Singularity singularity;
        barriers::ComputeSingularity(J, limit.length, singularity);
        double& depth = limited ? deepest : deepest_without;
        depth = std::min(depth, singularity.sigma);
        if (limited) {
          limits.Add(barriers::SingularityBarrier(limit, singularity));
        }
        ConstrainedMotion motion;
        ResolveConstrained(ConstrainedConfig{}, task, limits, motion);
        q += 1e-3 * motion.limited.dq;
      }
    }
  }
  std::cout << "limit " << limit.sigma_min << ", deepest with it " << deepest << ", without it "
            << deepest_without << "\n";
  EXPECT_LT(deepest_without, 0.5 * limit.sigma_min) << "the walks must lead into singular postures";
  EXPECT_GT(deepest, 0.9 * limit.sigma_min);
}

}  // namespace
}  // namespace fovea::control
