// SPDX-License-Identifier: Apache-2.0
// A ball on the table as a Bullet rigid body: it is pushed, slides, rolls and comes to rest. It collides only
// with the table, in a separate Bullet world.
//
// An impulse P through its centre gives it the speed P / mass. It slides, and friction slows it down to 5/7
// of that speed; then it rolls. From then on the air and the rolling resistance c [m], a torque c N against
// the rolling, slow it down: a = 5/7 c g / radius without air.
#pragma once

#include <Eigen/Geometry>
#include <memory>

namespace fovea::sim {

struct RollingBallConfig {
  Eigen::Vector3d p_BO = Eigen::Vector3d::Zero();  // at the start, at rest [m]
  double radius = 0.04;                            // [m]
  double mass = 0.2;                               // [kg], of a solid ball
  double friction = 0.5;                           // between ball and table
  double rolling_resistance = 0.001;               // [m]
  double air_damping = 0.05;                       // share of the speed lost to the air per second [1/s]
};

class RollingBall {
 public:
  explicit RollingBall(const RollingBallConfig& config);
  ~RollingBall();
  RollingBall(const RollingBall&) = delete;
  RollingBall& operator=(const RollingBall&) = delete;

  // Pushes the ball through its centre; `impulse` in axes of B [N s].
  void Push(const Eigen::Vector3d& impulse);
  // Advances by `dt` [s].
  void Step(double dt);

  [[nodiscard]] Eigen::Isometry3d X_BO() const;
  [[nodiscard]] Eigen::Vector3d v_BO() const;  // [m/s]

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fovea::sim
