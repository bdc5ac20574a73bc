// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/joint_history.hpp"

#include <algorithm>

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
  const std::int64_t before_ns = stamp_ns - kHalfNs;
  const std::int64_t after_ns = std::min(stamp_ns + kHalfNs, history.newest_ns());
  model::VecN q_before;
  model::VecN q_after;
  if (after_ns - before_ns < kHalfNs || !history.At(before_ns, q_before) || !history.At(after_ns, q_after)) {
    return model::Vec6::Zero();
  }
  model::Mat6N J_C;
  model::ComputeJacobian(arm, poses, X_EC, J_C);
  return J_C.lazyProduct((q_after - q_before) / hal::ToSeconds(after_ns - before_ns));
}

}  // namespace fovea::estimate
