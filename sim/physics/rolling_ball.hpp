// A ball on the table as a Bullet rigid body: it lies, is pushed, slides, rolls and comes to rest. It meets
// the table alone, in a world of its own.
//
// Pushed through its centre by an impulse P, it slides off with P / mass and slows down by friction until it
// rolls, with 5/7 of that; from then on the rolling resistance c [m], a torque c N against the roll, and the
// air slow it down: a = 5/7 c g / radius without air.
#pragma once

#include <Eigen/Geometry>
#include <memory>

namespace fovea::sim {

struct RollingBallConfig {
  Eigen::Vector3d p_BO = Eigen::Vector3d::Zero();  // at the start, at rest [m]
  double radius = 0.04;                            // [m]
  double mass = 0.2;                               // [kg], of a full ball
  double friction = 0.5;                           // between ball and table
  double rolling_resistance = 0.001;               // [m]
  double air_damping = 0.05;                       // share of the speed that the air takes per second [1/s]
};

class RollingBall {
 public:
  explicit RollingBall(const RollingBallConfig& config);
  ~RollingBall();
  RollingBall(const RollingBall&) = delete;
  RollingBall& operator=(const RollingBall&) = delete;

  // A push through its centre, `impulse` in axes of B [N s].
  void Push(const Eigen::Vector3d& impulse);
  // Moves on by `dt` [s].
  void Step(double dt);

  [[nodiscard]] Eigen::Isometry3d X_BO() const;
  [[nodiscard]] Eigen::Vector3d v_BO() const;  // [m/s]

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fovea::sim
