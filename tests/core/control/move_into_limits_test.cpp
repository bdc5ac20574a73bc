// SPDX-License-Identifier: Apache-2.0
// The nearest velocity within limits, against an exhaustive search and against the conditions of optimality.
#include "firmware/core/control/move_into_limits.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <bit>
#include <cmath>
#include <iostream>
#include <limits>
#include <vector>

#include "tests/core/control/limit_checks.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::control {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Problem {
  model::MatN H;
  model::VecN wish;
  barriers::MotionLimits limits;
};

// H with condition numbers up to some 1e7; ranges around 0; rows that standstill satisfies.
Problem RandomProblem(test::RandomStates& random, int n, int rows) {
  Problem p;
  const MatrixXd factor = MatrixXd::NullaryExpr(n, n, [&] { return random.Uniform(-1.0, 1.0); });
  MatrixXd spread = MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    spread(i, i) = std::pow(10.0, random.Uniform(-5.0, 0.0));
  }
  p.H = factor * spread * factor.transpose() + 1e-7 * MatrixXd::Identity(n, n);
  p.wish = RandomVector(random, n, 3.0);
  p.limits.dq_min = -RandomVector(random, n, 1.0).cwiseAbs();
  p.limits.dq_max = RandomVector(random, n, 1.0).cwiseAbs();
  for (int k = 0; k < rows; ++k) {
    p.limits.AddRow(RandomVector(random, n, 1.0), random.Uniform(0.0, 0.5));
  }
  return p;
}

double Cost(const Problem& p, const VectorXd& dq) {
  const VectorXd d = dq - VectorXd(p.wish);
  return d.dot(MatrixXd(p.H) * d);
}

// All limits as one system A dq <= b.
void Stack(const barriers::MotionLimits& limits, MatrixXd& A, VectorXd& b) {
  const auto n = limits.dq_min.size();
  A = MatrixXd::Zero(2 * n + limits.num_rows, n);
  b.resize(A.rows());
  A.topRows(n).setIdentity();
  A.middleRows(n, n) = -MatrixXd::Identity(n, n);
  b.head(n) = limits.dq_max;
  b.segment(n, n) = -limits.dq_min;
  for (int k = 0; k < limits.num_rows; ++k) {
    A.row(2 * n + k) = limits.rows[static_cast<std::size_t>(k)].a.transpose();
    b[2 * n + k] = limits.rows[static_cast<std::size_t>(k)].b;
  }
}

// The lowest cost over all active sets of at most n limits; infinite if none is feasible.
double LowestCost(const Problem& p) {
  MatrixXd A;
  VectorXd b;
  Stack(p.limits, A, b);
  const auto n = static_cast<int>(p.wish.size());
  double lowest = std::numeric_limits<double>::infinity();
  for (unsigned set = 0; set < 1U << static_cast<unsigned>(A.rows()); ++set) {
    const int count = std::popcount(set);
    if (count > n) {
      continue;
    }
    MatrixXd kkt = MatrixXd::Zero(n + count, n + count);
    VectorXd right = VectorXd::Zero(n + count);
    kkt.topLeftCorner(n, n) = p.H;
    right.head(n) = MatrixXd(p.H) * VectorXd(p.wish);
    int row = n;
    for (int k = 0; k < A.rows(); ++k) {
      if ((set >> static_cast<unsigned>(k) & 1U) != 0) {
        kkt.row(row).head(n) = A.row(k);
        kkt.col(row).head(n) = A.row(k).transpose();
        right[row++] = b[k];
      }
    }
    const VectorXd dq = kkt.fullPivLu().solve(right).head(n);
    if (dq.allFinite() && (A * dq - b).maxCoeff() < 1e-9) {
      lowest = std::min(lowest, Cost(p, dq));
    }
  }
  return lowest;
}

// Checks the active limits. Keeps the worst stationarity residual and multiplier, relative to |H wish|.
void ExpectOptimal(const Problem& p, const LimitedMotion& motion, double& worst_residual,
                   double& worst_multiplier) {
  const auto n = p.wish.size();
  std::vector<VectorXd> normals;
  for (int i = 0; i < n; ++i) {
    const VectorXd unit = VectorXd::Unit(n, i);
    if ((motion.upper >> static_cast<unsigned>(i) & 1U) != 0) {
      normals.push_back(unit);
      EXPECT_NEAR(motion.dq[i], p.limits.dq_max[i], 1e-9);
    }
    if ((motion.lower >> static_cast<unsigned>(i) & 1U) != 0) {
      normals.emplace_back(-unit);
      EXPECT_NEAR(motion.dq[i], p.limits.dq_min[i], 1e-9);
    }
  }
  for (int k = 0; k < p.limits.num_rows; ++k) {
    const barriers::LimitRow& row = p.limits.rows[static_cast<std::size_t>(k)];
    if ((motion.rows >> static_cast<unsigned>(k) & 1U) != 0) {
      normals.emplace_back(row.a.normalized());
      EXPECT_NEAR(row.a.dot(motion.dq), row.b, 1e-9);
    }
  }
  const VectorXd slope = MatrixXd(p.H) * VectorXd(motion.dq - p.wish);
  const double size = (MatrixXd(p.H) * VectorXd(p.wish)).norm();
  VectorXd rest = slope;
  if (!normals.empty()) {
    MatrixXd N(n, static_cast<Eigen::Index>(normals.size()));
    for (std::size_t k = 0; k < normals.size(); ++k) {
      N.col(static_cast<Eigen::Index>(k)) = normals[k];
    }
    const VectorXd multipliers = N.colPivHouseholderQr().solve(-slope);
    rest += N * multipliers;
    worst_multiplier = std::max(worst_multiplier, -multipliers.minCoeff() / size);
  }
  worst_residual = std::max(worst_residual, rest.norm() / size);
}

TEST(MoveIntoLimitsTest, MatchesAnExhaustiveSearch) {
  test::RandomStates random(511);
  double worst = 0.0;
  int limited = 0;
  const int cases = test::Repetitions(4000);
  for (int k = 0; k < cases; ++k) {
    const int n = 1 + k % 3;
    Problem p = RandomProblem(random, n, k / 3 % 4);
    if (k % 5 == 0) {
      p.limits.dq_min[0] = p.limits.dq_max[0];  // a joint with one allowed velocity
    }
    if (k % 7 == 0 && p.limits.num_rows > 0) {
      p.limits.rows[0].b = -0.1;  // standstill is not allowed, and perhaps nothing is
    }
    LimitedMotion motion;
    MoveIntoLimits(p.H, p.wish, p.limits, motion);
    const double lowest = LowestCost(p);
    ASSERT_EQ(std::isinf(lowest), motion.outcome == LimitOutcome::kInfeasible) << "case " << k;
    if (std::isinf(lowest)) {
      continue;
    }
    EXPECT_LE(Broken(p.limits, motion.dq), kRowTolerance);
    worst = std::max(worst, std::abs(Cost(p, motion.dq) - lowest) / (1e-6 + lowest));
    limited += motion.outcome == LimitOutcome::kLimited ? 1 : 0;
  }
  std::cout << cases << " problems, " << limited << " with limits that act: cost off the lowest by " << worst
            << " relative\n";
  EXPECT_GT(limited, cases / 3);
  EXPECT_LT(worst, 1e-6);
}

TEST(MoveIntoLimitsTest, MeetsTheOptimalityConditions) {
  test::RandomStates random(512);
  double worst_residual = 0.0;
  double worst_multiplier = 0.0;
  double worst_broken = 0.0;
  int most_steps = 0;
  int scaled = 0;
  const int cases = test::Repetitions(100000);
  double steps = 0.0;
  for (int k = 0; k < cases; ++k) {
    const Problem p = RandomProblem(random, 1 + k % 8, k / 8 % 13);
    LimitedMotion motion;
    MoveIntoLimits(p.H, p.wish, p.limits, motion);
    worst_broken = std::max(worst_broken, Broken(p.limits, motion.dq));
    most_steps = std::max(most_steps, motion.steps);
    steps += motion.steps;
    if (motion.outcome == LimitOutcome::kScaled) {
      ++scaled;
      continue;
    }
    ASSERT_NE(motion.outcome, LimitOutcome::kInfeasible);
    ASSERT_EQ(motion.outcome == LimitOutcome::kFree, motion.dq == p.wish);
    ExpectOptimal(p, motion, worst_residual, worst_multiplier);
  }
  std::cout << cases << " problems: stationary to " << worst_residual << ", multipliers >= -"
            << worst_multiplier << " (relative), limits passed by " << worst_broken << "; steps "
            << steps / cases << " mean, " << most_steps << " most; " << scaled << " unsolved\n";
  EXPECT_LT(worst_residual, 1e-8);
  EXPECT_LT(worst_multiplier, 1e-8);
  EXPECT_LE(worst_broken, kRowTolerance);
  EXPECT_LT(most_steps, LimitedMotion::kMaxSteps);
  EXPECT_EQ(scaled, 0);
}

// Degenerate on purpose: rows that repeat each other or the ranges, no feasible point, standstill as the only
// one, sizes from 1e-12 to 1e200.
TEST(MoveIntoLimitsTest, SolvesDegenerateInputWithinTheStepLimit) {
  test::RandomStates random(513);
  int counts[5] = {};
  int most_steps = 0;
  double worst_broken = 0.0;
  const int cases = test::Repetitions(100000);
  for (int k = 0; k < cases; ++k) {
    const int n = 1 + k % 8;
    Problem p = RandomProblem(random, n, 12);
    for (std::size_t row = 0; row < 12; ++row) {
      barriers::LimitRow& r = p.limits.rows[row];
      switch (static_cast<int>(random.Uniform(0.0, 8.0))) {
        case 0: r = p.limits.rows[0]; break;
        case 1: r.a = -p.limits.rows[0].a; break;
        case 2: r.a = model::VecN::Unit(n, 0); break;
        case 3: r.b = 0.0; break;
        case 4: r.a *= std::pow(10.0, random.Uniform(-12.0, 12.0)); break;
        case 5: r.a.setZero(); break;
        case 6: r.a = p.limits.rows[0].a * (1.0 + 1e-13); break;
        default: break;
      }
    }
    bool standing_still_is_kept = true;
    if (k % 4 == 1) {
      p.limits.dq_max.setZero();
    } else if (k % 4 == 2) {
      p.limits.rows[3].b = -random.Uniform(0.0, 3.0);
      standing_still_is_kept = false;
    } else if (k % 4 == 3) {
      p.wish *= std::pow(10.0, random.Uniform(0.0, 200.0));
    }
    LimitedMotion motion;
    MoveIntoLimits(p.H, p.wish, p.limits, motion);
    ++counts[static_cast<int>(motion.outcome)];
    most_steps = std::max(most_steps, motion.steps);
    ASSERT_TRUE(motion.dq.allFinite());
    if (standing_still_is_kept || motion.outcome != LimitOutcome::kInfeasible) {
      ASSERT_NE(motion.outcome, LimitOutcome::kInfeasible) << "case " << k;
      worst_broken = std::max(worst_broken, Broken(p.limits, motion.dq));
    }
  }
  std::cout << "free " << counts[0] << ", limited " << counts[1] << ", scaled " << counts[2]
            << ", infeasible " << counts[3] << ", not finite " << counts[4] << "; at most " << most_steps
            << " steps; limits passed by " << worst_broken << "\n";
  EXPECT_LE(most_steps, LimitedMotion::kMaxSteps);
  EXPECT_LE(worst_broken, kRowTolerance);
  EXPECT_EQ(counts[4], 0);
}

TEST(MoveIntoLimitsTest, ReportsNonFiniteAndInfeasibleInput) {
  test::RandomStates random(514);
  const double nan = std::nan("");
  const Problem sound = RandomProblem(random, 7, 4);
  LimitedMotion motion;
  for (int which = 0; which < 5; ++which) {
    Problem p = sound;
    switch (which) {
      case 0: p.wish[2] = nan; break;
      case 1: p.H(3, 1) = nan; break;
      case 2: p.limits.dq_max[4] = nan; break;
      case 3: p.limits.rows[1].a[5] = nan; break;
      default: p.limits.rows[1].b = nan; break;
    }
    MoveIntoLimits(p.H, p.wish, p.limits, motion);
    EXPECT_EQ(motion.outcome, LimitOutcome::kNotFinite) << which;
    EXPECT_EQ(motion.steps, 0);
  }
  Problem p = sound;
  p.limits.dq_min[1] = 0.5;
  p.limits.dq_max[1] = 0.2;
  MoveIntoLimits(p.H, p.wish, p.limits, motion);
  EXPECT_EQ(motion.outcome, LimitOutcome::kInfeasible);
  EXPECT_EQ(motion.dq[1], 0.2);
  EXPECT_EQ(motion.dq[0], 0.0);
}

}  // namespace
}  // namespace fovea::control
