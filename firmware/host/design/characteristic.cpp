// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/design/characteristic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fovea::design {
namespace {

constexpr double kSameInstant = 1e-9;  // a delay this close to whole periods counts as whole [periods]
constexpr int kDeepest = 48;           // most halvings of the half circle

// Position and velocity at time `t` after a start from rest under a unit force.
Eigen::Vector2d ForcedState(const SecondOrder& system, double t) {
  return {Response(system, 0.0, 0.0, 1.0, t), ResponseVelocity(system, 0.0, 0.0, 1.0, t)};
}

double DistanceToSegment(const std::complex<double>& from, const std::complex<double>& to) {
  const std::complex<double> along = to - from;
  const double length_squared = std::norm(along);
  const double share =
      length_squared > 0.0 ? std::clamp(-(from * std::conj(along)).real() / length_squared, 0.0, 1.0) : 0.0;
  return std::abs(from + share * along);
}

// The angle by which F turns about zero from `phi_1` to `phi_2`, or none when F may touch zero. A curve
// deviates from its chord by no more than curvature * length^2 / 8. When zero is farther from the chord than
// that, curve and chord turn about zero by the same angle.
std::optional<double> Turn(const Characteristic& F, double phi_1, const std::complex<double>& F_1,
                           double phi_2, const std::complex<double>& F_2, int depth) {
  const double length = phi_2 - phi_1;
  if (DistanceToSegment(F_1, F_2) > F.CurvatureBound(phi_2) * length * length / 8.0) {
    return std::arg(F_2 * std::conj(F_1));
  }
  if (depth == kDeepest) {
    return std::nullopt;
  }
  const double phi = 0.5 * (phi_1 + phi_2);
  const std::complex<double> F_middle = F.At(phi);
  const std::optional<double> first = Turn(F, phi_1, F_1, phi, F_middle, depth + 1);
  const std::optional<double> second = first ? Turn(F, phi, F_middle, phi_2, F_2, depth + 1) : std::nullopt;
  return second ? std::optional(*first + *second) : std::nullopt;
}

}  // namespace

Discretised::Discretised(const SampledLoop& loop) {
  const double period_s = 1.0 / loop.rate_hz;
  const double per_mass = period_s / loop.plant.mass;
  kappa = loop.plant.stiffness * period_s * per_mass;
  beta = loop.plant.damping * per_mass;
  k_p = loop.gains.k_p * period_s * per_mass;
  k_v = loop.gains.k_v * per_mass;

  const double periods = loop.delay_s * loop.rate_hz;
  whole_periods = static_cast<int>(std::floor(periods + kSameInstant));
  fraction = periods - whole_periods > kSameInstant ? periods - whole_periods : 0.0;

  const SecondOrder plant{1.0, beta, kappa};
  const Eigen::Vector2d Gamma = ForcedState(plant, 1.0);
  H = Gamma.x();
  h = Gamma.y();
  Phi_minus_I << -kappa * H, h, -kappa * h, -kappa * H - beta * h;
  Gamma_0 = ForcedState(plant, 1.0 - fraction);
  Gamma_1 = Gamma - Gamma_0;
}

Characteristic::Characteristic(const Discretised& plant)
    : n_(plant.whole_periods),
      p_0_(plant.kappa * (plant.H * (plant.kappa * plant.H + plant.beta * plant.h) + plant.h * plant.h)),
      p_1_(2.0 * plant.kappa * plant.H + plant.beta * plant.h) {
  // K adj(d I - Psi) = d K + K adj(-Psi), with Psi = Phi - I and d = (1 - w) / w.
  const Eigen::RowVector2d K(plant.k_p, plant.k_v);
  const Eigen::Matrix2d& Psi = plant.Phi_minus_I;
  Eigen::Matrix2d adjugate;
  adjugate << -Psi(1, 1), Psi(0, 1), Psi(1, 0), -Psi(0, 0);
  a_ << K * plant.Gamma_0, K * plant.Gamma_1;
  b_ << K * adjugate * plant.Gamma_0, K * adjugate * plant.Gamma_1;
}

std::complex<double> Characteristic::At(double phi) const {
  const std::complex<double> w = std::polar(1.0, phi);
  // 1 - w, without the loss of digits near w = 1.
  const double half_sine = std::sin(0.5 * phi);
  const std::complex<double> d = 2.0 * half_sine * std::complex<double>(half_sine, -std::cos(0.5 * phi));
  const std::complex<double> delayed = std::polar(1.0, (n_ + 1.0) * phi);
  return d * (d + p_1_ * w) + p_0_ * w * w + delayed * (d * (a_[0] + a_[1] * w) + w * (b_[0] + b_[1] * w));
}

double Characteristic::CurvatureBound(double phi) const {
  const double d = std::min(phi, 2.0);                                      // |1 - w|
  const auto power = [](double k) { return k * k; };                        // of w^k
  const auto with_d = [&](double k) { return k * k * d + 2.0 * k + 1.0; };  // of (1 - w) w^k
  const double n = n_;
  return 2.0 + 2.0 * d + std::fabs(p_1_) * with_d(1.0) + std::fabs(p_0_) * power(2.0) +
         std::fabs(a_[0]) * with_d(n + 1.0) + std::fabs(a_[1]) * with_d(n + 2.0) +
         std::fabs(b_[0]) * power(n + 2.0) + std::fabs(b_[1]) * power(n + 3.0);
}

std::optional<int> RootsWithinUnitCircle(const Characteristic& F) {
  // The lower half mirrors the upper one: half of the circle makes half of the turns.
  const std::optional<double> turn = Turn(F, 0.0, F.At(0.0), std::numbers::pi, F.At(std::numbers::pi), 0);
  if (!turn) {
    return std::nullopt;
  }
  return static_cast<int>(std::lround(*turn / std::numbers::pi));
}

}  // namespace fovea::design
