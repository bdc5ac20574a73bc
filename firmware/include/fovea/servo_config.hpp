// Everything that can be set about the servo.
#pragma once

#include "firmware/core/config/servo_config.hpp"  // IWYU pragma: export
