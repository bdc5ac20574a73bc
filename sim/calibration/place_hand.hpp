// SPDX-License-Identifier: Apache-2.0
// Inverse kinematics for pictures from given camera poses.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "firmware/core/model/arm_model.hpp"
#include "sim/robot/chain.hpp"

namespace fovea::sim {

// Joint positions that place the hand of `chain` at `X_BE`, to a nanometre and a nanoradian. Takes damped
// Gauss-Newton steps from `q` inside the joints' range. None if it does not converge.
std::optional<Eigen::VectorXd> PlaceHand(const Chain& chain, const model::ArmModel& limits, Eigen::VectorXd q,
                                         const Eigen::Isometry3d& X_BE);

}  // namespace fovea::sim
