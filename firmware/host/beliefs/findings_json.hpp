// SPDX-License-Identifier: Apache-2.0
// A run's findings for summary.json.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "firmware/host/beliefs/belief.hpp"

namespace fovea::beliefs {

// {"views": 240, "misfit": 1.1, "windows": 80, "verdict": [...], "values": {"latency": {"key":
// "camera.latency_ms", "unit": "ms", "known": true, "difference": 18.1, "sigma": 0.4}, ...}}. The numbers of
// an unknown value are null. "learnt": [{"t_s": 0.75, "key": "servo.stamp_offset", ...}], the corrections.
nlohmann::ordered_json ToJson(const Findings& findings);

}  // namespace fovea::beliefs
