// SPDX-License-Identifier: Apache-2.0
// The servo at the end of a serial line.
#pragma once

#include "firmware/core/link/messages.hpp"      // IWYU pragma: export
#include "firmware/core/link/servo_server.hpp"  // IWYU pragma: export
