// SPDX-License-Identifier: Apache-2.0
// The joints' positions of the last half second, one entry per tick.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/model/kinematics.hpp"

namespace fovea::link {
struct StateAccess;
}

namespace fovea::estimate {

class JointHistory {
 public:
  static constexpr int kCapacity = 512;

  void Push(std::int64_t stamp_ns, const model::VecN& q) noexcept;

  // q at `stamp_ns`, interpolated between the two ticks around it. False if the history does not reach back
  // that far. A stamp after the newest entry gives the newest. Real-time: yes, at most 9 steps of search.
  [[nodiscard]] bool At(std::int64_t stamp_ns, model::VecN& q) const noexcept;

  // The stamp of the newest entry. There must be one.
  [[nodiscard]] std::int64_t newest_ns() const noexcept {
    return entries_[static_cast<std::size_t>(newest_)].stamp_ns;
  }

  void Clear() noexcept { size_ = 0; }

 private:
  friend struct link::StateAccess;  // writes and reads all of it: firmware/core/link/state_fields.hpp
  struct Entry {
    std::int64_t stamp_ns = 0;
    model::VecN q;
  };
  [[nodiscard]] const Entry& FromOldest(int i) const noexcept;

  std::array<Entry, kCapacity> entries_{};
  int newest_ = kCapacity - 1;
  int size_ = 0;
};

// The links' poses of `arm` at `stamp_ns`. False if the history does not reach back that far. Real-time: yes.
[[nodiscard]] bool PosesAt(const JointHistory& history, const model::ArmModel& arm, std::int64_t stamp_ns,
                           model::ArmPoses& poses) noexcept;

// The pose of a camera at `X_EC` in the hand of `arm` at `stamp_ns`. False, with `X_BC` unchanged, if the
// history does not reach back that far. Real-time: yes.
[[nodiscard]] bool CameraPoseAt(const JointHistory& history, const model::ArmModel& arm,
                                const model::Pose& X_EC, std::int64_t stamp_ns, model::Pose& X_BC) noexcept;

// The camera's mean twist [v; w] in its own axes [m/s, rad/s] within 10 ms around `stamp_ns`, at which the
// links are at `poses`; of the part that the history has. Zero if it has less than half of that. Real-time:
// yes.
[[nodiscard]] model::Vec6 CameraTwistAt(const JointHistory& history, const model::ArmModel& arm,
                                        const model::Pose& X_EC, std::int64_t stamp_ns,
                                        const model::ArmPoses& poses) noexcept;

}  // namespace fovea::estimate
