// SPDX-License-Identifier: Apache-2.0
// A comparison as a table and as JSON.
#pragma once

#include <string>
#include <vector>

#include "tools/fovea/compare/comparison.hpp"

namespace fovea::compare {

std::string ToText(const std::string& log, const Comparison& comparison);
std::string ToJson(const std::string& log, const Comparison& comparison,
                   const std::vector<std::string>& settings);

// "friction 93 % (+0.52 Nm, +0.10 Nm s/rad), delay 5 % (4.9 ms)": the causes that explain at least a tenth of
// the torque that joint `i` lacks; "-" if there are none. Values: recorded arm less simulated one.
std::string LikelyCauses(const Comparison& comparison, std::size_t i);

}  // namespace fovea::compare
