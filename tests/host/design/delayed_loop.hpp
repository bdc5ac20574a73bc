// SPDX-License-Identifier: Apache-2.0
// Simulates a sampled regulator with a delay: Runge-Kutta for the plant between changes of the force, and a
// queue for the delayed forces. Independent of the transition matrices and poles of firmware/host/design.
#pragma once

#include <cmath>
#include <deque>

#include "firmware/host/design/sampled_loop.hpp"
#include "tests/host/design/plants.hpp"

namespace fovea::test {

class DelayedLoop {
 public:
  DelayedLoop(const design::SampledLoop& loop, const Motion& start) : loop_(loop), motion_(start) {}

  // From one sample to just before the next.
  void Period() {
    const double delay = loop_.delay_s * loop_.rate_hz;
    const double now = static_cast<double>(sample_);
    queue_.push_back({now + delay, -loop_.gains.k_p * motion_.x - loop_.gains.k_v * motion_.v});
    double at = now;
    while (!queue_.empty() && queue_.front().due < now + 1.0 - 1e-9) {
      const double due = std::fmax(queue_.front().due, at);
      Integrate(due - at);
      at = due;
      force_ = queue_.front().force;
      queue_.pop_front();
    }
    Integrate(now + 1.0 - at);
    ++sample_;
  }

  [[nodiscard]] const Motion& motion() const { return motion_; }

 private:
  struct Due {
    double due;  // in periods
    double force;
  };

  void Integrate(double periods) {
    const design::SecondOrder& plant = loop_.plant;
    const double time = periods / loop_.rate_hz;
    const double fastest = std::fmax(plant.damping / plant.mass, std::sqrt(plant.stiffness / plant.mass));
    const int steps = 1 + static_cast<int>(time * fastest / 0.01);
    for (int i = 0; i < steps; ++i) {
      motion_ = RungeKutta(plant, motion_, force_, time / steps);
    }
  }

  design::SampledLoop loop_;
  Motion motion_;
  double force_ = 0.0;
  std::deque<Due> queue_;
  long sample_ = 0;
};

enum class Fate { kDecays, kGrows, kUndecided };

// Simulates from an initial error: kDecays at a factor of 1e-6 and kGrows at 1e3, relative to the size once
// only the slowest mode is left. kUndecided after `most_periods`.
inline Fate FateOf(const design::SampledLoop& loop, long most_periods = 3'000'000) {
  const double omega = std::sqrt((loop.plant.stiffness + std::fabs(loop.gains.k_p)) / loop.plant.mass);
  DelayedLoop run(loop, {1.0, 0.5 * omega});
  const auto window =
      static_cast<long>(20.0 + 3.0 * loop.delay_s * loop.rate_hz + 10.0 * loop.rate_hz / omega);
  double reference = 0.0;
  for (long done = 0; done < most_periods; done += window) {
    double largest = 0.0;
    for (long k = 0; k < window; ++k) {
      run.Period();
      largest = std::fmax(largest, std::hypot(run.motion().x, run.motion().v / omega));
    }
    if (done == 3 * window) {
      reference = largest;
    }
    if (reference > 0.0 && !(largest > 1e-6 * reference)) {
      return Fate::kDecays;
    }
    if (largest > 1e100 || (reference > 0.0 && largest > 1e3 * reference)) {
      return Fate::kGrows;
    }
  }
  return Fate::kUndecided;
}

}  // namespace fovea::test
