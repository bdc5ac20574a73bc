// SPDX-License-Identifier: Apache-2.0
// Weighted least squares with an honest covariance, for measurements whose errors are neither quite known nor
// independent.
//
// A weak prior on each unknown keeps the equations solvable when the data tell nothing of it. Outliers get
// the weights of Huber (Robust Statistics, 1981). The covariance is scaled by the residuals' chi-square, and
// is at least that of Newey and West (A simple, positive semi-definite, heteroskedasticity and
// autocorrelation consistent covariance matrix, 1987), which takes successive residuals for correlated.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace fovea::beliefs {

// The equations of one measurement, divided by its standard deviation.
struct Equations {
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;  // of the residual, a column for each unknown
};

struct Solution {
  Eigen::VectorXd change;       // of the unknowns, to the minimum of the linearised problem
  Eigen::MatrixXd covariance;   // of the unknowns, with the prior
  Eigen::MatrixXd information;  // of data and prior
  Eigen::VectorXd gradient;     // of half the cost
  double misfit = 0.0;          // of the residuals, in their stated standard deviations; 1: as stated

  // A shorter change, by a prior `damping` times as strong on the change itself. (Levenberg, A method for the
  // solution of certain non-linear problems in least squares, 1944.)
  [[nodiscard]] Eigen::VectorXd DampedChange(double damping, const Eigen::VectorXd& prior_sigma) const;
};

// One step of Gauss and Newton. `blocks`: in order of time. `x`: the unknowns now; `prior_sigma`: standard
// deviation of each about 0. `least_misfit`: the measurements are never trusted more than this.
[[nodiscard]] Solution Solve(const std::vector<Equations>& blocks, const Eigen::VectorXd& x,
                             const Eigen::VectorXd& prior_sigma, double least_misfit = 1e-6);

// What the step decreases: the sum of squares of residuals, in units of `misfit`, and of `x`, with Huber's
// weights.
[[nodiscard]] double CostOf(const std::vector<Equations>& blocks, const Eigen::VectorXd& x,
                            const Eigen::VectorXd& prior_sigma, double misfit);

// What the data alone say of one unknown, without its own prior.
struct Marginal {
  double value = 0.0;
  double sigma = 0.0;  // infinite: nothing
};
[[nodiscard]] Marginal WithoutPrior(double value, double variance, double prior_sigma);

}  // namespace fovea::beliefs
