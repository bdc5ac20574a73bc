// SPDX-License-Identifier: Apache-2.0
// The results of a robustness study for atlas.html.
#pragma once

#include <string>
#include <vector>

#include "tools/fovea/robustness/results.hpp"

namespace fovea::robustness {

// The main parts of the page; AtlasPage::Wrap completes it.
std::string ToHtml(const Spec& spec, const std::vector<SizeFigures>& sizes);
std::string ToHtml(const Spec& spec, const std::vector<Tornado>& targets);

}  // namespace fovea::robustness
