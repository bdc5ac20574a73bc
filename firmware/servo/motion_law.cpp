#include "fovea/servo/motion_law.hpp"

namespace fovea::servo {

void MotionLaw(const MotionLawConfig& config, const model::ArmDynamics& dynamics, const Reference& reference,
               const model::VecN& q, const model::VecN& dq, model::VecN& tau) noexcept {
  const double k_p = config.omega_n * config.omega_n;
  const double k_v = 2.0 * config.zeta * config.omega_n;
  const model::VecN wanted = reference.ddq + k_v * (reference.dq - dq) + k_p * (reference.q - q);
  tau = dynamics.Cdq;
  tau += dynamics.M.lazyProduct(wanted);
}

void DampedStop(double damping, const model::ArmDynamics& dynamics, const model::VecN& dq,
                model::VecN& tau) noexcept {
  tau = dynamics.M.lazyProduct(dq);
  tau *= -damping;
}

}  // namespace fovea::servo
