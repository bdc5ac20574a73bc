// Instructions per tick, counted by valgrind's callgrind: the same number whatever else the machine does.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/bench/tick/inputs.hpp"

namespace fovea::bench {

// In the process that valgrind watches: runs all `cases`, the ticks of `mode` where they are counted; prints
// how many they were. `traced`: each leaves its spans on a timeline, as in `fovea-sim run --trace`;
// `recorded`: the flight recorder stands around it, as in every run that leaves a log.
void RunCounted(const std::vector<TickCase>& cases, const std::string& mode, bool traced, bool recorded);

// Runs this program again under valgrind, `arguments` before `--count MODE`. The mean per tick of `mode`;
// nothing when no tick was of that mode. Throws std::runtime_error when valgrind is not there or fails.
std::optional<double> CountInstructions(const std::vector<std::string>& arguments, const std::string& mode);

}  // namespace fovea::bench
