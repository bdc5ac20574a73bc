// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/disc_tilt_barrier.hpp"

#include <cmath>

namespace fovea::barriers {

Barrier DiscTiltBarrier(const config::GuardConfig& guard, const model::Vec3& p_CO_C,
                        const model::Vec3& normal_C, const model::Mat6N& J_C) noexcept {
  Barrier barrier;
  if (guard.view.disc_cosine_min <= 0.0) {
    return barrier;
  }
  const double distance = p_CO_C.norm();
  const model::Vec3 ray = p_CO_C / distance;
  const double cosine = normal_C.dot(ray);
  if (!(distance > 0.0) || !std::isfinite(cosine)) {
    return barrier;
  }
  // The ray turns as the camera moves: dr/dt = -(I - r r') v / distance, in axes that do not turn with it.
  const model::Vec3 across = (normal_C - cosine * ray) / distance;
  barrier.name = hal::Limit::kFieldOfView;
  barrier.value = cosine;
  barrier.gradient = -J_C.topRows<3>().transpose().lazyProduct(across);
  barrier.margin = guard.view.disc_cosine_min;
  barrier.rate = guard.barrier_rate;
  return barrier;
}

}  // namespace fovea::barriers
