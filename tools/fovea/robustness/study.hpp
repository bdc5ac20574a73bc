// SPDX-License-Identifier: Apache-2.0
// The runs of a robustness study: from random starts, a specification's quantities differ together or one at
// a time.
#pragma once

#include <vector>

#include "tools/fovea/atlas/batch.hpp"
#include "tools/fovea/robustness/results.hpp"

namespace fovea::robustness {

// Simulates `runs` starts at each of `sizes`. InputError before the first run: the simulator refuses a size.
std::vector<SizeFigures> RunSizes(atlas::Batch& batch, const Spec& spec, const std::vector<double>& sizes,
                                  int runs);

// Simulates `runs` starts without and with all quantities, and the first `starts` of these with each bar
// alone; `with_margins`: also the margins, from the starts that converge without a difference. InputError
// before the first run: the simulator refuses the specification, or BarsOf does.
Tornado RunTornado(atlas::Batch& batch, const Spec& spec, int runs, int starts, bool with_margins);

}  // namespace fovea::robustness
