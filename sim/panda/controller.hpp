// SPDX-License-Identifier: Apache-2.0
// The robot's internal controllers: joint and Cartesian impedance. Torques without gravity.
#pragma once

#include "sim/panda/reference.hpp"
#include "sim/panda/settings.hpp"
#include "sim/robot/chain.hpp"

namespace fovea::sim {

// The arm's measured state, input of the controllers.
struct FciMeasured {
  Joints q = Joints::Zero();
  Joints dq = Joints::Zero();
  Eigen::Matrix<double, 7, 7> M = Eigen::Matrix<double, 7, 7>::Identity();
  Joints Cdq = Joints::Zero();
};

// Springs and dampers between each joint and its reference, plus the torque for the reference's acceleration.
[[nodiscard]] Joints JointImpedanceTorque(const FciMeasured& arm, const JointReference& reference,
                                          const franka::JointImpedance& stiffness);

// Springs and dampers between the stiffness frame K (at F_T_K on the flange) and its reference pose. A weak
// spring holds the posture in the null space.
[[nodiscard]] Joints CartesianImpedanceTorque(const Chain& chain, const FciMeasured& arm,
                                              const JointReference& reference, const Eigen::Isometry3d& F_T_K,
                                              const franka::CartesianImpedance& stiffness);

// Lets a person guide the end effector (at F_T_EE on the flange). The axes of O that `mode` frees have no
// spring; stiff springs hold the others at the pose of `begin`. `mode` also frees or holds the elbow.
[[nodiscard]] Joints GuidingTorque(const Chain& chain, const FciMeasured& arm, const Joints& begin,
                                   const Eigen::Isometry3d& F_T_EE, const franka::GuidingMode& mode);

}  // namespace fovea::sim
