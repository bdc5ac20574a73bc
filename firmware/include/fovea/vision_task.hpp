// SPDX-License-Identifier: Apache-2.0
// The camera-rate task: frames in, measurements out.
#pragma once

#include "firmware/vision/detect/vision_task.hpp"  // IWYU pragma: export
