// SPDX-License-Identifier: Apache-2.0
// Calibration of camera and hand-eye, before any run.
#pragma once

#include "firmware/host/calibration/board.hpp"        // IWYU pragma: export
#include "firmware/host/calibration/calibration.hpp"  // IWYU pragma: export
