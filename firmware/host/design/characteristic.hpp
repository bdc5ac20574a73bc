// SPDX-License-Identifier: Apache-2.0
// The characteristic polynomial of a sampled loop (see sampled_loop.hpp), and how many of its roots are
// within the unit circle.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>

#include "firmware/host/design/sampled_loop.hpp"

namespace fovea::design {

// Plant and gains with time in sampling periods. Stores Phi - I instead of Phi: at a fast rate Phi is so near
// to I that rounding would lose the plant.
struct Discretised {
  explicit Discretised(const SampledLoop& loop);

  double k_p;
  double k_v;
  int whole_periods;  // of the delay
  double fraction;    // the rest of the delay [periods], 0 <= fraction < 1
  double kappa;
  double beta;
  double h;  // response to a unit impulse after one period
  double H;  // response to a unit step after one period
  Eigen::Matrix2d Phi_minus_I;
  Eigen::Vector2d Gamma_0;
  Eigen::Vector2d Gamma_1;
};

// F(w) = (1-w)^2 + p_1 (1-w) w + p_0 w^2 + w^(n+1) ((1-w) (a_0 + a_1 w) + w (b_0 + b_1 w))
class Characteristic {
 public:
  explicit Characteristic(const Discretised& plant);

  // F at w = exp(j phi).
  [[nodiscard]] std::complex<double> At(double phi) const;

  // No less than |d^2 F / d phi^2| for all angles from 0 to `phi`.
  [[nodiscard]] double CurvatureBound(double phi) const;

 private:
  int n_;
  double p_0_;
  double p_1_;
  Eigen::Vector2d a_;
  Eigen::Vector2d b_;
};

// Number of roots of F in |w| < 1. None when a root is on the circle to within rounding.
[[nodiscard]] std::optional<int> RootsWithinUnitCircle(const Characteristic& F);

}  // namespace fovea::design
