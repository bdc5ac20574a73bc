// SPDX-License-Identifier: Apache-2.0
// An arm's kinematics and dynamics.
#pragma once

#include "firmware/core/model/arm_model.hpp"   // IWYU pragma: export
#include "firmware/core/model/dynamics.hpp"    // IWYU pragma: export
#include "firmware/core/model/kinematics.hpp"  // IWYU pragma: export
#include "firmware/core/model/load.hpp"        // IWYU pragma: export
