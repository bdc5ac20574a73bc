// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/camera_pull.hpp"

#include "firmware/core/model/cholesky.hpp"

namespace fovea::control {
namespace {

constexpr double kPullDamping = 1e-4;  // of J J^T [m^2, rad^2]

}  // namespace

model::Mat6N CameraPull(const model::Mat6N& J_C) noexcept {
  model::Mat6N pull = J_C;
  model::Mat6 A = J_C.lazyProduct(J_C.transpose());
  A.diagonal().array() += kPullDamping;
  model::FactorCholesky(A);
  model::SolveCholesky(A, pull);
  return pull;
}

}  // namespace fovea::control
