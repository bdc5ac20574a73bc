// SPDX-License-Identifier: Apache-2.0
// Reads an arm from its files.
#pragma once

#include "firmware/host/robots/robot.hpp"  // IWYU pragma: export
