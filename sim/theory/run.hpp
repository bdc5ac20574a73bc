// A run of a one-joint arm beside its analytic answer: mass, damper, spring and a linear law have one.
//
// With e = goal - actual, the loop is  e'' + c_1 e' + c_0 e + c_i (integral of e) = -f / m  under a constant
// force f. The analytic response starts in the state of the run after its first tick and is stepped by its
// exact transition over 1 ms. What the run itself shows is fitted: the transition of (e, e') over 50 ms that
// explains it best has the loop's poles as logarithms of its eigenvalues.
#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/host/design/second_order.hpp"
#include "sim/scenario/commanded_motion.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

struct TheoryConfig {
  design::SecondOrder plant;
  double coulomb = 0.0;                   // friction of the plant [N]
  config::MotionLawConfig law;            // k_p[0], k_v[0] are those of pd
  std::optional<CommandedJoints> motion;  // none: the goal is 0
  double push = 0.0;                      // constant force from push_s on [N]
  double push_s = 0.0;                    // [s]
  double fit_begin_s = 0.0;
  double fit_end_s = 1e6;
};

// e'' + c_1 e' + c_0 e + c_i (integral of e) = d, d from push_s on.
struct TheoryLoop {
  double c_1 = 0.0;
  double c_0 = 0.0;
  double c_i = 0.0;
  double d = 0.0;
};
TheoryLoop LoopOf(const TheoryConfig& config);

// What a response says of its loop. No zeta and omega_n for a loop with an integral, none of anything where
// nothing moves.
struct TheoryFigures {
  std::optional<double> zeta;
  std::optional<double> omega_n;
  std::optional<double> settle_time_s;  // until it stays within 2 % of its largest departure from its end
  double e_ss = 0.0;                    // goal less actual at the end [m]
  std::vector<std::complex<double>> poles;
};

struct TheoryResult {
  TheoryFigures run;
  TheoryFigures analytic;
  double residual_rms = 0.0;  // simulated less analytic position [m]
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

  // Each step of the world, in order; returns where the joint is, shall be, and would be by theory.
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
  Eigen::Matrix4d transition_;  // of (integral, e, e', 1 when pushed) over a step
  std::vector<std::int64_t> stamps_ns_;
  std::vector<State> run_;
  std::vector<State> analytic_;
};

}  // namespace fovea::sim
