// SPDX-License-Identifier: Apache-2.0
// Reads keys and values from files and command lines.
#pragma once

#include "firmware/host/config/key_table.hpp"  // IWYU pragma: export
#include "firmware/host/config/settings.hpp"   // IWYU pragma: export
