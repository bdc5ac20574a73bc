// SPDX-License-Identifier: Apache-2.0
// The checks common to all arm drivers: arguments on the way in, the joint count on the way out.
#include "fovea/hal/arm.hpp"

#include <cmath>

namespace fovea::hal {

Status Arm::Read(ArmState& state) noexcept {
  ArmState taken;
  const Status status = DoRead(taken);
  if (!status.ok()) {
    return status;
  }
  if (taken.num_joints != num_joints_) {
    return Status(StatusCode::kDeviceFault, "ArmState.num_joints");
  }
  state = taken;
  return Status::Ok();
}

Status Arm::Write(const ArmCommand& command) noexcept {
  if (command.num_joints != num_joints_) {
    return Status(StatusCode::kInvalidArgument, "ArmCommand.num_joints");
  }
  for (const double tau : command.tau_cmd) {
    if (!std::isfinite(tau)) {
      return Status(StatusCode::kNonFinite, "ArmCommand.tau_cmd");
    }
  }
  return DoWrite(command);
}

}  // namespace fovea::hal
