// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/design/second_order.hpp"

#include <cmath>
#include <numbers>

namespace fovea::design {
namespace {

// (e^y - 1) / y
double ExpDifference(double y) { return y == 0.0 ? 1.0 : std::expm1(y) / y; }

// x'' + 2 a x' + w x = u: the coefficients, and a^2 - w, negative when the motion oscillates.
struct Normal {
  explicit Normal(const SecondOrder& system)
      : a(system.damping / (2.0 * system.mass)), w(system.stiffness / system.mass), discriminant(a * a - w) {}
  double a;
  double w;
  double discriminant;
};

struct RealPoles {
  double slow;
  double fast;
};

// For discriminant >= 0. One root is a sum, the other follows from the product of both: nothing cancels.
RealPoles RealPolesOf(const Normal& normal) {
  const double root = std::sqrt(normal.discriminant);
  if (normal.a >= 0.0) {
    const double sum = normal.a + root;
    return {normal.w == 0.0 ? 0.0 : -normal.w / sum, 0.0 - sum};
  }
  const double slow = -normal.a + root;
  return {slow, normal.w / slow};
}

// The basis of every motion: x = x0 g + v0 h + u H under a constant acceleration u.
struct Basis {
  double g;   // from x(0) = 1 at rest
  double h;   // from x'(0) = 1 at zero; also H'
  double dh;  // h'
  double H;   // from rest at zero under u = 1
};

// H by its Taylor series, for |a| t and sqrt(|w|) t below one half, where the closed forms cancel.
double ShortTimeH(const Normal& normal, double t) {
  double before = 0.0;
  double term = t;
  double sum = 0.5 * t * t;
  for (int n = 0; n < 24; ++n) {
    const double next =
        -(2.0 * normal.a * t * (n + 1) * term + normal.w * t * t * before) / ((n + 1.0) * (n + 2.0));
    before = term;
    term = next;
    sum += term * t / (n + 3.0);
  }
  return sum;
}

Basis BasisAt(const Normal& normal, double t) {
  const auto& [a, w, discriminant] = normal;
  Basis basis{};
  if (discriminant < 0.0) {
    const double omega = std::sqrt(-discriminant);
    const double decay = std::exp(-a * t);
    basis.h = decay * std::sin(omega * t) / omega;
    basis.g = decay * std::cos(omega * t) + a * basis.h;
    basis.dh = decay * std::cos(omega * t) - a * basis.h;
  } else {
    const RealPoles poles = RealPolesOf(normal);
    const double apart = 2.0 * std::sqrt(discriminant);
    basis.h = std::exp(poles.slow * t) * t * ExpDifference(-apart * t);
    basis.g = std::exp(poles.slow * t) - poles.slow * basis.h;
    basis.dh = std::exp(poles.fast * t) + poles.slow * basis.h;
  }
  if (std::fmax(std::fabs(a), std::sqrt(std::fabs(w))) * t < 0.5) {
    basis.H = ShortTimeH(normal, t);
  } else if (discriminant > 0.25 * a * a) {
    const RealPoles poles = RealPolesOf(normal);
    basis.H = t * (ExpDifference(poles.slow * t) - ExpDifference(poles.fast * t)) / (poles.slow - poles.fast);
  } else {
    basis.H = (1.0 - basis.g) / w;
  }
  return basis;
}

// Where `f` crosses `level`. `f` falls from above the level at `low` to below it at `high`.
template <typename Function>
double Falls(const Function& f, double level, double low, double high) {
  for (double middle = 0.5 * (low + high); low < middle && middle < high; middle = 0.5 * (low + high)) {
    (f(middle) > level ? low : high) = middle;
  }
  return high;
}

}  // namespace

double NaturalFrequency(const SecondOrder& system) { return std::sqrt(system.stiffness / system.mass); }

double DampingRatio(const SecondOrder& system) {
  return system.damping / (2.0 * std::sqrt(system.stiffness * system.mass));
}

std::array<std::complex<double>, 2> Poles(const SecondOrder& system) {
  const Normal normal(system);
  if (normal.discriminant < 0.0) {
    const std::complex<double> upper(-normal.a, std::sqrt(-normal.discriminant));
    return {upper, std::conj(upper)};
  }
  const RealPoles poles = RealPolesOf(normal);
  return {poles.slow, poles.fast};
}

double Response(const SecondOrder& system, double x0, double v0, double constant_force, double t) {
  const Basis basis = BasisAt(Normal(system), t);
  return x0 * basis.g + v0 * basis.h + constant_force / system.mass * basis.H;
}

double ResponseVelocity(const SecondOrder& system, double x0, double v0, double constant_force, double t) {
  const Normal normal(system);
  const Basis basis = BasisAt(normal, t);
  return (constant_force / system.mass - x0 * normal.w) * basis.h + v0 * basis.dh;
}

std::optional<double> SettlingTime(const SecondOrder& system, double band) {
  if (!(system.damping > 0.0 && system.stiffness > 0.0)) {
    return std::nullopt;
  }
  // The remaining share of the step.
  const auto rest = [&](double t) { return Response(system, 1.0, 0.0, 0.0, t); };
  const Normal normal(system);
  if (normal.discriminant < 0.0) {
    // The extremes are half a period apart and shrink like exp(-a t). The response stays in the band after
    // the last extreme outside it.
    const double half_period = std::numbers::pi / std::sqrt(-normal.discriminant);
    const double last = std::floor(-std::log(band) / (normal.a * half_period));
    const double sign = std::fmod(last, 2.0) == 0.0 ? 1.0 : -1.0;
    return Falls([&](double t) { return sign * rest(t); }, band, last * half_period,
                 (last + 1.0) * half_period);
  }
  double high = -1.0 / RealPolesOf(normal).slow;
  while (rest(high) > band) {
    high *= 2.0;
  }
  return Falls(rest, band, 0.0, high);
}

PdGains DesignPd(const SecondOrder& plant, double closed_loop_stiffness, double damping_ratio) {
  return {closed_loop_stiffness - plant.stiffness,
          2.0 * damping_ratio * std::sqrt(plant.mass * closed_loop_stiffness) - plant.damping};
}

SecondOrder CloseLoop(const SecondOrder& plant, const PdGains& gains) {
  return {plant.mass, plant.damping + gains.k_v, plant.stiffness + gains.k_p};
}

}  // namespace fovea::design
