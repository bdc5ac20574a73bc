// SPDX-License-Identifier: Apache-2.0
// The operator's hand on the target: drags, turns and throws it. Once touched, the target stays where the
// hand left it; its motion of the scenario has ended.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

namespace fovea::sim {

class TargetHand {
 public:
  // The wishes of a mouse come 5 to 30 times per second, unevenly. The target follows them as a critically
  // damped spring does, with this rate [1/s]: its velocity has no jumps, as in a real hand.
  static constexpr double kFollowRate = 12.0;
  static constexpr double kFarthest = 2.0;       // largest coordinate of a wish in B [m]
  static constexpr double kMostSpeed = 3.0;      // of a throw [m/s]
  static constexpr double kMostTurnRate = 20.0;  // of a throw [rad/s]
  static constexpr double kSlowdownS = 0.35;     // time constant with which a thrown target slows down

  // `least_height`: of the target's centre in B [m], so that it stays above the table.
  explicit TargetHand(double least_height) : least_height_(least_height) {}

  // The target is at `X_BO` now and shall move to `wish` and stay there. `wish` is finite, each coordinate at
  // most kFarthest.
  void Drag(const Eigen::Isometry3d& X_BO, const Eigen::Isometry3d& wish, std::int64_t now_ns);
  // The target leaves the hand at `X_BO` with `v_BO` [m/s] and `omega_B` [rad/s], and slows down until it
  // rests.
  void Throw(const Eigen::Isometry3d& X_BO, const Eigen::Vector3d& v_BO, const Eigen::Vector3d& omega_B,
             std::int64_t now_ns);
  // The hand lets go: the target stays where it is, or arrives. The scenario's motion does not go on.
  void Release() { held_ = false; }

  [[nodiscard]] bool held() const { return held_; }
  // Where the last drag leads the target, if nothing stops the time; none if it was thrown since, or never
  // dragged.
  [[nodiscard]] std::optional<Eigen::Isometry3d> Goal() const;
  // The target's pose X_BO; none if nobody has touched it.
  [[nodiscard]] std::optional<Eigen::Isometry3d> At(std::int64_t now_ns) const;

 private:
  [[nodiscard]] Eigen::Isometry3d AboveTable(Eigen::Isometry3d X_BO) const;
  [[nodiscard]] double SecondsSince(std::int64_t now_ns) const;
  [[nodiscard]] Eigen::Vector3d VelocityAt(std::int64_t now_ns) const;

  enum class Motion { kNone, kDragged, kThrown };

  double least_height_;
  Motion motion_ = Motion::kNone;
  bool held_ = false;
  std::int64_t from_ns_ = 0;
  Eigen::Isometry3d from_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d to_ = Eigen::Isometry3d::Identity();
  Eigen::Vector3d v_BO_ = Eigen::Vector3d::Zero();  // at from_ns_, like the next
  Eigen::Vector3d omega_B_ = Eigen::Vector3d::Zero();
};

}  // namespace fovea::sim
