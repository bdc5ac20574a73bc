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

// Takes in one measurement; leaves the state as it was when the measurement says nothing.
void TakeIn(const ServoConfig& config, std::int64_t now_ns, const hal::FeatureMeasurement& measurement,
            PredictState& state) noexcept {
  if (!measurement.found || measurement.dim != features::SphereFeature::kDim) {
    return;
  }
  if (measurement.stamp_ns > now_ns + hal::kTickPeriodNs) {
    return;  // nothing can have been seen yet; a filter that believed it would refuse all that is true
  }
  model::VecN q_then;
  if (!state.history.At(measurement.stamp_ns, q_then)) {
    return;
  }
  const model::Vec3 s(measurement.s[0], measurement.s[1], measurement.s[2]);
  model::Mat3 cov_s;
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) {
      cov_s(row, col) = measurement.cov_s[static_cast<std::size_t>(row * hal::kMaxFeatureDim + col)];
    }
  }
  model::Vec3 p_CO_C;
  model::Mat3 cov_C;
  if (!config.feature.Lift(s, cov_s, p_CO_C, cov_C)) {
    return;
  }
  model::ArmPoses poses_then;
  model::ComputePoses(config.arm, q_then, poses_then);
  const model::Pose X_BC_then = poses_then.X_BE * config.X_EC;
  if (!Update(config.predict, measurement.stamp_ns, X_BC_then * p_CO_C,
              X_BC_then.R * cov_C * X_BC_then.R.transpose(), state.filter)) {
    return;
  }
  state.has_accepted = true;
  state.accepted_stamp_ns = measurement.stamp_ns;
  state.p_CO_C_meas = p_CO_C;
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
  prediction.known = state.filter.accepted >= config.predict.accepted_min;
  prediction.age_ns = now_ns - state.accepted_stamp_ns;
  if (config.predict.enabled) {
    const TargetMotion motion = MotionAt(state.filter, now_ns);
    prediction.p_BO = motion.p_BO;
    prediction.v_BO = motion.v_BO;
    prediction.p_CO_C = X_BC.Inverse() * prediction.p_BO;
    prediction.v_BO_C = X_BC.R.transpose() * prediction.v_BO;
  } else {
    // As a camera-rate servo does it: the measurement counts until the next one comes.
    prediction.p_CO_C = state.p_CO_C_meas;
    prediction.p_BO = X_BC * state.p_CO_C_meas;
  }
  return prediction;
}

}  // namespace fovea::servo
