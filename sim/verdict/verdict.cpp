// SPDX-License-Identifier: Apache-2.0
#include "sim/verdict/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

#include "firmware/host/run/in_words.hpp"

namespace fovea::sim {
namespace {

constexpr std::int64_t kWindowNs = hal::kNsPerSecond / 2;  // final_* are over this last part of a run
constexpr double kConvergedPx = 1.0;                       // largest error of a converged run in this part
constexpr double kConvergedM = 0.002;
constexpr double kConvergedDeg = 0.5;  // for a goal with an orientation
constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kHomeBound = 1e-3;     // largest joint error at home [rad]
constexpr double kAtRest = 0.01;        // a joint below this speed is at rest [rad/s, m/s]
constexpr double kSettledShare = 0.02;  // settled: stays below this share of the first error

}  // namespace

Verdict::Verdict(const VerdictConfig& config)
    : config_(config),
      barriers_(config.barriers),
      unwanted_(config.stop),
      notices_(config.faults),
      acting_(config.barriers.obstacles) {}

void Verdict::AddTruth(const Truth& truth, hal::Mode mode) {
  if (config_.has_eye) {
    const TargetError error = ErrorOf(truth, config_.eye, config_.goal);
    camera_path_.Add(truth.X_BC.translation());
    AddSample({truth.stamp_ns, error.error_px, error.error_C, error.judged_m, error.error_rad.value_or(0.0)});
  }

  const double t_s = last_s_ = 1e-9 * static_cast<double>(truth.stamp_ns);
  const bool rests = truth.dq.cwiseAbs().maxCoeff() < kAtRest;
  at_rest_since_s_ = rests ? std::optional(at_rest_since_s_.value_or(t_s)) : std::nullopt;
  if (config_.circle && t_s >= config_.circle->lead_s) {
    const std::array<double, 3> p = config_.circle->At(t_s).p_BE;
    const double off = (truth.X_BE.translation() - Eigen::Vector3d(p[0], p[1], p[2])).norm();
    path2_ += off * off;
    path_most_ = std::max(path_most_, off);
    ++path_samples_;
    NoteGoal(t_s, 1e3 * off <= config_.path_bound_mm);
  }
  const model::ArmModel& arm = config_.barriers.arm;
  home_error_ = (truth.q - model::ToVector(arm.q_ready, arm.num_joints)).cwiseAbs().maxCoeff();
  if (config_.goes_home) {
    NoteGoal(t_s, home_error_ <= kHomeBound);
  }
  barriers_.Add(truth, mode);
  unwanted_.Add(truth, mode);
  contacts_.Add(truth.contacts);
}

// A still target's errors in the picture [px], in space [m] and of the orientation [deg].
bool Verdict::IsAtGoal(double px, double m, double deg) const {
  return px <= kConvergedPx && (!config_.eye.judges_metres || (m <= kConvergedM && deg <= kConvergedDeg));
}

void Verdict::AddSample(const Sample& sample) {
  if (!first_px_) {
    first_px_ = sample.error_px;
  }
  most_px_ = std::max(most_px_, sample.error_px);
  window_.push_back(sample);
  while (window_.front().stamp_ns <= sample.stamp_ns - kWindowNs) {
    window_.pop_front();
  }
  const double t_s = static_cast<double>(sample.stamp_ns) * 1e-9;
  is_outside_ = !(sample.error_px <= kSettledShare * *first_px_);
  if (is_outside_) {
    last_outside_s_ = t_s;
  }
  NoteGoal(t_s, config_.target_moves
                    ? WindowPx() <= config_.tracking_bound_px
                    : IsAtGoal(sample.error_px, sample.judged_m, kDegPerRad * sample.error_rad));
  if (t_s > 0.5 * config_.duration_s) {
    second_half_px2_ += sample.error_px * sample.error_px;
    second_half_m2_ += sample.error_C.squaredNorm();
    second_half_judged_m2_ += sample.judged_m * sample.judged_m;
    ++second_half_samples_;
  }
}

// Image error, rms over the window. For a moving target, the bound applies to the rms, as in the verdict.
double Verdict::WindowPx() const {
  double px2 = 0.0;
  for (const Sample& sample : window_) {
    px2 += sample.error_px * sample.error_px;
  }
  return std::sqrt(px2 / static_cast<double>(window_.size()));
}

void Verdict::NoteGoal(double t_s, bool kept) {
  goal_kept_since_s_ = kept ? std::optional(goal_kept_since_s_.value_or(t_s)) : std::nullopt;
}

void Verdict::AddRecord(const hal::TickRecord& record) {
  notices_.Add(record);
  for (int i = 0; i < config_.barriers.arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = config_.barriers.arm.joints[k];
    reference_.Note(record.stamp_ns, reference_ddq_, record.ddq_cmd[k] / joint.ddq_max);
    // Only while the reference continues: it restarts after Boot and Fault.
    const auto runs = [](hal::Mode mode) { return mode != hal::Mode::kBoot && mode != hal::Mode::kFault; };
    if (has_record_ && runs(before_.mode) && runs(record.mode)) {
      reference_.Note(record.stamp_ns, reference_jerk_,
                      (record.ddq_cmd[k] - before_.ddq_cmd[k]) / (joint.dddq_max * hal::kTickPeriodS));
    }
  }
  acting_.Add(record);
  for (int i = 0; i < hal::kNumLimits; ++i) {
    const auto limit = static_cast<hal::Limit>(i);
    if ((record.limits_active & hal::Bit(limit)) != 0) {
      ++limit_ticks_[hal::Name(limit)];
    }
  }
  if (record.intake != hal::Intake::kNone) {
    ++measurements_[hal::Name(record.intake)];
  }
  ever_known_ = ever_known_ || record.target_known;
  const double t_s = static_cast<double>(record.stamp_ns) * 1e-9;
  const bool is_hold = record.mode == hal::Mode::kHold;
  if (!has_record_ || record.mode != before_.mode || (is_hold && record.hold_reason != before_.hold_reason)) {
    modes_.push_back({t_s, hal::Name(record.mode), is_hold ? hal::Name(record.hold_reason) : ""});
  }
  if (record.fault != hal::Fault::kNone && (!has_record_ || before_.fault != record.fault)) {
    faults_.push_back({t_s, record.fault, record.fault_joint});
  }
  before_ = record;
  has_record_ = true;
}

void Verdict::Fill(Summary& summary) const {
  barriers_.book().AddTo(summary);
  reference_.AddTo(summary);
  const std::vector<std::int64_t>& by_truth_ns = barriers_.book().passed_ns();
  std::vector<std::int64_t> passed_ns;
  std::set_union(by_truth_ns.begin(), by_truth_ns.end(), reference_.passed_ns().begin(),
                 reference_.passed_ns().end(), std::back_inserter(passed_ns));
  summary.limit_violations = passed_ns.size();
  summary.limit_ticks = limit_ticks_;
  summary.measurements = measurements_;
  summary.contact_ticks = contacts_.any();
  summary.contacts = contacts_.by_what();
  summary.unwanted_motion = unwanted_.by_mode();
  summary.faults = faults_;
  summary.modes = modes_;
  FillEnd(summary);
  if (window_.empty() || config_.has_motion) {
    FillMotion(summary);
    return;
  }
  if (std::isfinite(*first_px_)) {
    summary.start_error_px = *first_px_;
  }
  if (config_.target_moves) {
    FillMoving(summary);
  } else {
    FillStill(summary);
  }
  if (summary.converged && contacts_.any() > 0) {
    summary.converged = false;
    summary.verdict = Touched(summary);
  } else if (!summary.converged) {
    summary.verdict = WhyNot(summary);
  } else if (summary.limit_violations > 0) {
    summary.verdict =
        fmt::format("converged, but a limit was exceeded in {} ticks", summary.limit_violations);
  }
}

void Verdict::FillEnd(Summary& summary) const {
  summary.injected = notices_.Faults();
  if (!modes_.empty()) {
    summary.end.mode = modes_.back().mode;
    summary.end.reason = modes_.back().reason;
  }
  summary.end.brakes = before_.command.engage_brakes;
  summary.end.at_rest_since_s = at_rest_since_s_;
  summary.end.goal_kept_since_s = goal_kept_since_s_;
}

// Verdict of a run without a target, or beside it: whether the commanded motion was followed.
void Verdict::FillMotion(Summary& summary) const {
  if (path_samples_ > 0) {
    summary.path_error_mm_rms = 1e3 * std::sqrt(path2_ / static_cast<double>(path_samples_));
    summary.path_error_mm_max = 1e3 * path_most_;
  }
  if (config_.goes_home) {
    summary.home_error_rad = home_error_;
  }
  const std::string why_not = WhyNotFollowed(summary);
  summary.converged = why_not.empty();
  summary.verdict = !why_not.empty()     ? why_not
                    : config_.has_motion ? "the commanded motion was followed"
                                         : "no motion was commanded, and the arm stood still";
}

// "" if the motion was followed.
std::string Verdict::WhyNotFollowed(const Summary& summary) const {
  const auto was_held_for = [this](hal::HoldReason reason) {
    return std::any_of(modes_.begin(), modes_.end(),
                       [reason](const ModeEvent& event) { return event.reason == hal::Name(reason); });
  };
  if (!faults_.empty()) {
    return "a fault stopped the arm: " + run::InWords(faults_.front());
  }
  if (contacts_.any() > 0) {
    return Touched(summary);
  }
  if (was_held_for(hal::HoldReason::kMotionRefused)) {
    return "the commanded motion was refused (see modes and limits)";
  }
  if (was_held_for(hal::HoldReason::kNotFollowed)) {
    return "the arm did not follow the commanded motion, which was stopped (see safety.motion_error)";
  }
  if (config_.circle && path_samples_ == 0) {
    return "the run ended before the circle began (see run.duration_s, motion.lead_s)";
  }
  if (summary.limit_violations > 0) {
    return "a limit was exceeded";
  }
  if (config_.circle && 1e3 * path_most_ > config_.path_bound_mm) {
    return fmt::format("the end effector's path error was {:.2g} mm; motion.bound_mm allows {}",
                       1e3 * path_most_, config_.path_bound_mm);
  }
  if (config_.goes_home && home_error_ > kHomeBound) {
    return fmt::format("a joint is {:.2g} rad from the ready posture at the end", home_error_);
  }
  return "";
}

void Verdict::FillStill(Summary& summary) const {
  double px2 = 0.0;
  double lateral2 = 0.0;
  double depth2 = 0.0;
  double worst_px = 0.0;
  double worst_m = 0.0;
  double turn2 = 0.0;
  double worst_deg = 0.0;
  for (const Sample& sample : window_) {
    px2 += sample.error_px * sample.error_px;
    lateral2 += sample.error_C.head<2>().squaredNorm();
    depth2 += sample.error_C.z() * sample.error_C.z();
    worst_px = std::max(worst_px, sample.error_px);
    worst_m = std::max(worst_m, sample.judged_m);
    turn2 += sample.error_rad * sample.error_rad;
    worst_deg = std::max(worst_deg, kDegPerRad * sample.error_rad);
  }
  const auto n = static_cast<double>(window_.size());
  summary.camera_path_m = camera_path_.Length();
  summary.camera_excursion_m = camera_path_.Excursion();
  if (std::isfinite(most_px_)) {
    summary.error_px_max = most_px_;
  }
  if (std::isfinite(worst_px)) {
    summary.final_error_px_rms = std::sqrt(px2 / n);
  }
  summary.final_error_mm = 1e3 * std::sqrt((lateral2 + depth2) / n);
  summary.final_error_lateral_mm = 1e3 * std::sqrt(lateral2 / n);
  summary.final_error_depth_mm = 1e3 * std::sqrt(depth2 / n);
  if (config_.goal.R_CO_star) {
    summary.final_error_deg = kDegPerRad * std::sqrt(turn2 / n);
  }
  summary.converged = IsAtGoal(worst_px, worst_m, worst_deg) && faults_.empty();
  if (!is_outside_ && last_outside_s_) {
    summary.settle_time_s = *last_outside_s_ + hal::kTickPeriodS;
  }
  if (summary.converged) {
    summary.verdict = config_.eye.MovesGoal() || !config_.eye.judges_metres
                          ? "converged: the target stands at its goal in the picture"
                          : "converged: the target stands at its goal";
  }
}

void Verdict::FillMoving(Summary& summary) const {
  if (second_half_samples_ > 0 && std::isfinite(second_half_px2_)) {
    const auto n = static_cast<double>(second_half_samples_);
    summary.tracking_error_px_rms = std::sqrt(second_half_px2_ / n);
    summary.tracking_error_mm_rms = 1e3 * std::sqrt(second_half_m2_ / n);
    summary.converged = *summary.tracking_error_px_rms <= config_.tracking_bound_px &&
                        (!config_.eye.judges_metres ||
                         1e3 * std::sqrt(second_half_judged_m2_ / n) <= config_.tracking_bound_mm) &&
                        faults_.empty();
  }
  if (summary.converged) {
    summary.verdict = fmt::format(
        "converged: the target is tracked within {:g} px{}", config_.tracking_bound_px,
        config_.eye.judges_metres ? fmt::format(" and {:g} mm", config_.tracking_bound_mm) : std::string());
  }
}

std::string Verdict::Touched(const Summary& summary) {
  const ContactTicks& c = summary.contacts;
  return fmt::format("not converged: the arm touched {} in {} ticks",
                     c.bench > 0    ? "the bench"
                     : c.target > 0 ? "the target"
                                    : "itself",
                     summary.contact_ticks);
}

std::string Verdict::WhyNot(const Summary& summary) const {
  if (!faults_.empty()) {
    return "not converged: fault: " + run::InWords(faults_.front());
  }
  if (!ever_known_) {
    return WhyNeverAccepted(summary);
  }
  if (!modes_.empty() && modes_.back().mode == hal::Name(hal::Mode::kHold)) {
    return WhyHeld() + acting_.InWords();
  }
  if (config_.target_moves) {
    const auto figure = [](const std::optional<double>& error) {
      return error ? fmt::format("{:.2f}", *error) : std::string("infinite");
    };
    return fmt::format("not converged: tracking error {} px rms, bound {:g} px{}{}",
                       figure(summary.tracking_error_px_rms), config_.tracking_bound_px,
                       config_.eye.judges_metres
                           ? fmt::format(", and {} mm rms, bound {:g} mm",
                                         figure(summary.tracking_error_mm_rms), config_.tracking_bound_mm)
                           : std::string(),
                       acting_.InWords());
  }
  return fmt::format(
      "not converged: over the last {:g} s the target was not within {:g} px{}{} of its goal{}",
      1e-9 * static_cast<double>(kWindowNs), kConvergedPx,
      config_.eye.judges_metres ? fmt::format(" and {:g} mm", 1e3 * kConvergedM) : std::string(),
      config_.eye.judges_metres && config_.goal.R_CO_star ? fmt::format(" and {:g} deg", kConvergedDeg)
                                                          : std::string(),
      acting_.InWords());
}

std::string Verdict::WhyNeverAccepted(const Summary& summary) const {
  if (summary.frames == 0 && summary.frames_lost > 0) {
    return fmt::format("not converged: all {} frames were lost; the arm held still (see [faults])",
                       summary.frames_lost);
  }
  if (summary.frames_detected == 0) {
    return "not converged: the target was never found in view; the arm held still (see target.position, "
           "arm.q_start, [vision])";
  }
  const auto future = measurements_.find(hal::Name(hal::Intake::kFromFuture));
  if (future != measurements_.end()) {
    return fmt::format(
        "not converged: {} of {} measurements had stamps from the future and were rejected (see "
        "camera.latency_ms, the camera's clock)",
        future->second, summary.frames);
  }
  return fmt::format(
      "not converged: the target was found in {} frames, too few to accept it (see run.duration_s, "
      "servo.accepted_min)",
      summary.frames_detected);
}

// Of a run that ended in Hold.
std::string Verdict::WhyHeld() const {
  const std::string keys = before_.hold_reason == hal::HoldReason::kEyeDoubted
                               ? "; see camera.mount_xyz, camera.mount_rpy_deg, servo.way_in_vain"
                           : before_.hold_reason == hal::HoldReason::kGoalUnreachable
                               ? "; see " + acting_.KeysOfReach()
                               : "";
  return fmt::format("not converged: the arm has held since {:.3f} s because {}{}", modes_.back().t_s,
                     run::InWords(before_.hold_reason), keys);
}

}  // namespace fovea::sim
