// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/least_squares.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace fovea::beliefs {
namespace {

struct Converged {
  Eigen::VectorXd x;
  Solution solution;
};

// Solves the linear equations `blocks`, whose residuals hold at 0, until the residuals' weights are settled.
Converged SolveLinear(const std::vector<Equations>& blocks, const Eigen::VectorXd& prior_sigma) {
  Converged result;
  result.x = Eigen::VectorXd::Zero(prior_sigma.size());
  for (int step = 0; step < 10; ++step) {
    std::vector<Equations> now = blocks;
    for (Equations& block : now) {
      block.residual += block.jacobian * result.x;
    }
    result.solution = Solve(now, result.x, prior_sigma);
    result.x += result.solution.change;
  }
  return result;
}

// A line a + b t through 200 points with noise, whose true a = 1 and b = -2; 400 lines. The share of them in
// which both errors are within two standard deviations, for `noise(i)` in stated standard deviations.
double ShareWithinTwoSigmas(const std::function<std::function<double(int)>(std::mt19937_64&)>& make_noise) {
  std::mt19937_64 engine(1);
  int within = 0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    const std::function<double(int)> noise = make_noise(engine);
    std::vector<Equations> blocks;
    for (int i = 0; i < 200; ++i) {
      const double t = 0.01 * i;
      Equations block;
      block.residual = Eigen::VectorXd::Constant(1, 1.0 - 2.0 * t + noise(i));
      block.jacobian = Eigen::RowVector2d(-1.0, -t);
      blocks.push_back(block);
    }
    const auto [x, s] = SolveLinear(blocks, Eigen::Vector2d::Constant(1e3));
    within += std::fabs(x[0] - 1.0) <= 2.0 * std::sqrt(s.covariance(0, 0)) ? 1 : 0;
    within += std::fabs(x[1] + 2.0) <= 2.0 * std::sqrt(s.covariance(1, 1)) ? 1 : 0;
  }
  return within / (2.0 * kRuns);
}

TEST(SolveTest, SigmaIsHonestForIndependentNoise) {
  const double share = ShareWithinTwoSigmas([](std::mt19937_64& engine) {
    return [&engine](int) { return 0.3 * std::normal_distribution<double>()(engine); };
  });
  fmt::print("independent noise of 0.3 stated sigmas: {:.1f} % within 2 sigma\n", 100.0 * share);
  EXPECT_GE(share, 0.90);
  EXPECT_LE(share, 0.99);
}

// Such noise doubles the errors: a covariance without regard to it would have 68 % within two of its sigmas.
TEST(SolveTest, SigmaIsHonestForCorrelatedNoise) {
  const double share = ShareWithinTwoSigmas([](std::mt19937_64& engine) {
    return [&engine, state = 0.0](int) mutable {
      return state = 0.6 * state + std::normal_distribution<double>()(engine);
    };
  });
  fmt::print("noise with a correlation of 0.6 from one measurement to the next: {:.1f} % within 2 sigma\n",
             100.0 * share);
  EXPECT_GE(share, 0.85);
  EXPECT_LE(share, 0.99);
}

TEST(SolveTest, OutliersHardlyCount) {
  std::mt19937_64 engine(2);
  std::normal_distribution<double> normal;
  std::vector<Equations> blocks;
  for (int i = 0; i < 200; ++i) {
    Equations block;
    block.residual = Eigen::VectorXd::Constant(1, 5.0 + 0.1 * normal(engine) + (i % 20 == 0 ? 50.0 : 0.0));
    block.jacobian = Eigen::MatrixXd::Constant(1, 1, -1.0);
    blocks.push_back(block);
  }
  const Eigen::VectorXd x = SolveLinear(blocks, Eigen::VectorXd::Constant(1, 1e3)).x;
  fmt::print("5 % of outliers by 50: {:.4f} for a true value of 5\n", x[0]);
  EXPECT_NEAR(x[0], 5.0, 0.05);
}

// Only the sum of two unknowns is seen: neither is known, although their sum is.
TEST(SolveTest, WhatIsNotSeenKeepsItsPrior) {
  std::vector<Equations> blocks;
  for (int i = 0; i < 50; ++i) {
    Equations block;
    block.residual = Eigen::VectorXd::Constant(1, 3.0 + (i % 2 == 0 ? 0.01 : -0.01));
    block.jacobian = Eigen::RowVector2d(-1.0, -1.0);
    blocks.push_back(block);
  }
  const auto [x, s] = SolveLinear(blocks, Eigen::Vector2d::Constant(100.0));
  EXPECT_NEAR(std::sqrt(s.covariance(0, 0)), 100.0 / std::sqrt(2.0), 0.1);
  EXPECT_NEAR(x.sum(), 3.0, 1e-3);
  const Eigen::Vector2d sum(1.0, 1.0);
  EXPECT_LE(std::sqrt(sum.dot(s.covariance * sum)), 0.01);
}

TEST(WithoutPriorTest, TakesThePriorOut) {
  // A datum 4 +- 2 and the prior 0 +- 2 give 2 +- sqrt(2).
  const Marginal marginal = WithoutPrior(2.0, 2.0, 2.0);
  EXPECT_NEAR(marginal.value, 4.0, 1e-12);
  EXPECT_NEAR(marginal.sigma, 2.0, 1e-12);
  EXPECT_TRUE(std::isinf(WithoutPrior(0.0, 4.0, 2.0).sigma));
}

}  // namespace
}  // namespace fovea::beliefs
