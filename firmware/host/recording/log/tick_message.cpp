// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/log/tick_message.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/config/tuning.hpp"
#include "firmware/core/features/target_traits.hpp"
#include "firmware/core/trajectory/plan.hpp"
#include "fovea/tick.pb.h"

namespace fovea::log {
namespace {

using Doubles = google::protobuf::RepeatedField<double>;

template <std::size_t N>
void Put(const std::array<double, N>& values, int count, Doubles& to) {
  to.Clear();
  to.Add(values.begin(), values.begin() + count);
}

template <std::size_t N>
void Get(const Doubles& from, std::array<double, N>& values) {
  if (static_cast<std::size_t>(from.size()) > N) {
    throw std::runtime_error("the log holds more entries than the servo has");
  }
  std::copy(from.begin(), from.end(), values.begin());
}

template <typename To, typename From>
To Same(From value) {
  return static_cast<To>(static_cast<int>(value));
}

// The message's enumerations have the numbers of the servo's.
static_assert(static_cast<int>(hal::Mode::kMove) == MOVE);
static_assert(static_cast<int>(hal::HoldReason::kNotFollowed) == NOT_FOLLOWED);
static_assert(static_cast<int>(hal::Fault::kContact) == CONTACT && hal::kNumFaults == 11);
static_assert(features::kTargets.size() == Feature::Kind_ARRAYSIZE);
static_assert(static_cast<int>(hal::Intake::kOutlier) == OUTLIER && hal::kNumIntakes == 9);
static_assert(static_cast<int>(hal::TuningResult::kInconsistent) == Tuning::INCONSISTENT &&
              hal::kNumTuningResults == Tuning::Result_ARRAYSIZE);

static_assert(static_cast<int>(hal::Way::kPlan) == Way::PLAN && hal::kNumWays == Way::Kind_ARRAYSIZE);
static_assert(static_cast<int>(hal::PlanEvent::kDone) == Way::DONE &&
              hal::kNumPlanEvents == Way::Event_ARRAYSIZE);

void PutTuning(const hal::TuningNote& note, Tuning& m) {
  m.set_result(Same<Tuning::Result>(note.result));
  m.set_number(note.key);
  m.set_before(note.before);
  m.set_asked(note.asked);
  const auto defaults = std::make_unique<config::ServoConfig>();
  config::EachTunable(*defaults, [&](const config::Field& field, double, double, double) {
    if (field.in_motion == note.key) {
      m.set_key(field.key);
      m.set_unit(field.unit);
    }
  });
}

void PutWay(const hal::WayNote& note, Way& m) {
  m.set_kind(Same<Way::Kind>(note.way));
  m.set_event(Same<Way::Event>(note.event));
  m.set_plans_asked(note.plans_asked);
  m.set_tries(note.tries);
  m.set_outcome(note.outcome);
  Put(note.normal_B, 3, *m.mutable_normal_b());
}

hal::WayNote WayOf(const Way& m) {
  hal::WayNote note;
  note.way = Same<hal::Way>(m.kind());
  note.event = Same<hal::PlanEvent>(m.event());
  note.plans_asked = m.plans_asked();
  note.tries = m.tries();
  note.outcome = m.outcome();
  Get(m.normal_b(), note.normal_B);
  return note;
}

}  // namespace

void ToMessage(const hal::TickRecord& r, Tick& m) {
  m.set_tick(r.tick);
  m.set_stamp_ns(r.stamp_ns);
  m.set_missed_ticks(r.missed_ticks);
  ArmState& arm = *m.mutable_arm();
  arm.set_stamp_ns(r.arm.stamp_ns);
  arm.set_sequence(r.arm.sequence);
  const int joints = r.arm.num_joints;
  Put(r.arm.q, joints, *arm.mutable_q());
  Put(r.arm.dq, joints, *arm.mutable_dq());
  Put(r.arm.tau_meas, joints, *arm.mutable_tau_meas());
  Put(r.arm.tau_applied, joints, *arm.mutable_tau_applied());
  m.set_has_feature(r.has_feature);
  m.set_intake(Same<Intake>(r.intake));
  m.clear_tuning();
  if (r.tuning.result != hal::TuningResult::kNone) {
    PutTuning(r.tuning, *m.mutable_tuning());
  }
  m.set_mode(Same<Mode>(r.mode));
  m.set_hold_reason(Same<HoldReason>(r.hold_reason));
  m.set_fault(Same<FaultCause>(r.fault));
  m.set_fault_joint(r.fault_joint);
  m.set_limits_active(r.limits_active);
  m.set_target_known(r.target_known);
  m.set_feature_age_ns(r.feature_age_ns);
  Put(r.p_BO, 3, *m.mutable_p_bo());
  Put(r.q_BO, 4, *m.mutable_q_bo());
  Put(r.v_BO, 3, *m.mutable_v_bo());
  m.set_stamp_late_s(r.stamp_late_s);
  m.set_stamp_late_sigma_s(r.stamp_late_sigma_s);
  Put(r.s, r.dim, *m.mutable_s());
  Put(r.s_star, r.dim, *m.mutable_s_star());
  Put(r.e, r.dim, *m.mutable_e());
  Put(r.V_BC_C_cmd, 6, *m.mutable_v_bc_c_cmd());
  PutWay(r.way, *m.mutable_way());
  const int commanded = r.command.num_joints;
  Put(r.q_cmd, commanded, *m.mutable_q_cmd());
  Put(r.dq_cmd, commanded, *m.mutable_dq_cmd());
  Put(r.ddq_cmd, commanded, *m.mutable_ddq_cmd());
  Put(r.tau_ext, commanded, *m.mutable_tau_ext());
  ArmCommand& command = *m.mutable_command();
  command.set_state_sequence(r.command.state_sequence);
  Put(r.command.tau_cmd, commanded, *command.mutable_tau());
  command.set_engage_brakes(r.command.engage_brakes);
}

void ToMessage(const ReplayData& data, Tick& m) {
  m.set_demand(data.demand.data(), data.demand_size);
  m.clear_state_digest();
  if (data.state_digest) {
    m.set_state_digest(*data.state_digest);
  }
}

void ToMessage(const hal::FeatureMeasurement& f, Feature& m) {
  m.set_stamp_ns(f.stamp_ns);
  m.set_sequence(f.sequence);
  m.set_same_for_ns(f.same_for_ns);
  m.set_kind(Same<Feature::Kind>(f.kind));
  m.set_found(f.found);
  m.set_confidence(f.confidence);
  Put(f.s, f.dim, *m.mutable_s());
  m.clear_cov_s();
  for (std::size_t row = 0; row < static_cast<std::size_t>(f.dim); ++row) {
    for (std::size_t col = 0; col < static_cast<std::size_t>(f.dim); ++col) {
      m.add_cov_s(f.cov_s[row * hal::kMaxFeatureDim + col]);
    }
  }
  m.clear_poses();
  for (std::size_t i = 0; i < static_cast<std::size_t>(f.num_poses); ++i) {
    FlatPose& pose = *m.add_poses();
    Put(f.poses[i].p_CO_C, 3, *pose.mutable_p_co_c());
    Put(f.poses[i].q_CO, 4, *pose.mutable_q_co());
    pose.set_first(f.poses[i].first);
  }
}

hal::FeatureMeasurement FromMessage(const Feature& m) {
  hal::FeatureMeasurement f;
  f.stamp_ns = m.stamp_ns();
  f.sequence = m.sequence();
  f.same_for_ns = m.same_for_ns();
  f.kind = Same<hal::FeatureKind>(m.kind());
  f.found = m.found();
  f.confidence = m.confidence();
  f.dim = m.s_size();
  Get(m.s(), f.s);
  if (m.cov_s_size() != f.dim * f.dim) {
    throw std::runtime_error("the log holds a covariance of another size than its feature");
  }
  for (int row = 0; row < f.dim; ++row) {
    for (int col = 0; col < f.dim; ++col) {
      f.cov_s[static_cast<std::size_t>(row * hal::kMaxFeatureDim + col)] = m.cov_s(row * f.dim + col);
    }
  }
  f.num_poses = m.poses_size();
  if (f.num_poses > hal::kMaxPoses) {
    throw std::runtime_error("the log holds more poses than the servo takes");
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(f.num_poses); ++i) {
    const FlatPose& pose = m.poses(static_cast<int>(i));
    Get(pose.p_co_c(), f.poses[i].p_CO_C);
    Get(pose.q_co(), f.poses[i].q_CO);
    f.poses[i].first = pose.first();
  }
  return f;
}

hal::TickRecord FromMessage(const Tick& m, const hal::FeatureMeasurement& feature) {
  hal::TickRecord r;
  r.tick = m.tick();
  r.stamp_ns = m.stamp_ns();
  r.missed_ticks = m.missed_ticks();
  r.arm.stamp_ns = m.arm().stamp_ns();
  r.arm.sequence = m.arm().sequence();
  r.arm.num_joints = m.arm().q_size();
  Get(m.arm().q(), r.arm.q);
  Get(m.arm().dq(), r.arm.dq);
  Get(m.arm().tau_meas(), r.arm.tau_meas);
  Get(m.arm().tau_applied(), r.arm.tau_applied);
  r.has_feature = m.has_feature();
  r.feature = feature;
  r.intake = Same<hal::Intake>(m.intake());
  if (m.has_tuning()) {
    r.tuning = {Same<hal::TuningResult>(m.tuning().result()), m.tuning().number(), m.tuning().before(),
                m.tuning().asked()};
  }
  r.mode = Same<hal::Mode>(m.mode());
  r.hold_reason = Same<hal::HoldReason>(m.hold_reason());
  r.fault = Same<hal::Fault>(m.fault());
  r.fault_joint = m.fault_joint();
  r.limits_active = m.limits_active();
  r.target_known = m.target_known();
  r.feature_age_ns = m.feature_age_ns();
  Get(m.p_bo(), r.p_BO);
  Get(m.q_bo(), r.q_BO);
  Get(m.v_bo(), r.v_BO);
  r.stamp_late_s = m.stamp_late_s();
  r.stamp_late_sigma_s = m.stamp_late_sigma_s();
  r.dim = m.s_size();
  Get(m.s(), r.s);
  Get(m.s_star(), r.s_star);
  Get(m.e(), r.e);
  Get(m.v_bc_c_cmd(), r.V_BC_C_cmd);
  r.way = WayOf(m.way());
  Get(m.q_cmd(), r.q_cmd);
  Get(m.dq_cmd(), r.dq_cmd);
  Get(m.ddq_cmd(), r.ddq_cmd);
  Get(m.tau_ext(), r.tau_ext);
  r.command.state_sequence = m.command().state_sequence();
  r.command.num_joints = m.command().tau_size();
  Get(m.command().tau(), r.command.tau_cmd);
  r.command.engage_brakes = m.command().engage_brakes();
  return r;
}

std::string InWords(const Tuning& tuning) {
  const std::string key = tuning.key().empty() ? fmt::format("key {}", tuning.number()) : tuning.key();
  const std::string unit = tuning.unit().empty() ? "" : " " + tuning.unit();
  const auto result = Same<hal::TuningResult>(tuning.result());
  const std::string refused =
      result == hal::TuningResult::kTaken ? "" : fmt::format(", refused: {}", hal::Words(result));
  return fmt::format("{} {:g} -> {:g}{}, in motion{}", key, tuning.before(), tuning.asked(), unit, refused);
}

std::string InWords(const Way& way) {
  const auto event = Same<hal::PlanEvent>(way.event());
  if (event == hal::PlanEvent::kNone) {
    return "";
  }
  const auto outcome = static_cast<std::size_t>(way.outcome());
  const bool told = event == hal::PlanEvent::kNoMotion && outcome < trajectory::kPlanOutcomeWords.size();
  return fmt::format("{}{}{}", hal::Words(event), told ? ": " : "",
                     told ? trajectory::kPlanOutcomeWords[outcome] : "");
}

}  // namespace fovea::log
