// What the arm can run into, in one table: the workspace's edge, each plane and box before the hand, the
// planes before the links, and the arm itself.
//
// The resolution keeps each as a row, and the guard proves a stop before each; what one of them knows the
// other knows too.
#pragma once

#include "firmware/core/barriers/arm_bodies.hpp"
#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

class SolidBarriers {
 public:
  static constexpr int kMost = 1 + 2 * config::Obstacles::kMost + 2;

  explicit SolidBarriers(const config::ServoConfig& config) noexcept;

  [[nodiscard]] int size() const noexcept { return num_hand_ + (links_ ? 1 : 0) + (self_ ? 1 : 0) + 1; }
  [[nodiscard]] hal::Limit NameOf(int i) const noexcept;
  // h of barrier `i` [m], 0 <= i < size(), with the arm's links at `poses`; `bodies`: what it
  // fills there.
  // Real-time: yes.
  [[nodiscard]] double ValueOf(int i, const model::ArmPoses& poses, const ArmBodies& bodies) const noexcept;
  // The least h that a stop must keep [m].
  [[nodiscard]] double StopMarginOf(int i) const noexcept;
  // How much of h is left at least for each metre that every point of the arm may still go: 1, or half of it
  // where both sides may move.
  [[nodiscard]] double ShareOf(int i) const noexcept { return KindOf(i) == Kind::kSelf ? 0.5 : 1.0; }

  // Barrier `i` as a row of the resolution. `J_E_B` [3 x num_joints] moves the end effector; `dq`: the joint
  // velocities at present. Real-time: yes.
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
  int num_hand_;  // one for each plane and box
  bool links_;
  bool self_;
};

// How far hand, camera, tools and links are from the planes and boxes that they keep out of, at least [m];
// HUGE_VAL where there is nothing. Real-time: yes.
[[nodiscard]] double ClearanceOfArm(const config::ServoConfig& config, const model::ArmPoses& poses) noexcept;

}  // namespace fovea::barriers
