#include "firmware/core/model/ready_inertia.hpp"

#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::model {

VecN InertiaAtReady(const ArmModel& arm) noexcept {
  ArmPoses poses;
  ArmDynamics dynamics;
  ComputePoses(arm, ToVector(arm.q_ready, arm.num_joints), poses);
  ComputeDynamics(arm, poses, VecN::Zero(arm.num_joints), dynamics);
  return dynamics.M.diagonal();
}

}  // namespace fovea::model
