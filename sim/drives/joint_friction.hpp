// SPDX-License-Identifier: Apache-2.0
// The joint friction that is left after the robot's own controller has compensated what it believes in.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

class JointFriction {
 public:
  // `compensated`: share of the friction of `believed` that the controller compensates. It may do so too
  // much. `holds`: Coulomb friction is a constraint of the physics, see BulletArm::SetStiction; otherwise it
  // is smooth around rest. `on_motors`: it acts on the rotors alone, behind elastic joints.
  JointFriction(const SimRobot& robot, const SimRobot& believed, double compensated, bool holds,
                bool on_motors);

  // Of the moving joint `joint` at `velocity` [rad/s, m/s]: the torque against it [Nm, N].
  [[nodiscard]] double Torque(int joint, double velocity) const;
  // Coulomb friction for the physics, one per moving joint [Nm, N], at least 0.
  [[nodiscard]] Eigen::VectorXd Holding() const;

 private:
  bool holds_;
  // Of the moving links, base to tip.
  std::vector<double> viscous_;  // damping that is left [Nm s/rad, N s/m]
  std::vector<double> coulomb_;  // Coulomb friction that is left [Nm, N]; below 0: compensated too much
  std::vector<double> stiction_speed_;  // speed scale of the smooth Coulomb friction [rad/s, m/s]
};

}  // namespace fovea::sim
