// SPDX-License-Identifier: Apache-2.0
// Rolling shutter: moves a measurement to the time of its stamp.
//
// The rows of the sensor are exposed one after the other: row y of the normalised image
//
//   delta(y) = row_time (y - row_y)
//
// after the stamp. While camera and target move, each point of an outline is therefore seen at another time.
// To first order a point was at s - s' delta(y) at the stamp, with its image velocity s' (Ait-Aider, Andreff,
// Lavest and Martinet, Simultaneous object pose and velocity computation using a single view from a rolling
// shutter camera, 2006). The camera's motion is known from the encoders: its part is removed from a
// measurement here. The target's velocity is a state of the filters, so they model its part with its
// uncertainty. The lens is ignored: a point's row is taken from where an ideal lens shows it.
#pragma once

#include "firmware/core/config/predict_config.hpp"
#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::estimate {

// The target as the camera sees it: a point p of it moves by v + w x (p - p_CO_C), in axes of C.
struct MotionInCamera {
  model::Pose X_CO;
  model::Vec3 v = model::Vec3::Zero();  // of its centre [m/s]
  model::Vec3 w = model::Vec3::Zero();  // [rad/s]
};

// The motion of a target with velocity `v_BO_B` and angular velocity `w_BO_B` in axes of B [m/s, rad/s], seen
// from a camera at `X_BC` with twist `V_BC_C` [v; w]. Real-time: yes.
[[nodiscard]] MotionInCamera SeenFrom(const model::Pose& X_BC, const model::Vec6& V_BC_C,
                                      const model::Pose& X_CO, const model::Vec3& v_BO_B,
                                      const model::Vec3& w_BO_B) noexcept;

// A sphere of `radius` at `p_CO_C` that moves by v in C: times v, this is how far its measured centre is off
// its place at the stamp [s]. The measured centre fits the shifted outline best. Zero if the camera is within
// the sphere. Real-time: yes.
[[nodiscard]] model::Mat3 SphereShiftByVelocity(const config::PredictConfig& config, double radius,
                                                const model::Vec3& p_CO_C) noexcept;

// The same for a disc's centre. The disc's seen size and tilt are not corrected. Real-time: yes.
[[nodiscard]] model::Mat3 DiscShiftByVelocity(const config::PredictConfig& config,
                                              const model::Vec3& p_CO_C) noexcept;

// Moves the corners [2 n] of a flat target, whose plane is that of `target`, to where they were at the stamp.
// A corner that is not in front of the camera stays. Real-time: yes.
void MoveCornersToStamp(const config::PredictConfig& config, const MotionInCamera& target,
                        features::SeenCorners::Vector& xy) noexcept;

}  // namespace fovea::estimate
