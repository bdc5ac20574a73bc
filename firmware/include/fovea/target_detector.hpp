// SPDX-License-Identifier: Apache-2.0
// Detects the target in a picture.
#pragma once

#include "firmware/vision/detect/target_detector.hpp"  // IWYU pragma: export
