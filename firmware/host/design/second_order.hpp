// SPDX-License-Identifier: Apache-2.0
// One degree of freedom, m x'' + b x' + k x = f: its poles, its exact motion, and the PD regulator that gives
// it another stiffness and damping.
//
// Every motion is a sum of four functions of time. They stay exact through critical damping and down to
// k = 0 and b = 0. They are the reference for simulations and controllers.
#pragma once

#include <array>
#include <complex>
#include <optional>

namespace fovea::design {

// A plant or a closed loop. The units are those of translation; for rotation: [kg m^2], [N m s], [N m].
struct SecondOrder {
  double mass = 1.0;       // m > 0 [kg]
  double damping = 0.0;    // b [N s/m]
  double stiffness = 0.0;  // k [N/m]
};

// omega_n = sqrt(k / m) [rad/s]; NaN for k < 0. Real-time: no, like all of design/.
[[nodiscard]] double NaturalFrequency(const SecondOrder& system);

// zeta = b / (2 sqrt(k m)). Infinite for k = 0 (NaN when b = 0 as well: the mass moves freely).
[[nodiscard]] double DampingRatio(const SecondOrder& system);

// The roots of m s^2 + b s + k [1/s], the slower one first; of a pair, the one above the real axis first. By
// the quadratic formula: an eigenvalue routine loses half of the digits of a double root.
[[nodiscard]] std::array<std::complex<double>, 2> Poles(const SecondOrder& system);

// x(t) [m] from x(0) = `x0` [m], x'(0) = `v0` [m/s], under the constant force `constant_force` [N], t >= 0
// [s].
[[nodiscard]] double Response(const SecondOrder& system, double x0, double v0, double constant_force,
                              double t);

// x'(t) [m/s] of the same motion.
[[nodiscard]] double ResponseVelocity(const SecondOrder& system, double x0, double v0, double constant_force,
                                      double t);

// The time [s] after which the step response stays within `band` of its step, 0 < band < 1. None when the
// response never settles: k <= 0 or b <= 0.
[[nodiscard]] std::optional<double> SettlingTime(const SecondOrder& system, double band = 0.02);

// f = -k_p x - k_v x'
struct PdGains {
  double k_p = 0.0;  // [N/m]
  double k_v = 0.0;  // [N s/m]
};

// The gains that give the plant `closed_loop_stiffness` > 0 [N/m] and `damping_ratio` >= 0 in closed loop:
// k_p = k_cl - k, k_v = 2 zeta sqrt(m k_cl) - b. A gain is negative when the plant has more than requested.
[[nodiscard]] PdGains DesignPd(const SecondOrder& plant, double closed_loop_stiffness,
                               double damping_ratio = 1.0);

// The plant with the regulator around it, continuous and without delay.
[[nodiscard]] SecondOrder CloseLoop(const SecondOrder& plant, const PdGains& gains);

}  // namespace fovea::design
