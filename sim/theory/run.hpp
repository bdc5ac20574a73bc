// SPDX-License-Identifier: Apache-2.0
// Compares a run of a one-joint arm (mass, damper, spring, linear law) with its analytic response.
//
// With e = goal - actual, the loop is  e'' + c_1 e' + c_0 e + c_i (integral of e) = -f / m  under a constant
// force f. The analytic response starts in the run's state after its first tick and advances by its exact
// transition over 1 ms. The run's poles are fitted: the least-squares transition of (e, e') over 50 ms has
// the eigenvalues exp(pole * 50 ms).
#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/scenario/theory_config.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// e'' + c_1 e' + c_0 e + c_i (integral of e) = d, d from push_s on.
struct TheoryLoop {
  double c_1 = 0.0;
  double c_0 = 0.0;
  double c_i = 0.0;
  double d = 0.0;
};
TheoryLoop LoopOf(const TheoryConfig& config);

// Figures of a response. A loop with an integral has no zeta and omega_n; without motion, there is only e_ss.
struct TheoryFigures {
  std::optional<double> zeta;
  std::optional<double> omega_n;
  std::optional<double> settle_time_s;  // until it stays within 2 % of its largest deviation from the end
  double e_ss = 0.0;                    // goal minus actual at the end [m]
  std::vector<std::complex<double>> poles;
};

struct TheoryResult {
  TheoryFigures run;
  TheoryFigures analytic;
  double residual_rms = 0.0;  // simulated minus analytic position [m]
  double residual_max = 0.0;
  double error_max = 0.0;  // largest |e| after the first second [m]
  bool agrees = false;
  std::string verdict;
};

struct TheorySample {
  std::int64_t stamp_ns = 0;
  double x = 0.0;
  double x_goal = 0.0;
  double x_analytic = 0.0;
};

class TheoryRun {
 public:
  explicit TheoryRun(const TheoryConfig& config);

  // Takes each step of the world, in order. Returns the joint's actual, goal and analytic positions.
  TheorySample Add(const Truth& truth);
  [[nodiscard]] TheoryResult Finish() const;

 private:
  struct State {
    double integral = 0.0;
    double e = 0.0;
    double v = 0.0;  // e'
  };
  [[nodiscard]] TheoryFigures Measure(const std::vector<State>& states) const;
  void Fit(const std::vector<State>& states, TheoryFigures& figures) const;

  TheoryConfig config_;
  TheoryLoop loop_;
  Eigen::Matrix4d transition_;  // of (integral, e, e', 1 if pushed) over one step
  std::vector<std::int64_t> stamps_ns_;
  std::vector<State> run_;
  std::vector<State> analytic_;
};

}  // namespace fovea::sim
