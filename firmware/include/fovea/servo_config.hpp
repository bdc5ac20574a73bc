// SPDX-License-Identifier: Apache-2.0
// All settings of the servo.
#pragma once

#include "firmware/core/config/servo_config.hpp"  // IWYU pragma: export
