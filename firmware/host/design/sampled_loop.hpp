// A PD regulator as a computer runs it: it samples the plant at a rate, and each force acts from a delay
// after its sample until the next one replaces it (zero-order hold). Where its poles are, and when it stops
// being stable.
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
// unit circle, is one such root: they are counted at the same cost for a delay of one period and of a hundred
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
  double delay_s =
      0.0;  // from the sample until its force acts, >= 0 [s]; of any number of periods, not whole
};

// The state (x, v, u[k-1], u[k-2], ...) of one period after this one [n x n]: two rows, and one for each
// force that is under way. Time in periods T, v in x/T, u in x/T^2, so that no entry is large. Real-time: no,
// like all of design/.
[[nodiscard]] Eigen::MatrixXd PeriodMatrix(const SampledLoop& loop);

// The poles z, the largest |z| first; of a pair, the one above the real axis first. By the eigenvalues of
// PeriodMatrix: a second's work at a delay of some hundred periods, growing with the cube.
[[nodiscard]] std::vector<std::complex<double>> Poles(const SampledLoop& loop);

// The pole s = log(z) rate [1/s] that a sampling at `rate_hz` shows as `z` != 0.
[[nodiscard]] std::complex<double> EquivalentPole(const std::complex<double>& z, double rate_hz);

// How many poles are outside the unit circle. None when one is on it, to the last few digits of a double.
[[nodiscard]] std::optional<int> CountUnstablePoles(const SampledLoop& loop);

[[nodiscard]] bool IsStable(const SampledLoop& loop);

// Where stability ends: the first place on the way, found by steps of 0.2 % and then halved to the digits of
// a double. A stretch of the other kind that is shorter than a step can be missed.
struct StabilityEdge {
  std::optional<double> at;  // none: stability does not change up to `searched_to`
  double searched_to = 0.0;
};

// The factor on both gains. For a stable loop the first factor above 1 that makes it unstable; for an
// unstable loop the first one below 1 that makes it stable.
[[nodiscard]] StabilityEdge GainEdge(const SampledLoop& loop);

// The delay [s], counted from none, that makes the loop unstable with its gains, whatever its own delay is; 0
// when it is unstable without any. Searched to 20 times the slowest time constant of plant and loop, to no
// less than 100 periods and no more than kMostPeriods.
[[nodiscard]] StabilityEdge DelayEdge(const SampledLoop& loop);

inline constexpr double kMostPeriods = 1e5;  // of delay, for all functions but PeriodMatrix and Poles

}  // namespace fovea::design
