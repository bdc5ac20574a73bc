// The loop around the servo: reads the arm, steps the task, writes the arm.
#pragma once

#include "firmware/core/task/servo_loop.hpp"  // IWYU pragma: export
