// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/predict.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/estimate/measurement_doubt.hpp"
#include "firmware/core/estimate/rolling_shutter.hpp"
#include "firmware/core/model/rotation.hpp"

namespace fovea::estimate {
namespace {

// A measurement, and the camera's pose at its stamp.
struct Seen {
  const hal::FeatureMeasurement& measurement;
  double late;        // how much older than its stamp [s]
  double late_sigma;  // of it, for a filter that starts [s]
  model::Pose X_BC;
  model::Vec6 V_BC_C;      // the camera's twist then
  MeasurementDoubt doubt;  // of that pose
  // Rolling shutter, of a ball or disc: how far its measured centre is off because of the camera's motion
  // [m], and per velocity of the target [s].
  model::Vec3 shift_C = model::Vec3::Zero();
  model::Mat3 shift_by_v_C = model::Mat3::Zero();
};

hal::Intake TakePose(const config::ServoConfig& config, Seen& seen, CornerView& view,
                     PredictState& state) noexcept {
  view.late = seen.late;
  view.late_sigma = seen.late_sigma;
  view.row_time = config.predict.row_time;
  view.row_y = config.predict.row_y;
  view.V_BC_C = seen.V_BC_C;
  view.doubt = &seen.doubt;
  view.stamp_ns = seen.measurement.stamp_ns;
  view.X_CB = seen.X_BC.Inverse();
  const Verdict verdict = TakeView(config.predict, config.feature.corners, view, state.hypotheses);
  // If no pose fits the corners, the previous one stays.
  if (verdict.intake == hal::Intake::kTaken && verdict.pose >= 0) {
    state.X_CO_meas = view.seen.branches[static_cast<std::size_t>(verdict.pose)].X_CO;
  }
  return verdict.intake;
}

hal::Intake TakePosition(const config::ServoConfig& config, Seen& seen, features::LiftedTarget lifted,
                         PredictState& state) noexcept {
  lifted.p_CO_C -= seen.shift_C;
  const bool is_disc = features::TraitsOf(config.feature.target).body == features::TargetBody::kDisc;
  bool changed = false;  // the centre's estimate belongs to the disc's other pose
  if (is_disc && seen.measurement.num_poses == 2) {
    const Verdict verdict = TakeView(seen.measurement, seen.X_BC, state.hypotheses);
    const auto& p = seen.measurement.poses[static_cast<std::size_t>(verdict.pose)].p_CO_C;
    const double size = config.feature.radius * config.feature.radius;
    lifted.p_CO_C = verdict.farther * model::Vec3(p[0], p[1], p[2]);
    lifted.p_CO_C += size / lifted.p_CO_C.norm() * (seen.X_BC.R.transpose() * verdict.off_B) - seen.shift_C;
    changed = verdict.changed;
  }
  const model::Mat3& R = seen.X_BC.R;
  const MeasuredCentre centre{.stamp_ns = seen.measurement.stamp_ns,
                              .p_BO = seen.X_BC * lifted.p_CO_C,
                              .cov_B = R * lifted.cov_p * R.transpose(),
                              .late = seen.late,
                              .late_sigma = seen.late_sigma,
                              .v_BO_held = R * (PlaceByCamera(lifted.p_CO_C) * seen.V_BC_C),
                              .doubt = &seen.doubt,
                              .p_CO_C = lifted.p_CO_C,
                              .shift_by_v_B = R * seen.shift_by_v_C * R.transpose()};
  if (changed) {
    const int accepted = state.filter.accepted;
    state.filter = TargetFilter{};
    const hal::Intake intake = Update(config.predict, centre, state.filter);
    state.filter.accepted = std::max(accepted, 1);
    state.X_CO_meas.p = lifted.p_CO_C;
    return intake;
  }
  const hal::Intake intake = Update(config.predict, centre, state.filter);
  if (intake == hal::Intake::kTaken) {
    state.X_CO_meas.p = lifted.p_CO_C;
  }
  return intake;
}

// The place of the corners: from the likeliest pose that fits them, or else from the believed pose.
model::Vec3 PlaceOfCorners(const features::SeenCorners& seen, const model::Pose& X_BC,
                           const PoseHypotheses& hypotheses) noexcept {
  return seen.num_branches > 0 ? seen.branches[0].X_CO.p
                               : X_BC.Inverse() * hypotheses.plate.best().filter.X_BO.p;
}

bool IsInside(const config::Box& box, const model::Vec3& p) noexcept {
  return (p.array() >= box.low.array()).all() && (p.array() <= box.high.array()).all();
}

// Keeps the estimate of the target in its region, and stops its motion out of it.
void KeepInside(const config::Box& box, FlatMotion& motion) noexcept {
  for (Eigen::Index i = 0; i < 3; ++i) {
    double& p = motion.X_BO.p[i];
    double& v = motion.v_BO_B[i];
    const double inside = std::clamp(p, box.low[i], box.high[i]);
    v = (p - inside) * v > 0.0 ? 0.0 : v;
    p = inside;
  }
}

bool HasEnough(const config::ServoConfig& config, const PredictState& state) noexcept {
  const int accepted = config.feature.SeesOrientation() ? state.hypotheses.accepted : state.filter.accepted;
  return accepted >= config.predict.accepted_min;
}

// The filters' estimate of the target at `now_ns`.
FlatMotion BelievedMotion(const config::ServoConfig& config, const PredictState& state,
                          std::int64_t now_ns) noexcept {
  if (config.feature.SeesOrientation()) {
    return MotionAt(config.predict, state.hypotheses, now_ns);
  }
  const TargetMotion motion = MotionAt(config.predict, state.filter, now_ns);
  return {{model::Mat3::Identity(), motion.p_BO}, motion.v_BO, model::Vec3::Zero()};
}

// Moves the measurement to the time of its stamp, as if the target stood still in B: the corners of `view`,
// or the centre by `seen`.shift_C. The filters add the target's own motion.
void CorrectRows(const config::ServoConfig& config, std::int64_t taken_ns,
                 const features::LiftedTarget& lifted, const PredictState& state, Seen& seen,
                 CornerView& view) noexcept {
  const features::TargetFeature& feature = config.feature;
  const auto from_here = [&](const model::Pose& X_CO) {
    return SeenFrom(seen.X_BC, seen.V_BC_C, X_CO, model::Vec3::Zero(), model::Vec3::Zero());
  };
  if (!feature.SeesOrientation()) {
    seen.shift_by_v_C = features::TraitsOf(feature.target).body == features::TargetBody::kDisc
                            ? DiscShiftByVelocity(config.predict, lifted.p_CO_C)
                            : SphereShiftByVelocity(config.predict, feature.radius, lifted.p_CO_C);
    seen.shift_C = seen.shift_by_v_C * from_here({model::Mat3::Identity(), lifted.p_CO_C}).v;
  } else if (state.hypotheses.plate.count > 0) {
    const model::Pose X_BO = BelievedMotion(config, state, taken_ns).X_BO;
    MoveCornersToStamp(config.predict, from_here(seen.X_BC.Inverse() * X_BO), view.seen.xy);
  } else if (view.seen.num_branches > 0) {
    MoveCornersToStamp(config.predict, from_here(view.seen.branches[0].X_CO), view.seen.xy);
  }
}

StampError Lateness(const config::ServoConfig& config, const PredictState& state,
                    std::int64_t now_ns) noexcept {
  if (state.knowledge == Knowledge::kNone) {
    return LatenessAt(state.lateness, now_ns, config.predict.stamp_offset, config.predict.stamp_sigma);
  }
  if (config.feature.SeesOrientation()) {
    const PoseFilter& filter = state.hypotheses.plate.best().filter;
    return {filter.late, std::sqrt(std::max(filter.P(PoseFilter::kLate, PoseFilter::kLate), 0.0))};
  }
  return {state.filter.late, std::sqrt(state.filter.P_late)};
}

// Extrapolates `belief` to `now_ns` without acceleration.
FlatMotion GoesOn(const LastBelief& belief, std::int64_t now_ns) noexcept {
  const double dt = 1e-9 * static_cast<double>(now_ns - belief.stamp_ns);
  FlatMotion motion = belief.motion;
  motion.X_BO.p += dt * motion.v_BO_B;
  motion.X_BO.R = model::RotationOf(motion.w_BO_B * dt).lazyProduct(motion.X_BO.R);
  return motion;
}

// Updates the knowledge after an accepted measurement. `has_enough`: the filter now has enough measurements;
// `before`: the estimate until then.
void NoteTaken(bool has_enough, const LastBelief& before, PredictState& state) noexcept {
  if (has_enough) {
    state.knowledge = Knowledge::kKnown;
  } else if (state.knowledge == Knowledge::kKnown) {
    state.knowledge = Knowledge::kBegunAnew;
    state.belief = before;
  } else if (state.knowledge == Knowledge::kNone) {
    state.knowledge = Knowledge::kTooLittle;
  }
}

}  // namespace

hal::Intake TakeMeasurement(const config::ServoConfig& config, std::int64_t now_ns,
                            const hal::FeatureMeasurement& measurement, PredictState& state,
                            EyeWatch& eye) noexcept {
  if (!measurement.found) {
    return hal::Intake::kNotFound;
  }
  if (measurement.stamp_ns > now_ns + hal::kTickPeriodNs) {
    return hal::Intake::kFromFuture;  // a filter that accepted it would reject all true ones
  }
  // No picture is from the future.
  const StampError lateness = Lateness(config, state, measurement.stamp_ns);
  const double late = std::max(lateness.mean_s, hal::ToSeconds(measurement.stamp_ns - now_ns));
  const std::int64_t taken_ns = measurement.stamp_ns - static_cast<std::int64_t>(late * 1e9);
  model::ArmPoses poses;
  if (!PosesAt(state.history, config.arm, taken_ns, poses)) {
    return hal::Intake::kTooOld;
  }
  const model::Pose X_BC = poses.X_BE * config.X_EC;
  const bool is_flat = config.feature.SeesOrientation();
  CornerView view;
  features::LiftedTarget lifted;
  if (is_flat ? !config.feature.TakeCorners(measurement, view.seen)
              : !config.feature.Lift(measurement, lifted)) {
    return hal::Intake::kWrongKind;
  }
  const model::Vec3 p_CO_C = is_flat ? PlaceOfCorners(view.seen, X_BC, state.hypotheses) : lifted.p_CO_C;

  WatchPicture(config.predict, X_BC, p_CO_C, eye);
  PictureView picture{measurement.stamp_ns - measurement.same_for_ns, X_BC, X_BC, p_CO_C, view.seen.xy};
  if (measurement.same_for_ns > 0) {
    // If the history does not reach back that far, the hand's motion counts from now on.
    static_cast<void>(CameraPoseAt(state.history, config.arm, config.X_EC, taken_ns - measurement.same_for_ns,
                                   picture.X_BC_since));
  }
  if (IsStuck(config.predict.stuck_shift, picture, state.picture)) {
    return hal::Intake::kStuckPicture;
  }
  if (!IsInside(config.predict.target_region, X_BC * p_CO_C)) {
    return hal::Intake::kOutOfRegion;
  }

  const LastBelief before{now_ns, BelievedMotion(config, state, now_ns)};
  // A filter that begins anew though a target is known may do so because of a wrong lateness.
  const double late_sigma =
      state.knowledge == Knowledge::kNone ? lateness.sigma_s : config.predict.stamp_sigma;
  Seen seen{measurement,
            late,
            late_sigma,
            X_BC,
            CameraTwistAt(state.history, config.arm, config.X_EC, taken_ns, poses),
            MeasurementDoubt(config, state.history, taken_ns, X_BC, p_CO_C)};
  if (config.predict.row_time > 0.0) {
    CorrectRows(config, taken_ns, lifted, state, seen, view);
  }
  const hal::Intake intake =
      is_flat ? TakePose(config, seen, view, state) : TakePosition(config, seen, lifted, state);
  if (intake != hal::Intake::kTaken) {
    return intake;
  }
  NoteTaken(HasEnough(config, state), before, state);
  state.lateness = {true, measurement.stamp_ns, Lateness(config, state, measurement.stamp_ns)};
  if (state.knowledge != Knowledge::kBegunAnew) {
    state.accepted_stamp_ns = measurement.stamp_ns;
  }
  return intake;
}

Prediction Predict(const config::ServoConfig& config, std::int64_t now_ns, const model::Pose& X_BC,
                   const PredictState& state) noexcept {
  Prediction prediction;
  prediction.late = Lateness(config, state, now_ns);
  if (state.knowledge == Knowledge::kNone) {
    return prediction;
  }
  const bool is_flat = config.feature.SeesOrientation();
  prediction.known = state.knowledge != Knowledge::kTooLittle;
  prediction.age_ns = now_ns - state.accepted_stamp_ns;
  if (!config.predict.enabled) {
    // As in a camera-rate servo, a measurement counts until the next one.
    prediction.seen.X_CO = state.X_CO_meas;
    prediction.p_BO = X_BC * state.X_CO_meas.p;
    if (is_flat) {
      prediction.R_BO = X_BC.R * state.X_CO_meas.R;
    }
    return prediction;
  }
  FlatMotion motion = state.knowledge == Knowledge::kBegunAnew ? GoesOn(state.belief, now_ns)
                                                               : BelievedMotion(config, state, now_ns);
  KeepInside(config.predict.target_region, motion);
  prediction.p_BO = motion.X_BO.p;
  prediction.v_BO = motion.v_BO_B;
  if (is_flat) {
    prediction.R_BO = motion.X_BO.R;
    prediction.seen.X_CO.R = X_BC.R.transpose() * motion.X_BO.R;
    prediction.seen.w_BO_C = X_BC.R.transpose() * motion.w_BO_B;
  }
  prediction.seen.X_CO.p = X_BC.Inverse() * prediction.p_BO;
  prediction.seen.v_BO_C = X_BC.R.transpose() * prediction.v_BO;
  return prediction;
}

}  // namespace fovea::estimate
