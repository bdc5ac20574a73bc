// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/least_squares.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace fovea::beliefs {
namespace {

constexpr double kHuber = 3.0;    // larger residuals count less, in typical ones
constexpr std::size_t kLags = 8;  // measurements over which residuals may be correlated

// Size of a residual in standard deviations.
double SizeOf(const Equations& block) {
  return std::sqrt(block.residual.squaredNorm() / static_cast<double>(block.residual.size()));
}

// The size of a typical residual, by the median, which outliers hardly change. (Wilson and Hilferty, The
// distribution of chi-square, 1931, for the median of that of a normal one.)
double TypicalSize(const std::vector<Equations>& blocks) {
  std::vector<double> sizes;
  for (const Equations& block : blocks) {
    const double root = 1.0 - 2.0 / (9.0 * static_cast<double>(block.residual.size()));
    sizes.push_back(SizeOf(block) / std::sqrt(root * root * root));
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

// Covariance of the sum of `gradients`, each correlated with its neighbours.
Eigen::MatrixXd Scatter(const std::vector<Eigen::VectorXd>& gradients, Eigen::Index size) {
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t lag = 0; lag <= kLags; ++lag) {
    const double weight = 1.0 - static_cast<double>(lag) / (kLags + 1.0);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t k = lag; k < gradients.size(); ++k) {
      sum += gradients[k] * gradients[k - lag].transpose();
    }
    scatter += lag == 0 ? sum : Eigen::MatrixXd(weight * (sum + sum.transpose()));
  }
  return scatter;
}

}  // namespace

Solution Solve(const std::vector<Equations>& blocks, const Eigen::VectorXd& x,
               const Eigen::VectorXd& prior_sigma, double least_misfit) {
  const Eigen::Index size = x.size();
  const Eigen::MatrixXd prior = prior_sigma.cwiseAbs2().cwiseInverse().asDiagonal();
  Solution solution;
  solution.change = -x;
  solution.covariance = prior_sigma.cwiseAbs2().asDiagonal();
  if (blocks.empty()) {
    return solution;
  }
  const double typical = std::max(TypicalSize(blocks), std::numeric_limits<double>::min());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
  std::vector<Eigen::VectorXd> gradients;
  double chi2 = 0.0;
  double equations = 0.0;
  for (const Equations& block : blocks) {
    const double weight = std::min(1.0, kHuber * typical / std::max(SizeOf(block), 1e-300));
    information += weight * block.jacobian.transpose() * block.jacobian;
    gradients.emplace_back(weight * block.jacobian.transpose() * block.residual);
    gradient += gradients.back();
    chi2 += weight * block.residual.squaredNorm();
    equations += weight * static_cast<double>(block.residual.size());
  }
  // The residuals' own scale balances data and prior. The unknowns that the data determine use up equations.
  const double least_scale2 = least_misfit * least_misfit;
  double scale2 = std::max(chi2 / equations, least_scale2);
  Eigen::MatrixXd covariance;
  for (int i = 0; i < 3; ++i) {
    covariance = (information / scale2 + prior).llt().solve(Eigen::MatrixXd::Identity(size, size));
    const double determined = (covariance * information).trace() / scale2;
    scale2 = std::max(chi2 / std::max(equations - determined, 1.0), least_scale2);
  }
  solution.information = information / scale2 + prior;
  solution.gradient = gradient / scale2 + prior * x;
  solution.misfit = std::sqrt(scale2);
  solution.change = solution.DampedChange(0.0, prior_sigma);
  const Eigen::MatrixXd robust =
      covariance * (Scatter(gradients, size) / (scale2 * scale2) + prior) * covariance;
  const Eigen::VectorXd inflation =
      (robust.diagonal().cwiseQuotient(covariance.diagonal())).cwiseMax(1.0).cwiseSqrt();
  solution.covariance = inflation.asDiagonal() * covariance * inflation.asDiagonal();
  return solution;
}

Eigen::VectorXd Solution::DampedChange(double damping, const Eigen::VectorXd& prior_sigma) const {
  Eigen::MatrixXd damped = information;
  damped.diagonal() += damping * prior_sigma.cwiseAbs2().cwiseInverse();
  return -damped.llt().solve(gradient);
}

double CostOf(const std::vector<Equations>& blocks, const Eigen::VectorXd& x,
              const Eigen::VectorXd& prior_sigma, double misfit) {
  double cost = x.cwiseQuotient(prior_sigma).squaredNorm();
  for (const Equations& block : blocks) {
    const double size = SizeOf(block) / misfit;
    const double square = size <= kHuber ? size * size : kHuber * (2.0 * size - kHuber);
    cost += static_cast<double>(block.residual.size()) * square;
  }
  return cost;
}

Marginal WithoutPrior(double value, double variance, double prior_sigma) {
  const double information = 1.0 / variance - 1.0 / (prior_sigma * prior_sigma);
  if (!(information > 0.0)) {
    return {0.0, std::numeric_limits<double>::infinity()};
  }
  return {value / (variance * information), std::sqrt(1.0 / information)};
}

}  // namespace fovea::beliefs
