// SPDX-License-Identifier: Apache-2.0
// Detects a picture that does not change although the hand moves. A camera that repeats one picture shows a
// target that seems to move with the hand. If that counted as a measurement, its motion would be fed forward
// and drive the hand on without end.
//
// The vision task reports how long the picture has been the same. The encoders show how the camera moved
// meanwhile, and so how far a scene at rest must have shifted in the picture. If that shift is large enough
// to be visible, one of two cases holds: the target is at rest in B and the picture should have changed, or
// it is at rest in C. The case nearer to the measurement counts: to a flat target's corners, which show a
// turn, too, or to the other targets' direction and, with less weight, their depth.
//
// A target that the hand follows without error in front of a plain background also counts as stuck. The arm
// then stops, and the target moves in the picture again.
#pragma once

#include <cstdint>

#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::estimate {

// The first measurement with the present picture.
struct StuckPicture {
  bool started = false;
  std::int64_t since_ns = 0;
  model::Pose X_BC;
  model::Vec3 p_CO_C = model::Vec3::Zero();  // as it was measured then [m]
  features::SeenCorners::Vector xy;          // a flat target's corners then
};

struct PictureView {
  std::int64_t since_ns = 0;  // start of the present picture; equal to the measurement's stamp: it changed
  model::Pose X_BC_since;     // the camera's pose then
  model::Pose X_BC;           // at the measurement's stamp
  model::Vec3 p_CO_C;         // the target as measured [m]
  const features::SeenCorners::Vector& xy;  // a flat target's corners in the normalised image; else empty
};

// True if the picture is stuck, from `view` and the measurements before. `stuck_shift`: in the normalised
// image. Real-time: yes.
[[nodiscard]] bool IsStuck(double stuck_shift, const PictureView& view, StuckPicture& picture) noexcept;

}  // namespace fovea::estimate
