// SPDX-License-Identifier: Apache-2.0
// A PD regulator as a computer runs it: it samples the plant at a rate, and each force acts from a delay
// after its sample until the next one replaces it (zero-order hold). Computes its poles and the limits of its
// stability.
//
// With time in sampling periods the plant is x'' + beta x' + kappa x = u, and over one period
//
//   (x, v)+ = Phi (x, v) + Gamma_0 u[k - n] + Gamma_1 u[k - n - 1],   u[k] = -K (x, v)[k]
//
// exactly, where n is the delay's whole periods and Gamma_1 the share of its fraction (Astrom and Wittenmark,
// Computer-Controlled Systems, ch. 2). With w = 1/z its characteristic polynomial is
//
//   F(w) = det((1 - w) I - w (Phi - I)) + w^(n+1) K adj((1 - w) I - w (Phi - I)) (Gamma_0 + w Gamma_1),
//
// and the loop is stable when F has no root in |w| <= 1. Each turn of F(w) about zero, as w goes round the
// unit circle, is one such root. Counting turns costs the same for a delay of one period and of a hundred
// thousand.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

#include "firmware/host/design/second_order.hpp"

namespace fovea::design {

struct SampledLoop {
  SecondOrder plant;
  PdGains gains;
  double rate_hz = 1000.0;  // > 0
  double delay_s = 0.0;     // from the sample until its force acts, >= 0 [s]; need not be whole periods
};

// The matrix [n x n] that advances the state (x, v, u[k-1], u[k-2], ...) by one period: two rows, and one for
// each delayed force. Time in periods T, v in x/T, u in x/T^2, so that no entry is large. Real-time: no, like
// all of design/.
[[nodiscard]] Eigen::MatrixXd PeriodMatrix(const SampledLoop& loop);

// The poles z, the largest |z| first; of a pair, the one above the real axis first. From the eigenvalues of
// PeriodMatrix: takes about a second at a delay of some hundred periods and grows with its cube.
[[nodiscard]] std::vector<std::complex<double>> Poles(const SampledLoop& loop);

// The pole s = log(z) rate [1/s] that a sampling at `rate_hz` shows as `z` != 0.
[[nodiscard]] std::complex<double> EquivalentPole(const std::complex<double>& z, double rate_hz);

// The number of poles outside the unit circle. None when a pole is on the circle to within rounding.
[[nodiscard]] std::optional<int> CountUnstablePoles(const SampledLoop& loop);

[[nodiscard]] bool IsStable(const SampledLoop& loop);

// The first change of stability on the way, found in steps of 0.2 % and then bisected to double precision. A
// stable or unstable interval shorter than one step can be missed.
struct StabilityEdge {
  std::optional<double> at;  // none: stability does not change up to `searched_to`
  double searched_to = 0.0;
};

// The factor on both gains. For a stable loop the first factor above 1 that makes it unstable; for an
// unstable loop the first one below 1 that makes it stable.
[[nodiscard]] StabilityEdge GainEdge(const SampledLoop& loop);

// The smallest delay [s] that makes the loop unstable with its gains; 0 when it is unstable without delay.
// Ignores loop.delay_s. Searches up to 20 times the slowest time constant of plant and loop, but at least 100
// and at most kMostPeriods periods.
[[nodiscard]] StabilityEdge DelayEdge(const SampledLoop& loop);

inline constexpr double kMostPeriods = 1e5;  // of delay, for all functions but PeriodMatrix and Poles

}  // namespace fovea::design
