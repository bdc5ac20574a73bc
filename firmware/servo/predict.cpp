#include "fovea/servo/predict.hpp"

namespace fovea::servo {

const JointHistory::Entry& JointHistory::FromOldest(int i) const noexcept {
  const int index = (newest_ + kCapacity - size_ + 1 + i) % kCapacity;
  return entries_[static_cast<std::size_t>(index)];
}

void JointHistory::Push(std::int64_t stamp_ns, const model::VecN& q) noexcept {
  newest_ = (newest_ + 1) % kCapacity;
  entries_[static_cast<std::size_t>(newest_)] = {stamp_ns, q};
  if (size_ < kCapacity) {
    ++size_;
  }
}

bool JointHistory::At(std::int64_t stamp_ns, model::VecN& q) const noexcept {
  if (size_ == 0 || stamp_ns < FromOldest(0).stamp_ns) {
    return false;
  }
  // The first entry later than the stamp, by bisection.
  int low = 0;
  int high = size_;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (FromOldest(middle).stamp_ns > stamp_ns) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  const Entry& before = FromOldest(low - 1);
  if (low == size_) {
    q = before.q;
    return true;
  }
  const Entry& after = FromOldest(low);
  const double share =
      static_cast<double>(stamp_ns - before.stamp_ns) / static_cast<double>(after.stamp_ns - before.stamp_ns);
  q = before.q + share * (after.q - before.q);
  return true;
}

namespace {

// As a camera-rate servo knows a flat target: of the measurement's poses the one nearest to the estimate;
// where the corners allow none, the one before stays.
void HoldNearest(const features::SeenCorners& seen, const model::Mat3& R_CO, model::Pose& X_CO) noexcept {
  double nearest = -2.0;
  for (int i = 0; i < seen.num_branches; ++i) {
    const model::Pose& pose = seen.branches[static_cast<std::size_t>(i)].X_CO;
    const double likeness = pose.R.cwiseProduct(R_CO).sum();  // 1 + 2 cos of the turn between them
    if (likeness > nearest) {
      nearest = likeness;
      X_CO = pose;
    }
  }
}

// Whether the measurement was taken in.
bool TakePose(const ServoConfig& config, const hal::FeatureMeasurement& measurement,
              const model::Pose& X_BC_then, PredictState& state) noexcept {
  CornerView view;
  if (!config.feature.TakeCorners(measurement, view.seen)) {
    return false;
  }
  view.stamp_ns = measurement.stamp_ns;
  view.X_CB = X_BC_then.Inverse();
  if (!UpdatePoses(config.predict, config.feature.corners, view, state.poses)) {
    return false;
  }
  HoldNearest(view.seen, view.X_CB.R * state.poses.best().X_BO.R, state.X_CO_meas);
  return true;
}

bool TakePosition(const ServoConfig& config, const hal::FeatureMeasurement& measurement,
                  const model::Pose& X_BC_then, PredictState& state) noexcept {
  features::LiftedTarget lifted;
  if (!config.feature.Lift(measurement, lifted)) {
    return false;
  }
  if (measurement.kind == hal::FeatureKind::kCircle && measurement.num_poses == 2) {
    bool changed = false;
    const int chosen = ChooseDisc(measurement, X_BC_then, state.disc, changed);
    const auto& p = measurement.poses[static_cast<std::size_t>(chosen)].p_CO_C;
    lifted.p_CO_C = {p[0], p[1], p[2]};
    if (changed) {  // what was believed of the centre was of the other pose
      const int accepted = state.filter.accepted;
      state.filter = TargetFilter{};
      (void)Update(config.predict, measurement.stamp_ns, X_BC_then * lifted.p_CO_C,
                   X_BC_then.R * lifted.cov_p * X_BC_then.R.transpose(), state.filter);
      state.filter.accepted = accepted;
      state.X_CO_meas.p = lifted.p_CO_C;
      return true;
    }
  }
  const model::Mat3 cov_p = X_BC_then.R * lifted.cov_p * X_BC_then.R.transpose();
  if (!Update(config.predict, measurement.stamp_ns, X_BC_then * lifted.p_CO_C, cov_p, state.filter)) {
    return false;
  }
  state.X_CO_meas.p = lifted.p_CO_C;
  return true;
}

// Takes in one measurement; leaves the state as it was when the measurement says nothing.
void TakeIn(const ServoConfig& config, std::int64_t now_ns, const hal::FeatureMeasurement& measurement,
            PredictState& state) noexcept {
  if (measurement.stamp_ns > now_ns + hal::kTickPeriodNs) {
    return;  // nothing can have been seen yet; a filter that believed it would refuse all that is true
  }
  model::VecN q_then;
  if (!state.history.At(measurement.stamp_ns, q_then)) {
    return;
  }
  model::ArmPoses poses_then;
  model::ComputePoses(config.arm, q_then, poses_then);
  const model::Pose X_BC_then = poses_then.X_BE * config.X_EC;
  const bool taken = config.feature.SeesOrientation() ? TakePose(config, measurement, X_BC_then, state)
                                                      : TakePosition(config, measurement, X_BC_then, state);
  if (taken) {
    state.has_accepted = true;
    state.accepted_stamp_ns = measurement.stamp_ns;
  }
}

}  // namespace

Prediction Predict(const ServoConfig& config, std::int64_t now_ns, const model::Pose& X_BC,
                   const hal::FeatureMeasurement* measurement, PredictState& state) noexcept {
  if (measurement != nullptr) {
    TakeIn(config, now_ns, *measurement, state);
  }
  Prediction prediction;
  if (!state.has_accepted) {
    return prediction;
  }
  const bool is_flat = config.feature.SeesOrientation();
  prediction.known = (is_flat ? state.poses.accepted : state.filter.accepted) >= config.predict.accepted_min;
  prediction.age_ns = now_ns - state.accepted_stamp_ns;
  if (!config.predict.enabled) {
    // As a camera-rate servo does it: the measurement counts until the next one comes.
    prediction.seen.X_CO = state.X_CO_meas;
    prediction.p_BO = X_BC * state.X_CO_meas.p;
    if (is_flat) {
      prediction.R_BO = X_BC.R * state.X_CO_meas.R;
    }
    return prediction;
  }
  if (is_flat) {
    const FlatMotion motion = MotionAt(state.poses, now_ns);
    prediction.p_BO = motion.X_BO.p;
    prediction.R_BO = motion.X_BO.R;
    prediction.v_BO = motion.v_BO_B;
    prediction.seen.X_CO.R = X_BC.R.transpose() * motion.X_BO.R;
    prediction.seen.w_BO_C = X_BC.R.transpose() * motion.w_BO_B;
  } else {
    const TargetMotion motion = MotionAt(state.filter, now_ns);
    prediction.p_BO = motion.p_BO;
    prediction.v_BO = motion.v_BO;
  }
  prediction.seen.X_CO.p = X_BC.Inverse() * prediction.p_BO;
  prediction.seen.v_BO_C = X_BC.R.transpose() * prediction.v_BO;
  return prediction;
}

}  // namespace fovea::servo
