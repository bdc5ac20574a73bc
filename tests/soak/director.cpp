// SPDX-License-Identifier: Apache-2.0
#include "tests/soak/director.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "firmware/core/model/kinematics.hpp"

namespace fovea::soak {
namespace {

using hal::Mode;

constexpr int kEpisodeMs = 10'000;
constexpr int kLongestMs = 30'000;   // longest episode
constexpr int kMeasuredMs = 500;     // measured at the end of each kEpisodeMs
constexpr int kEachMs = 10;          // measuring period
constexpr double kTherePx = 1.0;     // bound for a still target
constexpr double kFollowedPx = 5.0;  // bound for a moving target, on the mean
constexpr double kMarginPx = 30.0;   // around the outline of a new target
constexpr int kDraws = 300;
constexpr int kRestMs = 1500;     // from a fault to the first reset
constexpr double kAtRest = 0.01;  // [rad/s]
constexpr std::uint64_t kHeavyJoints = 4;
constexpr int kHomeMs = 15'000;
constexpr std::size_t kMostComplaints = 10;
constexpr double kDeg = 3.14159265358979323846 / 180.0;

int Ms(std::int64_t ns) { return static_cast<int>(ns / hal::kNsPerMs); }

bool IsTracking(Mode mode) { return mode == Mode::kTrack || mode == Mode::kCoast; }

}  // namespace

Director::Director(const sim::RunDescription& about, std::int64_t end_ns, std::uint64_t seed)
    : about_(about),
      goal_(sim::GoalOf(about.servo.feature)),
      R_BO_still_(about.scene.target_R_BO),
      end_ns_(end_ns),
      engine_(seed),
      pull_(Eigen::VectorXd::Zero(about.servo.arm.num_joints)) {
  complaints_.reserve(kMostComplaints);
}

double Director::Uniform(double low, double high) {
  return low + (high - low) * static_cast<double>(engine_() >> 11U) * 0x1p-53;
}

task::Request Director::TakeRequest() {
  const task::Request request = request_;
  request_ = task::Request::kNone;
  return request;
}

moves::MotionCommand Director::At(std::int64_t /*now_ns*/) noexcept {
  moves::MotionCommand command;
  if (goes_home_ && home_begun_) {
    command.kind = moves::MotionKind::kHome;
  }
  return command;
}

void Director::Complain(std::int64_t now_ns, const std::string& what) {
  ++num_complaints_;
  if (complaints_.size() < kMostComplaints) {
    complaints_.push_back(fmt::format("{:.3f} s ({}): {}", static_cast<double>(now_ns) * 1e-9,
                                      kTroubleNames[static_cast<std::size_t>(trouble_)], what));
  }
}

bool Director::IsInPicture(const sim::Truth& truth, const Eigen::Vector3d& p_BO) const {
  const features::TargetOutline outline = about_.servo.feature.Outline();
  const Eigen::Isometry3d X_CB = truth.X_BC.inverse();
  for (int i = 0; i < outline.num_points; ++i) {
    const Eigen::Vector3d p_C = X_CB * (p_BO + target_.R_BO * outline.p_OP[static_cast<std::size_t>(i)]);
    if (!(p_C.z() > 0.2) || p_C.z() > 0.9) {
      return false;
    }
    const double margin = kMarginPx + about_.pinhole.f_px * outline.radius / p_C.z();
    const double u = about_.pinhole.U(p_C);
    const double v = about_.pinhole.V(p_C);
    if (u < margin || v < margin || u > about_.pinhole.width_px - 1 - margin ||
        v > about_.pinhole.height_px - 1 - margin) {
      return false;
    }
  }
  return true;
}

// Draws a target that the camera sees from its present pose. False after kDraws tries.
bool Director::DrawTarget(const sim::Truth& truth) {
  target_ = sim::TargetMotion{};
  for (int i = 0; i < kDraws; ++i) {
    target_.p_BO = {Uniform(0.40, 0.62), Uniform(-0.25, 0.25), Uniform(0.04, 0.15)};
    const double heading = Uniform(0.0, 360.0) * kDeg;
    const Eigen::Vector3d about(std::cos(heading), std::sin(heading), 0.0);
    target_.R_BO = Eigen::AngleAxisd(Uniform(0.0, 15.0) * kDeg, about) * R_BO_still_ *
                   Eigen::AngleAxisd(Uniform(-40.0, 40.0) * kDeg, Eigen::Vector3d::UnitZ());
    if (IsInPicture(truth, target_.p_BO)) {
      if (Uniform(0.0, 1.0) < 0.2) {
        target_.kind = Uniform(0.0, 1.0) < 0.5 ? sim::MotionKind::kCircle : sim::MotionKind::kEight;
        target_.reach = Uniform(0.02, 0.06);
        target_.speed = Uniform(0.01, 0.05);
        target_.direction = Eigen::Vector3d::UnitY();
        // The motion starts at the drawn position.
        target_.p_BO -= sim::PositionAt(target_, 0) - target_.p_BO;
      }
      return true;
    }
  }
  return false;
}

void Director::Begin(std::int64_t now_ns, const sim::Truth& truth) {
  begun_ = DrawTarget(truth);
  if (!begun_) {
    if (home_ns_ != 0 && now_ns - home_ns_ < hal::kNsPerSecond) {
      Complain(now_ns, "no target is visible from the ready posture");
    }
    goes_home_ = true;
    home_begun_ = false;
    home_ns_ = now_ns;
    return;
  }
  episode_ns_ = now_ns;
  trouble_ = Trouble::kNone;
  if (Uniform(0.0, 1.0) < 0.6) {
    trouble_ = static_cast<Trouble>(1 + engine_() % (kTroubleNames.size() - 1));
  }
  trouble_ms_ = static_cast<int>(Uniform(500.0, 3500.0));
  // One of the heavy joints: a push that they tolerate would throw a light wrist joint off its path.
  acting_.joint = static_cast<int>(engine_() % kHeavyJoints);
  strength_ = Uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0;
  ++troubles_[static_cast<std::size_t>(trouble_)];
  request_ = task::Request::kTrack;
  error_px_ = speed2_ = torque2_ = Spread{};
}

// Applies the disturbance at `ms` of the episode.
void Director::LetTrouble(int ms) {
  const int end_ms = trouble_ms_ + LengthOf(trouble_);
  const bool now = ms >= trouble_ms_ && ms < end_ms;
  acting_.trouble = now ? trouble_ : Trouble::kNone;
  pull_.setZero();
  if (now && (trouble_ == Trouble::kPush || trouble_ == Trouble::kShove)) {
    const double tau_max = about_.servo.arm.joints[static_cast<std::size_t>(acting_.joint)].tau_max;
    const double share = trouble_ == Trouble::kPush ? 0.08 : 2.0;
    pull_[acting_.joint] = strength_ * share * about_.servo.safety.contact_torque_fraction * tau_max;
  }
  if (ms == trouble_ms_) {
    if (trouble_ == Trouble::kStall) {
      acting_.stall_ticks = about_.servo.safety.missed_ticks / 2;
    } else if (trouble_ == Trouble::kLongStall) {
      acting_.stall_ticks = 2 * about_.servo.safety.missed_ticks;
    } else if (trouble_ == Trouble::kHoldAsked) {
      request_ = task::Request::kHold;
    }
  }
  if (ms == end_ms && trouble_ == Trouble::kHoldAsked) {
    request_ = task::Request::kTrack;
  }
}

void Director::Recover(std::int64_t now_ns, const sim::Truth& truth, const hal::TickRecord& record) {
  if (mode_before_ != Mode::kFault) {
    fault_ns_ = now_ns;
    ++faults_[hal::Name(record.fault)];
    if (!MayLeadTo(trouble_, record.fault)) {
      Complain(now_ns, fmt::format("fault {} of joint {}", hal::Name(record.fault), record.fault_joint + 1));
    }
  }
  const int since_ms = Ms(now_ns - fault_ns_);
  const bool rests = truth.dq.lpNorm<Eigen::Infinity>() < kAtRest;
  if (acting_.trouble == Trouble::kNone && since_ms >= kRestMs && rests && since_ms % 100 == 0) {
    request_ = task::Request::kReset;
  }
}

void Director::GoHome(std::int64_t now_ns, const sim::Truth& truth, const hal::TickRecord& record) {
  if (!home_begun_) {
    request_ = task::Request::kHold;
    home_begun_ = record.mode == Mode::kHold && record.hold_reason == hal::HoldReason::kNotAsked;
    ways_home_ += home_begun_ ? 1U : 0U;
    if (home_begun_) {
      request_ = task::Request::kNone;
    }
  }
  const bool done = home_begun_ && record.mode == Mode::kHold &&
                    (record.hold_reason == hal::HoldReason::kMotionDone ||
                     record.hold_reason == hal::HoldReason::kMotionRefused);
  if (!done && Ms(now_ns - home_ns_) < kHomeMs) {
    return;
  }
  if (!done) {
    Complain(now_ns, "the motion home does not end");
  } else if (record.hold_reason == hal::HoldReason::kMotionRefused) {
    ++ways_refused_;  // goes on from the present posture
  }
  goes_home_ = false;
  home_ns_ = now_ns;
  Begin(now_ns, truth);
}

void Director::Measure(std::int64_t now_ns, const sim::Truth& truth, const hal::TickRecord& record,
                       const task::ServoState& state) {
  sim::Truth seen;
  seen.X_BC = truth.X_BC;
  seen.p_BO = TargetAt(now_ns);
  seen.R_BO = target_.R_BO;
  error_px_.Add(sim::ErrorOf(seen, sim::JudgedEyeOf(about_), goal_).error_px);
  const int n = about_.servo.arm.num_joints;
  speed2_.Add(truth.dq.squaredNorm() / n);
  torque2_.Add(model::ToVector(record.command.tau_cmd, n).squaredNorm() / n);
  const estimate::PredictState& predict = state.predict;
  covariance_ = about_.servo.feature.SeesOrientation()
                    ? predict.hypotheses.plate.best().filter.P.topLeftCorner<3, 3>().trace()
                    : predict.filter.P[0][0].trace();
}

void Director::End(std::int64_t now_ns, const sim::Truth& truth, const hal::TickRecord& record) {
  const bool moves = target_.kind != sim::MotionKind::kStill;
  Ending ending = Ending::kUndefined;
  if (IsTracking(record.mode) && error_px_.mean < (moves ? kFollowedPx : kTherePx)) {
    ending = moves ? Ending::kFollowed : Ending::kConverged;
  } else if (record.mode == Mode::kHold && record.hold_reason != hal::HoldReason::kNotAsked) {
    ending = Ending::kHeld;
  } else if (Ms(now_ns - episode_ns_) < kLongestMs) {
    error_px_ = speed2_ = torque2_ = Spread{};
    return;  // the episode may take longer
  }
  ++endings_[static_cast<std::size_t>(ending)];
  if (ending == Ending::kUndefined) {
    Complain(now_ns, fmt::format("the episode ends in mode {}, {:.2f} px off", hal::Name(record.mode),
                                 error_px_.mean));
  }
  if (ending == Ending::kConverged && trouble_ == Trouble::kNone) {
    const double share = static_cast<double>(now_ns) / static_cast<double>(end_ns_);
    const auto tenth = static_cast<std::size_t>(std::clamp(static_cast<int>(10.0 * share), 0, 9));
    figures_.error_px[tenth].Add(error_px_.mean);
    figures_.speed[tenth].Add(std::sqrt(speed2_.mean));
    figures_.torque[tenth].Add(std::sqrt(torque2_.mean));
    figures_.covariance[tenth].Add(covariance_);
    figures_.posture[tenth].Add(
        (truth.q - model::ToVector(about_.servo.arm.q_ready, about_.servo.arm.num_joints)).norm());
  }
  if (ending == Ending::kHeld || ending == Ending::kUndefined) {
    goes_home_ = true;
    home_begun_ = false;
    home_ns_ = now_ns;
    begun_ = false;
    return;
  }
  Begin(now_ns, truth);
}

void Director::Step(std::int64_t now_ns, const sim::Truth& truth, const hal::TickRecord& record,
                    const task::ServoState& state) {
  if (!begun_ && !goes_home_) {
    Begin(now_ns, truth);
  }
  if (record.mode == Mode::kFault) {
    Recover(now_ns, truth, record);
  } else if (mode_before_ == Mode::kFault) {
    ++recoveries_;
    asks_again_ = !goes_home_;
  }
  mode_before_ = record.mode;
  if (asks_again_ && record.mode == Mode::kHold) {  // a fault cancels all requests
    asks_again_ = false;
    request_ = task::Request::kTrack;
  }
  if (goes_home_) {
    acting_.trouble = Trouble::kNone;
    pull_.setZero();
    if (record.mode != Mode::kFault) {
      GoHome(now_ns, truth, record);
    }
    return;
  }
  const int ms = Ms(now_ns - episode_ns_);
  LetTrouble(ms);
  const int of_round = ms % kEpisodeMs;
  if (of_round >= kEpisodeMs - kMeasuredMs && of_round % kEachMs == 0) {
    Measure(now_ns, truth, record, state);
  }
  if (ms > 0 && of_round == 0) {
    End(now_ns, truth, record);
  }
}

}  // namespace fovea::soak
