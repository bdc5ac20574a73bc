// SPDX-License-Identifier: Apache-2.0
// The loop around the servo: reads the arm, steps the task, writes the arm.
#pragma once

#include "firmware/core/task/servo_loop.hpp"  // IWYU pragma: export
