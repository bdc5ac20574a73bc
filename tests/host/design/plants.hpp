// SPDX-License-Identifier: Apache-2.0
// Plants for the design tests, and their motion by an independent numerical method.
#pragma once

#include <cmath>
#include <random>

#include "firmware/host/design/second_order.hpp"

namespace fovea::test {

inline constexpr design::SecondOrder kExercise{16.0, 16.0, 4.0};

inline double LogUniform(std::mt19937& random, double low, double high) {
  return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
}

// Heavy or light, overdamped or oscillating; some without damping, some without a spring.
inline design::SecondOrder RandomPlant(std::mt19937& random) {
  const double mass = LogUniform(random, 0.05, 50.0);
  const double omega_n = LogUniform(random, 0.2, 30.0);
  const double zeta = LogUniform(random, 0.02, 4.0);
  const unsigned kind = random() % 8;
  return {mass, kind == 0 ? 0.0 : 2.0 * zeta * omega_n * mass, kind == 1 ? 0.0 : mass * omega_n * omega_n};
}

struct Motion {
  double x = 0.0;
  double v = 0.0;
};

// One step of the classical Runge-Kutta method.
inline Motion RungeKutta(const design::SecondOrder& plant, const Motion& from, double force, double dt) {
  const auto rate = [&](const Motion& at) {
    return Motion{at.v, (force - plant.damping * at.v - plant.stiffness * at.x) / plant.mass};
  };
  const auto ahead = [&](const Motion& slope, double time) {
    return Motion{from.x + time * slope.x, from.v + time * slope.v};
  };
  const Motion k1 = rate(from);
  const Motion k2 = rate(ahead(k1, 0.5 * dt));
  const Motion k3 = rate(ahead(k2, 0.5 * dt));
  const Motion k4 = rate(ahead(k3, dt));
  return {from.x + dt / 6.0 * (k1.x + 2.0 * k2.x + 2.0 * k3.x + k4.x),
          from.v + dt / 6.0 * (k1.v + 2.0 * k2.v + 2.0 * k3.v + k4.v)};
}

}  // namespace fovea::test
