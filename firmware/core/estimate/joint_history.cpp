// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/joint_history.hpp"

#include <algorithm>

#include "firmware/core/model/rotation.hpp"

namespace fovea::estimate {

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

bool PosesAt(const JointHistory& history, const model::ArmModel& arm, std::int64_t stamp_ns,
             model::ArmPoses& poses) noexcept {
  model::VecN q;
  if (!history.At(stamp_ns, q)) {
    return false;
  }
  model::ComputePoses(arm, q, poses);
  return true;
}

bool CameraPoseAt(const JointHistory& history, const model::ArmModel& arm, const model::Pose& X_EC,
                  std::int64_t stamp_ns, model::Pose& X_BC) noexcept {
  model::ArmPoses poses;
  if (!PosesAt(history, arm, stamp_ns, poses)) {
    return false;
  }
  X_BC = poses.X_BE * X_EC;
  return true;
}

model::Vec6 CameraTwistAt(const JointHistory& history, const model::ArmModel& arm, const model::Pose& X_EC,
                          std::int64_t stamp_ns, const model::ArmPoses& poses) noexcept {
  constexpr std::int64_t kHalfNs = 10 * hal::kNsPerMs;
  const model::Pose X_BC = poses.X_BE * X_EC;
  model::Pose X_BC_before;
  model::Pose X_BC_after;
  model::Vec6 V_BC_C = model::Vec6::Zero();
  if (CameraPoseAt(history, arm, X_EC, stamp_ns - kHalfNs, X_BC_before)) {
    const std::int64_t after_ns = std::min(stamp_ns + kHalfNs, history.newest_ns());
    const std::int64_t span_ns = after_ns - (stamp_ns - kHalfNs);
    if (span_ns >= kHalfNs && CameraPoseAt(history, arm, X_EC, after_ns, X_BC_after)) {
      const double span = hal::ToSeconds(span_ns);
      V_BC_C.head<3>() = X_BC.R.transpose() * (X_BC_after.p - X_BC_before.p) / span;
      V_BC_C.tail<3>() = model::RotationVector(X_BC_before.R.transpose() * X_BC_after.R) / span;
    }
  }
  return V_BC_C;
}

}  // namespace fovea::estimate
