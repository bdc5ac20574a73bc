// SPDX-License-Identifier: Apache-2.0
// What a measurement becomes when the camera's focal length is not the believed one.
//
// With a focal length of f (1 + focal), a point that was believed to be at (x, y) in the normalised image is
// at (x, y) / (1 + focal).
#pragma once

#include "firmware/core/model/types.hpp"

namespace fovea::beliefs {

// The sphere s = p_CO_C / radius (firmware/core/features/sphere.hpp) for the measured `s_meas`, and its
// derivative by `focal`: the cone that fits the rays of the outline again by least squares. False if there is
// none in front of the camera.
[[nodiscard]] bool RefocusSphere(const model::Vec3& s_meas, double focal, model::Vec3& s,
                                 model::Vec3& ds_dfocal);

}  // namespace fovea::beliefs
