// SPDX-License-Identifier: Apache-2.0
// Instructions per tick, counted by valgrind's callgrind. The count does not depend on the machine's load.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/bench/tick/inputs.hpp"

namespace fovea::bench {

// Call it in the process under valgrind. Runs all `cases`, the ticks of `mode` inside the function where
// callgrind counts, and prints the number of these ticks. `traced`: each tick adds its spans to a timeline,
// as in `fovea-sim run --trace`. `recorded`: the flight recorder runs too, as in every run with a log.
void RunCounted(const std::vector<TickCase>& cases, const std::string& mode, bool traced, bool recorded);

// Runs this program again under valgrind, with `arguments` and `--count MODE`. Returns the mean number of
// instructions per tick of `mode`, nullopt when no tick has that mode. std::runtime_error when valgrind is
// not installed or fails.
std::optional<double> CountInstructions(const std::vector<std::string>& arguments, const std::string& mode);

}  // namespace fovea::bench
