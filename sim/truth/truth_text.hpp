// SPDX-License-Identifier: Apache-2.0
// The true values of a run for summaries.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "sim/truth/truth_draw.hpp"

namespace fovea::sim {

// {"camera.latency_ms": {"unit": "ms", "believed": [40.0], "true": [58.2]}, ...}
nlohmann::ordered_json TruthAsJson(const std::vector<TrueValue>& truth);

// "camera.latency_ms by +18.2 ms"; of a list "by up to" the largest difference.
std::string InWords(const TrueValue& value);

}  // namespace fovea::sim
