// The robot's internal controllers: joint and Cartesian impedance. Torques without gravity.
#pragma once

#include "sim/panda/reference.hpp"
#include "sim/panda/settings.hpp"
#include "sim/robot/chain.hpp"

namespace fovea::sim {

// What a controller sees of the arm at one instant.
struct FciMeasured {
  Joints q = Joints::Zero();
  Joints dq = Joints::Zero();
  Eigen::Matrix<double, 7, 7> M = Eigen::Matrix<double, 7, 7>::Identity();
  Joints Cdq = Joints::Zero();
};

// Springs and dampers between each joint and its reference, and what the reference's acceleration takes.
[[nodiscard]] Joints JointImpedanceTorque(const FciMeasured& arm, const JointReference& reference,
                                          const franka::JointImpedance& stiffness);

// Springs and dampers between the stiffness frame K (at F_T_K on the flange) and where the reference has it;
// the posture that is left free is held weakly.
[[nodiscard]] Joints CartesianImpedanceTorque(const Chain& chain, const FciMeasured& arm,
                                              const JointReference& reference, const Eigen::Isometry3d& F_T_K,
                                              const franka::CartesianImpedance& stiffness);

// What leaves the end effector (at F_T_EE on the flange) to a hand that guides it: no spring along the axes
// of O, or about them, that `mode` frees, and a stiff one to where `begin` has it along the others; the elbow
// is held or free as `mode` says.
[[nodiscard]] Joints GuidingTorque(const Chain& chain, const FciMeasured& arm, const Joints& begin,
                                   const Eigen::Isometry3d& F_T_EE, const franka::GuidingMode& mode);

}  // namespace fovea::sim
