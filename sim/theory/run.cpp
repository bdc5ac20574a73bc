// SPDX-License-Identifier: Apache-2.0
#include "sim/theory/run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "firmware/core/motion_laws/motion_laws.hpp"
#include "firmware/host/design/linear_system.hpp"

namespace fovea::sim {
namespace {

constexpr std::int64_t kStartNs = hal::kTickPeriodNs;  // the servo's first tick is over
constexpr std::size_t kStride = 50;                    // steps of the fitted transition
constexpr double kSettledShare = 0.02;
constexpr std::size_t kEndSamples = 500;   // the end is the mean of the last half second
constexpr double kStill = 5e-3;            // a response below this is too small to be fitted [m]
constexpr std::size_t kOneSecond = 1000;   // in samples
constexpr double kFigureTolerance = 0.01;  // relative: zeta, omega_n, settling time, e_ss
constexpr double kPoleTolerance = 0.05;    // relative
constexpr double kErrorTolerance = 0.002;  // absolute, if the analytic error is 0 [m]

Eigen::Matrix4d TransitionOf(const TheoryLoop& loop) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A(0, 1) = 1.0;
  A(1, 2) = 1.0;
  A.row(2) << -loop.c_i, -loop.c_0, -loop.c_1, loop.d;
  Eigen::Matrix4d transition;
  for (int i = 0; i < 4; ++i) {
    transition.col(i) = design::LinearResponse(A, Eigen::Vector4d::Unit(i), hal::kTickPeriodS);
  }
  return transition;
}

// omega_n and zeta of a second-order loop, from the sum and the product of its poles. For a double pole, both
// are accurate although the single poles are not.
void SetSecondOrder(double sum, double product, TheoryFigures& figures) {
  figures.omega_n = std::sqrt(product);
  figures.zeta = -sum / (2.0 * *figures.omega_n);
}

bool Near(double value, double truth, double relative) {
  return std::fabs(value - truth) <= relative * std::fabs(truth);
}

bool Near(const std::optional<double>& value, const std::optional<double>& truth, double relative) {
  return value.has_value() == truth.has_value() && (!value || Near(*value, *truth, relative));
}

}  // namespace

TheoryLoop LoopOf(const TheoryConfig& config) {
  const design::SecondOrder& plant = config.plant;
  const config::MotionLawConfig& law = config.law;
  TheoryLoop loop;
  loop.d = -config.push / plant.mass;
  switch (motion_laws::EntryOf(law.kind).error) {
    case motion_laws::ErrorDynamics::kPlant:
      loop.c_1 = plant.damping / plant.mass;
      loop.c_0 = plant.stiffness / plant.mass;
      break;
    case motion_laws::ErrorDynamics::kSprings:
      loop.c_1 = (plant.damping + law.k_v[0]) / plant.mass;
      loop.c_0 = (plant.stiffness + law.k_p[0]) / plant.mass;
      break;
    case motion_laws::ErrorDynamics::kUnit:
      loop.c_1 = 2.0 * law.zeta * law.omega_n;
      loop.c_0 = law.omega_n * law.omega_n;
      loop.c_i = law.integral * loop.c_0;
      break;
  }
  if (std::fabs(config.push) <= config.coulomb) {
    loop.d = 0.0;  // friction holds the joint
  }
  return loop;
}

TheoryRun::TheoryRun(const TheoryConfig& config)
    : config_(config), loop_(LoopOf(config)), transition_(TransitionOf(loop_)) {}

TheorySample TheoryRun::Add(const Truth& truth) {
  const double t_s = 1e-9 * static_cast<double>(truth.stamp_ns);
  const moves::MotionCommand goal = config_.motion ? config_.motion->At(t_s) : moves::MotionCommand{};
  State now{0.0, goal.q[0] - truth.q[0], goal.dq[0] - truth.dq[0]};
  State analytic = now;
  if (truth.stamp_ns > kStartNs) {
    now.integral = run_.back().integral + 0.5 * hal::kTickPeriodS * (run_.back().e + now.e);
    const State& before = analytic_.back();
    const bool pushed = 1e-9 * static_cast<double>(stamps_ns_.back()) >= config_.push_s;
    const Eigen::Vector4d next =
        transition_ * Eigen::Vector4d(before.integral, before.e, before.v, pushed ? 1.0 : 0.0);
    analytic = {next[0], next[1], next[2]};
  }
  if (truth.stamp_ns >= kStartNs) {
    stamps_ns_.push_back(truth.stamp_ns);
    run_.push_back(now);
    analytic_.push_back(analytic);
  }
  return {truth.stamp_ns, truth.q[0], goal.q[0], goal.q[0] - analytic.e};
}

// Least squares over all pairs of states that are kStride steps apart, after the push began.
void TheoryRun::Fit(const std::vector<State>& states, TheoryFigures& figures) const {
  const bool has_integral = loop_.c_i > 0.0;
  const Eigen::Index n = has_integral ? 3 : 2;
  const double begin_s = std::max(config_.fit_begin_s, loop_.d != 0.0 ? config_.push_s : 0.0);
  std::vector<std::size_t> from;
  for (std::size_t k = 0; k + kStride < states.size(); ++k) {
    const double t_s = 1e-9 * static_cast<double>(stamps_ns_[k]);
    if (t_s >= begin_s && t_s + kStride * hal::kTickPeriodS <= config_.fit_end_s) {
      from.push_back(k);
    }
  }
  Eigen::MatrixXd before(static_cast<Eigen::Index>(from.size()), n + 1);
  Eigen::MatrixXd after(before.rows(), n);
  const auto entry = [&](const State& s, Eigen::Index i) { return i == 0 ? s.e : i == 1 ? s.v : s.integral; };
  double most = 0.0;
  for (Eigen::Index row = 0; row < before.rows(); ++row) {
    const std::size_t k = from[static_cast<std::size_t>(row)];
    for (Eigen::Index i = 0; i < n; ++i) {
      before(row, i) = entry(states[k], i);
      after(row, i) = entry(states[k + kStride], i);
    }
    before(row, n) = 1.0;  // a constant force: the push, or uncompensated friction
    most = std::max(most, std::fabs(states[k].e));
  }
  if (most < kStill || before.rows() < 10) {
    return;
  }
  const Eigen::MatrixXd fit = design::LeastSquares(before, after);
  const Eigen::MatrixXd phi = fit.topRows(n).transpose();
  const double stride_s = hal::kTickPeriodS * static_cast<double>(kStride);
  std::vector<std::complex<double>> eigenvalues;
  if (n == 2) {
    const double half = 0.5 * phi.trace();
    const std::complex<double> root = std::sqrt(std::complex<double>(half * half - phi.determinant()));
    eigenvalues = {half + root, half - root};
  } else {
    eigenvalues = design::Eigenvalues(phi);
  }
  for (const std::complex<double>& z : eigenvalues) {
    figures.poles.push_back(std::log(z) / stride_s);
  }
  std::sort(figures.poles.begin(), figures.poles.end(), [](const auto& a, const auto& b) {
    return a.real() != b.real() ? a.real() > b.real() : a.imag() > b.imag();
  });
  if (n == 2) {
    SetSecondOrder((figures.poles[0] + figures.poles[1]).real(), (figures.poles[0] * figures.poles[1]).real(),
                   figures);
  }
}

TheoryFigures TheoryRun::Measure(const std::vector<State>& states) const {
  TheoryFigures figures;
  const std::size_t tail = std::min(kEndSamples, states.size());
  for (std::size_t k = states.size() - tail; k < states.size(); ++k) {
    figures.e_ss += states[k].e / static_cast<double>(tail);
  }
  const double start_s = loop_.d != 0.0 ? config_.push_s : 0.0;
  const double end = loop_.d != 0.0 ? figures.e_ss : 0.0;
  double most = 0.0;
  std::optional<double> last_outside_s;
  for (std::size_t k = 0; k < states.size(); ++k) {
    most = std::max(most, std::fabs(states[k].e - end));
  }
  for (std::size_t k = 0; k < states.size(); ++k) {
    const double t_s = 1e-9 * static_cast<double>(stamps_ns_[k]);
    if (t_s >= start_s && std::fabs(states[k].e - end) > kSettledShare * most) {
      last_outside_s = t_s - start_s;
    }
  }
  if (most > kStill && last_outside_s &&
      *last_outside_s + start_s < 1e-9 * static_cast<double>(stamps_ns_.back())) {
    figures.settle_time_s = *last_outside_s + hal::kTickPeriodS;
  }
  return figures;
}

TheoryResult TheoryRun::Finish() const {
  TheoryResult result;
  if (run_.empty()) {
    result.verdict = "the run was too short";
    return result;
  }
  result.run = Measure(run_);
  result.analytic = Measure(analytic_);
  Fit(run_, result.run);
  const bool moves = !result.run.poles.empty();
  if (moves && loop_.c_i == 0.0) {
    SetSecondOrder(-loop_.c_1, loop_.c_0, result.analytic);
    const auto poles = design::Poles(design::SecondOrder{1.0, loop_.c_1, loop_.c_0});
    result.analytic.poles.assign(poles.begin(), poles.end());
  } else if (moves) {
    result.analytic.poles =
        design::Poles(Eigen::MatrixXd(design::IntegralLoop(loop_.c_0, loop_.c_1, loop_.c_i)));
  }
  result.analytic.e_ss = loop_.c_i > 0.0 ? 0.0 : loop_.d / loop_.c_0;

  for (std::size_t k = 0; k < run_.size(); ++k) {
    const double residual = run_[k].e - analytic_[k].e;
    result.residual_rms += residual * residual / static_cast<double>(run_.size());
    result.residual_max = std::max(result.residual_max, std::fabs(residual));
    if (k >= kOneSecond) {
      result.error_max = std::max(result.error_max, std::fabs(run_[k].e));
    }
  }
  result.residual_rms = std::sqrt(result.residual_rms);

  std::vector<std::string> differs;
  const auto check = [&](bool holds, const char* what) {
    if (!holds) {
      differs.emplace_back(what);
    }
  };
  check(Near(result.run.zeta, result.analytic.zeta, kFigureTolerance), "zeta");
  check(Near(result.run.omega_n, result.analytic.omega_n, kFigureTolerance), "omega_n");
  check(Near(result.run.settle_time_s, result.analytic.settle_time_s, kFigureTolerance), "the settling time");
  check(std::fabs(result.run.e_ss - result.analytic.e_ss) <=
            std::max(kFigureTolerance * std::fabs(result.analytic.e_ss), kErrorTolerance),
        "the steady-state error");
  bool poles_near = result.run.poles.size() == result.analytic.poles.size();
  for (std::size_t i = 0; poles_near && i < result.run.poles.size(); ++i) {
    const std::complex<double> pole = result.analytic.poles[i];
    poles_near = std::abs(result.run.poles[i] - pole) <= kPoleTolerance * std::abs(pole);
  }
  check(poles_near, "the poles");
  check(moves || result.error_max <= kErrorTolerance, "the error");
  result.agrees = differs.empty();
  result.verdict = result.agrees
                       ? fmt::format("agrees with theory: at most {:.2g} mm apart", 1e3 * result.residual_max)
                       : "differs from theory in " + fmt::format("{}", fmt::join(differs, ", "));
  return result;
}

}  // namespace fovea::sim
