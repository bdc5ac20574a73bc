// SPDX-License-Identifier: Apache-2.0
// Observes the stages of a tick from outside.
#pragma once

#include "firmware/core/task/stage_probe.hpp"  // IWYU pragma: export
