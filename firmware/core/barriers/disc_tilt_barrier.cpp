#include "firmware/core/barriers/disc_tilt_barrier.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::barriers {
namespace {

constexpr double kRate = 1.5;  // as field_of_view_barrier.cpp has it [1/s]

}  // namespace

void LimitTilt(double cosine_min, const model::Vec3& p_CO_C, const model::Vec3& normal_C,
               const model::Mat6N& J_C, MotionLimits& limits) noexcept {
  if (cosine_min <= 0.0) {
    return;
  }
  const double distance = p_CO_C.norm();
  const model::Vec3 ray = p_CO_C / distance;
  const double cosine = normal_C.dot(ray);
  if (!(distance > 0.0) || !std::isfinite(cosine)) {
    return;
  }
  // The ray turns as the camera moves: dr/dt = -(I - r r') v / distance, in axes that do not turn with it.
  const model::Vec3 across = (normal_C - cosine * ray) / distance;
  limits.AddRow(J_C.topRows<3>().transpose().lazyProduct(across),
                std::max(kRate * (cosine - cosine_min), 0.0));
}

}  // namespace fovea::barriers
