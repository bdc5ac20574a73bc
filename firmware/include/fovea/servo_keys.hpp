// SPDX-License-Identifier: Apache-2.0
// The keys of servo, camera, target and vision.
#pragma once

#include "firmware/host/config/camera_keys.hpp"  // IWYU pragma: export
#include "firmware/host/config/servo_keys.hpp"   // IWYU pragma: export
#include "firmware/host/config/target_keys.hpp"  // IWYU pragma: export
#include "firmware/host/config/vision_keys.hpp"  // IWYU pragma: export
