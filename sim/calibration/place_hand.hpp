// Joints that bring the hand to a pose, for pictures that are taken from given places.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "firmware/core/model/arm_model.hpp"
#include "sim/robot/chain.hpp"

namespace fovea::sim {

// From `q` on, by damped Gauss-Newton steps inside the joints' range, until the hand of `chain` stands at
// `X_BE` to a nanometre and a nanoradian; none when it does not come there.
std::optional<Eigen::VectorXd> PlaceHand(const Chain& chain, const model::ArmModel& limits, Eigen::VectorXd q,
                                         const Eigen::Isometry3d& X_BE);

}  // namespace fovea::sim
