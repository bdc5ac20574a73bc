// SPDX-License-Identifier: Apache-2.0
// Commanded motions: goals and streams of setpoints.
#pragma once

#include "firmware/core/moves/motion_command.hpp"  // IWYU pragma: export
