// SPDX-License-Identifier: Apache-2.0
// The 1 kHz servo task.
#pragma once

#include "firmware/core/task/servo_task.hpp"  // IWYU pragma: export
