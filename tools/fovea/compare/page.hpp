// SPDX-License-Identifier: Apache-2.0
// A comparison as one self-contained HTML page.
#pragma once

#include <string>

#include "tools/fovea/compare/comparison.hpp"

namespace fovea::compare {

// `figures`: the comparison by ToJson. std::runtime_error when a part of the page is missing.
std::string MakePage(const std::string& log, const Comparison& comparison, const std::string& figures);

}  // namespace fovea::compare
