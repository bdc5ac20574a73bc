// SPDX-License-Identifier: Apache-2.0
// Dry friction that holds or slows several coupled joints within a step.
#pragma once

#include <Eigen/Core>

namespace fovea::sim {

// The impulses j [Nm s, N s] of dry friction that change the speeds `v` of joints by `W` j: each |j| is at
// most `most`; a joint whose impulse is smaller comes to rest, another slides against its impulse. `W` is
// symmetric and positive definite. By projected Gauss-Seidel (Jourdan, Alart and Jean, 1998).
[[nodiscard]] Eigen::VectorXd FrictionImpulse(const Eigen::MatrixXd& W, const Eigen::VectorXd& v,
                                              const Eigen::VectorXd& most);

}  // namespace fovea::sim
