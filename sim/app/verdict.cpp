#include "sim/app/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fovea::sim {
namespace {

constexpr double kTickS = static_cast<double>(hal::kTickPeriodNs) * 1e-9;
constexpr double kWindowS = 0.5;      // final_* are over this last part of a run
constexpr double kConvergedPx = 1.0;  // converged: no sample of it is further off
constexpr double kConvergedM = 0.002;
constexpr double kSettledShare = 0.02;    // settled: below this share of the first error, for good
constexpr double kLimitTolerance = 1e-9;  // rounding is no violation

double RootMeanSquare(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value * value;
  }
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace

Verdict::Verdict(const VerdictConfig& config)
    : config_(config),
      goal_px_(config.pinhole.f_px * config.p_CO_C_star.x() / config.p_CO_C_star.z(),
               config.pinhole.f_px * config.p_CO_C_star.y() / config.p_CO_C_star.z()) {}

void Verdict::Use(const char* limit, double fraction) {
  double& most = limits_[limit];
  most = std::max(most, fraction);
  violated_now_ = violated_now_ || fraction > 1.0 + kLimitTolerance;
}

void Verdict::AddTruth(const Truth& truth) {
  const Eigen::Vector3d p_CO_C = truth.X_BC.inverse() * truth.p_BO;
  Sample sample;
  sample.t_s = static_cast<double>(truth.stamp_ns) * 1e-9;
  sample.error_C = config_.p_CO_C_star - p_CO_C;
  sample.error_px = std::numeric_limits<double>::infinity();
  if (p_CO_C.z() > 0.0) {
    const Eigen::Vector2d px(config_.pinhole.f_px * p_CO_C.x() / p_CO_C.z(),
                             config_.pinhole.f_px * p_CO_C.y() / p_CO_C.z());
    sample.error_px = (px - goal_px_).norm();
  }
  samples_.push_back(sample);

  violated_now_ = false;
  for (int i = 0; i < config_.arm.num_joints; ++i) {
    const model::Joint& joint = config_.arm.joints[static_cast<std::size_t>(i)];
    const double half = 0.5 * (joint.q_max - joint.q_min);
    Use("joint_position", std::fabs(truth.q[i] - 0.5 * (joint.q_max + joint.q_min)) / half);
    Use("joint_velocity", std::fabs(truth.dq[i]) / joint.dq_max);
    Use("torque", std::fabs(truth.tau_cmd[i]) / joint.tau_max);
    if (tau_before_.size() > 0) {
      Use("torque_rate", std::fabs(truth.tau_cmd[i] - tau_before_[i]) / (joint.dtau_max * kTickS));
    }
  }
  Use("workspace", truth.X_BE.translation().norm() / config_.workspace_radius);
  violations_ += violated_now_ ? 1U : 0U;
  contact_ticks_ += truth.contacts > 0 ? 1U : 0U;
  tau_before_ = truth.tau_cmd;
}

void Verdict::AddRecord(const hal::TickRecord& record) {
  violated_now_ = false;
  for (int i = 0; i < config_.arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = config_.arm.joints[k];
    Use("joint_acceleration", std::fabs(record.ddq_cmd[k]) / joint.ddq_max);
    // Only where the reference runs on; it starts anew at every stop of the servo.
    const auto runs = [](hal::Mode mode) { return mode != hal::Mode::kBoot && mode != hal::Mode::kFault; };
    if (has_record_ && runs(before_.mode) && runs(record.mode)) {
      Use("joint_jerk", std::fabs(record.ddq_cmd[k] - before_.ddq_cmd[k]) / (joint.dddq_max * kTickS));
    }
  }
  violations_ += violated_now_ ? 1U : 0U;
  for (int i = 0; i < hal::kNumLimits; ++i) {
    const auto limit = static_cast<hal::Limit>(i);
    if ((record.limits_active & hal::Bit(limit)) != 0) {
      ++limit_ticks_[hal::Name(limit)];
    }
  }
  ever_known_ = ever_known_ || record.target_known;
  const double t_s = static_cast<double>(record.stamp_ns) * 1e-9;
  const bool is_hold = record.mode == hal::Mode::kHold;
  if (!has_record_ || record.mode != before_.mode || (is_hold && record.hold_reason != before_.hold_reason)) {
    modes_.push_back({t_s, hal::Name(record.mode), is_hold ? hal::Name(record.hold_reason) : ""});
  }
  if (record.fault != hal::Fault::kNone && (!has_record_ || before_.fault != record.fault)) {
    const std::string detail = record.fault_joint >= 0 ? fmt::format("joint {}", record.fault_joint + 1)
                                                       : std::string("no one joint");
    faults_.push_back({t_s, hal::Name(record.fault), hal::Key(record.fault), detail});
  }
  before_ = record;
  has_record_ = true;
}

std::vector<Verdict::Sample> Verdict::Last(double duration_s) const {
  const double from = samples_.back().t_s - duration_s;
  const auto first =
      std::find_if(samples_.begin(), samples_.end(), [from](const Sample& s) { return s.t_s > from; });
  return {first, samples_.end()};
}

void Verdict::Fill(Summary& summary) const {
  summary.limits = limits_;
  summary.limit_violations = violations_;
  summary.limit_ticks = limit_ticks_;
  summary.contact_ticks = contact_ticks_;
  summary.faults = faults_;
  summary.modes = modes_;
  if (samples_.empty()) {
    summary.verdict = "nothing was simulated";
    return;
  }
  if (std::isfinite(samples_.front().error_px)) {
    summary.start_error_px = samples_.front().error_px;
  }
  if (config_.target_moves) {
    FillMoving(summary);
  } else {
    FillStill(summary);
  }
  if (!summary.converged) {
    summary.verdict = WhyNot(summary);
  }
}

void Verdict::FillStill(Summary& summary) const {
  std::vector<double> px, mm, lateral, depth;
  double worst_px = 0.0;
  double worst_m = 0.0;
  for (const Sample& sample : Last(kWindowS)) {
    px.push_back(sample.error_px);
    mm.push_back(1e3 * sample.error_C.norm());
    lateral.push_back(1e3 * sample.error_C.head<2>().norm());
    depth.push_back(1e3 * sample.error_C.z());
    worst_px = std::max(worst_px, sample.error_px);
    worst_m = std::max(worst_m, sample.error_C.norm());
  }
  if (std::isfinite(worst_px)) {
    summary.final_error_px_rms = RootMeanSquare(px);
  }
  summary.final_error_mm = RootMeanSquare(mm);
  summary.final_error_lateral_mm = RootMeanSquare(lateral);
  summary.final_error_depth_mm = RootMeanSquare(depth);
  summary.converged = worst_px <= kConvergedPx && worst_m <= kConvergedM && faults_.empty();

  const double settled_px = kSettledShare * samples_.front().error_px;
  const auto last_outside = std::find_if(samples_.rbegin(), samples_.rend(),
                                         [&](const Sample& s) { return !(s.error_px <= settled_px); });
  if (last_outside != samples_.rbegin() && last_outside != samples_.rend()) {
    summary.settle_time_s = last_outside->t_s + kTickS;
  }
  if (summary.converged) {
    summary.verdict = "converged: the target stands at its goal";
  }
}

void Verdict::FillMoving(Summary& summary) const {
  std::vector<double> px;
  bool always_before_camera = true;
  for (const Sample& sample : Last(0.5 * samples_.back().t_s)) {
    px.push_back(sample.error_px);
    always_before_camera = always_before_camera && std::isfinite(sample.error_px);
  }
  if (always_before_camera) {
    summary.tracking_error_px_rms = RootMeanSquare(px);
    summary.converged = *summary.tracking_error_px_rms <= config_.tracking_bound_px && faults_.empty();
  }
  if (summary.converged) {
    summary.verdict =
        fmt::format("converged: the target is tracked within {:g} px", config_.tracking_bound_px);
  }
}

std::string Verdict::WhyNot(const Summary& summary) const {
  if (!faults_.empty()) {
    const FaultEvent& f = faults_.front();
    return fmt::format("not converged: fault {} at {:.3f} s ({}), see {}", f.name, f.t_s, f.detail, f.key);
  }
  if (!ever_known_) {
    return "not converged: the target was never found in view; the arm held still (see target.position, "
           "arm.q_start, [vision])";
  }
  if (!modes_.empty() && modes_.back().mode == hal::Name(hal::Mode::kHold)) {
    if (modes_.back().reason == hal::Name(hal::HoldReason::kGoalUnreachable)) {
      return fmt::format(
          "not converged: limits keep the arm from the goal, so it holds since {:.3f} s (see "
          "target.position, servo.goal, safety.workspace_radius)",
          modes_.back().t_s);
    }
    return fmt::format("not converged: the arm holds since {:.3f} s, reason {}", modes_.back().t_s,
                       modes_.back().reason);
  }
  if (config_.target_moves) {
    return fmt::format("not converged: tracking error {} px rms, bound {:g} px",
                       summary.tracking_error_px_rms ? fmt::format("{:.2f}", *summary.tracking_error_px_rms)
                                                     : std::string("infinite"),
                       config_.tracking_bound_px);
  }
  return fmt::format(
      "not converged: over the last {:g} s the target was not within {:g} px and {:g} mm of its goal",
      kWindowS, kConvergedPx, 1e3 * kConvergedM);
}

}  // namespace fovea::sim
