// SPDX-License-Identifier: Apache-2.0
// The visual features: s and L_s of each target.
#pragma once

#include "firmware/core/features/target_feature.hpp"  // IWYU pragma: export
