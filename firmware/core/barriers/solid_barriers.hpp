// SPDX-License-Identifier: Apache-2.0
// One table of everything that the arm can collide with: the workspace's edge, each plane and box (for the
// hand), the planes and each box (for the links), and the arm itself.
//
// The resolution keeps each as a row, and the guard proves a stop before each. Both use this table.
#pragma once

#include "firmware/core/barriers/arm_bodies.hpp"
#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

class SolidBarriers {
 public:
  static constexpr int kMost = 1 + 2 * config::Obstacles::kMost + (1 + config::Obstacles::kMost) + 1;

  explicit SolidBarriers(const config::ServoConfig& config) noexcept;

  [[nodiscard]] int size() const noexcept { return 1 + num_hand_ + num_links_ + (self_ ? 1 : 0); }
  [[nodiscard]] hal::Limit NameOf(int i) const noexcept;
  // h of barrier `i` [m], 0 <= i < size(), with the arm's links at `poses`; `bodies`: their capsules there.
  // Of a box that is far from all links, h may be too small, but it is well above StopMarginOf. Real-time:
  // yes.
  [[nodiscard]] double ValueOf(int i, const model::ArmPoses& poses, const ArmBodies& bodies) const noexcept;
  // The smallest h that is allowed during a stop [m].
  [[nodiscard]] double StopMarginOf(int i) const noexcept;
  // How far every point of the arm may move per metre of h - margin: 1 m, or 0.5 m if both bodies move.
  [[nodiscard]] double ShareOf(int i) const noexcept { return KindOf(i) == Kind::kSelf ? 0.5 : 1.0; }

  // Barrier `i` as a row of the resolution. `J_E_B` [3 x num_joints]: linear Jacobian of the end effector;
  // `dq`: current joint velocities. Real-time: yes.
  struct Scene {
    const model::ArmPoses& poses;
    const ArmBodies& bodies;
    const model::LinearJacobian& J_E_B;
    const model::VecN& dq;
  };
  [[nodiscard]] Barrier RowOf(int i, const Scene& scene) const noexcept;

 private:
  enum class Kind { kWorkspace, kHand, kLinks, kSelf };
  [[nodiscard]] Kind KindOf(int i) const noexcept;

  const config::ServoConfig& config_;
  int num_hand_;   // one for each plane and box
  int num_links_;  // one for all planes, one for each box
  bool self_;
};

// The smallest distance of hand, camera, tools and links from the planes and boxes that they avoid [m];
// HUGE_VAL if there are none. Real-time: yes.
[[nodiscard]] double ClearanceOfArm(const config::ServoConfig& config, const model::ArmPoses& poses) noexcept;

}  // namespace fovea::barriers
