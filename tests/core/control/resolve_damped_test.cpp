// SPDX-License-Identifier: Apache-2.0
// The damped resolution against Eigen's SVD, and its behaviour on paths through singular postures.
#include "firmware/core/control/resolve_damped.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <iostream>

#include "firmware/core/barriers/motion_limits.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::control {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// m x n, of random scale; `deficient`: with rank below m.
MotionTask RandomTask(test::RandomStates& random, int m, int n, bool deficient) {
  MotionTask task;
  task.J.resize(m, n);
  task.v.resize(m);
  task.dq_0.resize(n);
  task.weight.resize(n);
  const double scale = std::pow(10.0, random.Uniform(-2.0, 2.0));
  for (int i = 0; i < m; ++i) {
    for (int k = 0; k < n; ++k) {
      task.J(i, k) = scale * random.Uniform(-1.0, 1.0);
    }
    task.v[i] = scale * random.Uniform(-1.0, 1.0);
  }
  if (deficient && m > 1) {
    task.J.row(m - 1) = task.J.row(0) * random.Uniform(-2.0, 2.0);
  }
  for (int k = 0; k < n; ++k) {
    task.dq_0[k] = random.Uniform(-1.0, 1.0);
    task.weight[k] = random.Uniform(0.2, 5.0);
  }
  return task;
}

MatrixXd Weighted(const MotionTask& task) {
  return MatrixXd(task.J) * VectorXd(task.weight).cwiseSqrt().cwiseInverse().asDiagonal();
}

// The task to move the Panda's hand with `v` at `q`.
MotionTask HandTask(const model::ArmModel& arm, const model::VecN& q, const model::Vec6& v) {
  model::ArmPoses poses;
  model::Mat6N J;
  model::ComputePoses(arm, q, poses);
  model::ComputeJacobian(arm, poses, model::Pose(), J);
  MotionTask task;
  task.J = J;
  task.v = v;
  task.dq_0 = model::VecN::Zero(7);
  task.weight = model::VecN::Ones(7);
  return task;
}

TEST(RowSvdTest, AgreesWithEigen) {
  test::RandomStates random(501);
  double worst = 0.0;
  double worst_product = 0.0;
  int most_sweeps = 0;
  for (int k = 0; k < test::Repetitions(20000); ++k) {
    const int m = 1 + k % 8;
    const int n = 1 + k / 8 % 8;
    const barriers::TaskJacobian J = RandomTask(random, m, n, k % 3 == 0).J;
    barriers::RowSvd svd;
    barriers::ComputeRowSvd(J, svd);
    const Eigen::JacobiSVD<MatrixXd> oracle{MatrixXd(J)};
    const double size = oracle.singularValues()[0];
    for (int i = 0; i < std::min(m, n); ++i) {
      worst = std::max(worst,
                       std::abs(oracle.singularValues()[i] - svd.sigma[static_cast<std::size_t>(i)]) / size);
    }
    EXPECT_EQ(svd.Smallest(), svd.sigma[static_cast<std::size_t>(std::min(m, n) - 1)]);
    MatrixXd product = MatrixXd::Zero(m, n);
    for (std::size_t i = 0; i < static_cast<std::size_t>(m); ++i) {
      product +=
          Eigen::Map<VectorXd>(svd.u[i].data(), m) * Eigen::Map<VectorXd>(svd.r[i].data(), n).transpose();
    }
    worst_product = std::max(worst_product, (product - J).norm() / size);
    most_sweeps = std::max(most_sweeps, svd.sweeps);
  }
  std::cout << "singular values differ by " << worst << ", U R from J by " << worst_product
            << " (relative); at most " << most_sweeps << " sweeps\n";
  EXPECT_LT(worst, 1e-14);
  EXPECT_LT(worst_product, 1e-14);
  EXPECT_LT(most_sweeps, barriers::RowSvd::kMaxSweeps);
}

TEST(ResolveDampedTest, EqualsTheWeightedPseudoInverseAwayFromSingularity) {
  test::RandomStates random(502);
  const DampingConfig config;
  double worst = 0.0;
  double worst_residual = 0.0;
  double worst_null_space = 0.0;
  int tried = 0;
  for (int k = 0; k < test::Repetitions(10000); ++k) {
    MotionTask task = RandomTask(random, 1 + k % 6, 7, false);
    DampedMotion motion;
    ResolveDamped(config, task, motion);
    ASSERT_TRUE(motion.finite);
    if (motion.sigma_min < motion.threshold) {
      continue;
    }
    ++tried;
    const MatrixXd J = task.J;
    const VectorXd root = VectorXd(task.weight).cwiseSqrt();
    const MatrixXd pinv =
        root.cwiseInverse().asDiagonal() * Weighted(task).completeOrthogonalDecomposition().pseudoInverse();
    const VectorXd expected = pinv * (task.v - J * task.dq_0) + task.dq_0;
    worst = std::max(worst, (expected - motion.dq).norm() / expected.norm());
    worst_residual = std::max(worst_residual, (J * motion.dq - task.v).norm() / task.v.norm());
    // The null-space wish must not change the task's motion.
    DampedMotion without;
    task.dq_0.setZero();
    ResolveDamped(config, task, without);
    worst_null_space = std::max(worst_null_space, (J * (motion.dq - without.dq)).norm() / J.norm());
  }
  std::cout << tried << " cases: differs from the pseudo-inverse by " << worst << ", task missed by "
            << worst_residual << ", changed by the null-space wish by " << worst_null_space
            << " (relative)\n";
  EXPECT_GT(tried, test::Repetitions(10000) / 2);
  EXPECT_LT(worst, 1e-11);
  EXPECT_LT(worst_residual, 1e-11);
  EXPECT_LT(worst_null_space, 1e-13);
}

TEST(ResolveDampedTest, DampingMatchesItsFormulaAndBoundsMotionForAnyRank) {
  test::RandomStates random(503);
  DampingConfig config;
  config.threshold = 0.5;  // damping acts often
  double worst = 0.0;
  double largest = 0.0;
  double largest_leak = 0.0;
  for (int k = 0; k < test::Repetitions(10000); ++k) {
    const int m = 1 + k % 8;
    MotionTask task = RandomTask(random, m, 7, k % 2 == 0);
    if (k % 50 == 0) {
      task.J.setZero();
    }
    DampedMotion motion;
    ResolveDamped(config, task, motion);
    ASSERT_TRUE(motion.finite);
    const MatrixXd Jw = Weighted(task);
    const VectorXd root = VectorXd(task.weight).cwiseSqrt();
    const Eigen::JacobiSVD<MatrixXd> svd(Jw, Eigen::ComputeThinU | Eigen::ComputeThinV);
    VectorXd x = root.cwiseProduct(VectorXd(task.dq_0));
    const VectorXd rest = task.v - task.J * task.dq_0;
    const double threshold = std::sqrt(0.25 * Jw.squaredNorm() / m + 1e-12);
    EXPECT_NEAR(motion.threshold, threshold, 1e-12 * threshold);
    for (int i = 0; i < svd.singularValues().size(); ++i) {
      const double sigma = svd.singularValues()[i];
      const double t = std::min(sigma / threshold, 1.0);
      const double damping = 0.5 * threshold * (1.0 - t * t);
      x += svd.matrixV().col(i) * (sigma / (sigma * sigma + damping * damping)) *
           svd.matrixU().col(i).dot(rest);
    }
    worst = std::max(worst, (root.cwiseProduct(VectorXd(motion.dq)) - x).norm() / x.norm());

    MotionTask part = task;
    part.dq_0.setZero();
    DampedMotion primary;
    ResolveDamped(config, part, primary);
    largest =
        std::max(largest, root.cwiseProduct(VectorXd(primary.dq)).norm() * motion.threshold / task.v.norm());
    part = task;
    part.v.setZero();
    DampedMotion secondary;
    ResolveDamped(config, part, secondary);
    largest_leak = std::max(largest_leak, (task.J * secondary.dq).norm() / motion.threshold /
                                              root.cwiseProduct(VectorXd(task.dq_0)).norm());
  }
  std::cout << "differs from the formula by " << worst << "; largest |dq|_W threshold / |v| " << largest
            << ", largest disturbance by the null-space wish " << largest_leak << " threshold |dq_0|_W\n";
  EXPECT_LT(worst, 1e-10);
  EXPECT_LE(largest, 1.3);
  EXPECT_LE(largest_leak, 0.22);
}

// Straight through the stretched elbow, which is just past the joint's range, and past the aligned wrist.
TEST(ResolveDampedTest, IsSmoothThroughSingularPosturesOfThePanda) {
  const model::ArmModel& arm = test::PandaConfig().arm;
  test::RandomStates random(504);
  double largest = 0.0;
  double deepest = 1.0;
  double steps[2] = {0.0, 0.0};
  for (int way = 0; way < 40; ++way) {
    model::VecN from(7);
    from << random.Uniform(-1, 1), random.Uniform(-0.6, -0.2), 0.0, -0.5, 0.0, random.Uniform(0.5, 1.5), 0.7;
    model::VecN to = from;
    to[1] = -from[1];
    to[3] = 0.5;
    model::Vec6 v;
    v << random.Vector(0.3), random.Vector(0.5);
    for (int fine = 0; fine < 2; ++fine) {
      const int count = fine == 0 ? 1000 : 2000;
      model::VecN before;
      for (int k = 0; k <= count; ++k) {
        const double share = static_cast<double>(k) / count;
        const MotionTask task = HandTask(arm, (1.0 - share) * from + share * to, v);
        DampedMotion motion;
        ResolveDamped(DampingConfig{}, task, motion);
        ASSERT_TRUE(motion.finite);
        if (k > 0) {
          steps[fine] = std::max(steps[fine], (motion.dq - before).norm());
        }
        before = motion.dq;
        deepest = std::min(deepest, motion.sigma_min);
        largest = std::max(largest, motion.dq.norm() * motion.threshold / v.norm());
      }
    }
  }
  std::cout << "down to sigma " << deepest << "; largest |dq| threshold / |v| " << largest
            << ", largest step of dq " << steps[0] << " rad/s per 1/1000 of the way, " << steps[1]
            << " per 1/2000\n";
  EXPECT_LT(deepest, 1e-3) << "the paths must lead through singular postures";
  EXPECT_LE(largest, 1.3);
  EXPECT_LT(steps[1], 0.6 * steps[0]) << "half the step, half the change: continuous";
}

// From all directions exact to one, two or three of them damped: the switch from one solver to the other
// causes no step.
TEST(ResolveDampedTest, IsContinuousWhereDampingBegins) {
  test::RandomStates random(507);
  double largest_step = 0.0;
  double worst = -HUGE_VAL;
  int switched = 0;
  for (int k = 0; k < test::Repetitions(3000); ++k) {
    const int m = 3 + k % 4;
    MotionTask task = RandomTask(random, m, 7, false);
    const Eigen::JacobiSVD<MatrixXd> svd(Weighted(task), Eigen::ComputeFullU | Eigen::ComputeFullV);
    VectorXd sigma = VectorXd::Ones(m);
    // All but the last few are 1, so that the threshold is nearly 0.05 whatever the last are.
    const auto set = [&](double last) {
      sigma.tail(1 + k % 3).setConstant(last);
      const MatrixXd Jw = svd.matrixU() * sigma.asDiagonal() * svd.matrixV().leftCols(m).transpose();
      task.J = Jw * VectorXd(task.weight).cwiseSqrt().asDiagonal();
    };
    DampedMotion above;
    DampedMotion below;
    const double threshold = [&] {
      double at = 0.05;
      for (int i = 0; i < 60; ++i) {  // fixed point: the threshold equals the last singular value
        set(at);
        ResolveDamped(DampingConfig{}, task, above);
        at = above.threshold;
      }
      return at;
    }();
    const double by = std::pow(10.0, random.Uniform(-12.0, -6.0));
    set(threshold * (1.0 + by));
    ResolveDamped(DampingConfig{}, task, above);
    set(threshold * (1.0 - by));
    ResolveDamped(DampingConfig{}, task, below);
    switched += above.sigma_min >= above.threshold && below.sigma_min < below.threshold ? 1 : 0;
    const double step = (above.dq - below.dq).norm() / above.dq.norm();
    largest_step = std::max(largest_step, step);
    worst = std::max(worst, step - 3.0 * by);
  }
  std::cout << switched << " steps over the threshold, by 1e-12 to 1e-6 of it: dq changes by " << largest_step
            << " at most, by " << worst << " more than three times the step\n";
  EXPECT_GT(switched, test::Repetitions(3000) / 2);
  EXPECT_LT(worst, 1e-11);
}

TEST(ResolveDampedTest, SolvesSeveralWishesAccuratelyForSmallThresholds) {
  test::RandomStates random(508);
  for (const double threshold : {1e-1, 1e-3, 1e-5}) {
    DampingConfig config;
    config.threshold = threshold;
    double worst = 0.0;
    for (int k = 0; k < test::Repetitions(3000); ++k) {
      const int m = 2 + k % 5;
      MotionTask task = RandomTask(random, m, 7, false);
      task.J.row(m - 1) = task.J.row(0) + threshold * random.Uniform(0.0, 1.0) * task.J.row(m - 1);
      const DampedInverse inverse(config, task);
      DampedMotion motion;
      for (int wish = 0; wish < 2; ++wish) {
        inverse.Resolve(task, motion);
        DampedMotion alone;
        ResolveDamped(config, task, alone);
        EXPECT_EQ(motion.dq, alone.dq);
        task.dq_0 *= -2.0;
      }
      // The same from the accurate singular values of row_svd.hpp.
      task.dq_0.setZero();
      inverse.Resolve(task, motion);
      const MatrixXd Jw = Weighted(task);
      barriers::RowSvd svd;
      barriers::ComputeRowSvd(barriers::TaskJacobian(Jw), svd);
      VectorXd x = VectorXd::Zero(7);
      for (std::size_t i = 0; i < static_cast<std::size_t>(m); ++i) {
        const double sigma2 = svd.sigma[i] * svd.sigma[i];
        const double threshold2 = motion.threshold * motion.threshold;
        const double half = 0.5 * (1.0 + sigma2 / threshold2);
        const double damped2 = sigma2 < threshold2 ? threshold2 * half * half : sigma2;
        x += Eigen::Map<VectorXd>(svd.r[i].data(), 7) / damped2 *
             Eigen::Map<VectorXd>(svd.u[i].data(), m).dot(VectorXd(task.v));
      }
      const VectorXd dq = VectorXd(task.weight).cwiseSqrt().cwiseInverse().asDiagonal() * x;
      worst = std::max(worst, (dq - VectorXd(motion.dq)).norm() / dq.norm());
    }
    std::cout << "threshold " << threshold << ": differs from the SVD's solution by " << worst
              << " (relative)\n";
    EXPECT_LT(worst, std::max(1e-14 / threshold / threshold, 1e-11));
  }
}

TEST(ResolveDampedTest, ReportsANonFiniteResult) {
  test::RandomStates random(505);
  MotionTask task = RandomTask(random, 3, 7, false);
  task.J(1, 2) = std::nan("");
  DampedMotion motion;
  ResolveDamped(DampingConfig{}, task, motion);
  EXPECT_FALSE(motion.finite);
  EXPECT_EQ(motion.dq, model::VecN::Zero(7));
  task = RandomTask(random, 3, 7, false);
  task.v[0] = 1e300;
  task.J *= 1e200;
  ResolveDamped(DampingConfig{}, task, motion);
  EXPECT_TRUE(motion.dq.allFinite());
}

TEST(ScaleIntoRangeTest, KeepsTheDirectionAndEveryRange) {
  test::RandomStates random(506);
  double worst = 0.0;
  for (int k = 0; k < 2000; ++k) {
    barriers::MotionLimits limits;
    limits.dq_min = -model::VecN::Ones(7) * random.Uniform(0.1, 1.0);
    limits.dq_max = model::VecN::Ones(7) * random.Uniform(0.1, 1.0);
    model::VecN wish(7);
    for (int i = 0; i < 7; ++i) {
      wish[i] = random.Uniform(-2.0, 2.0);
    }
    model::VecN dq = wish;
    const double scale = barriers::ScaleIntoRange(limits, dq);
    worst = std::max(worst, (dq - scale * wish).norm());
    EXPECT_TRUE((dq.array() <= limits.dq_max.array()).all() && (dq.array() >= limits.dq_min.array()).all());
    EXPECT_TRUE(scale == 1.0 || (dq - limits.dq_max).cwiseAbs().minCoeff() < 1e-12 ||
                (dq - limits.dq_min).cwiseAbs().minCoeff() < 1e-12)
        << "scaled no more than needed";
    // A joint whose range excludes zero must move, whatever the wish.
    limits.dq_min[3] = 0.05;
    dq = wish;
    barriers::ScaleIntoRange(limits, dq);
    EXPECT_GE(dq[3], 0.05);
  }
  std::cout << "off the wish's direction by " << worst << " rad/s\n";
  EXPECT_LT(worst, 1e-12);
}

}  // namespace
}  // namespace fovea::control
