// SPDX-License-Identifier: Apache-2.0
// Wake-up latency by cyclictest (rt-tests), the usual tool for it, if it is installed.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace fovea::bench {

// Whether the program is in PATH.
bool HasCyclictest();

// The latencies [us] of one cyclictest thread over `periods` of 1 ms. `policy`: "fifo" (at priority 80) or
// "other". `cpu`: the processor it is bound to; below 0: any. cyclictest counts whole microseconds; each
// latency is the middle of its microsecond. nullopt when cyclictest fails, e.g. without the privilege.
std::optional<std::vector<double>> RunCyclictest(int periods, const std::string& policy, int cpu);

// The latencies [us] of one thread from the text of cyclictest's --json file; nullopt when it is invalid.
std::optional<std::vector<double>> ReadCyclictest(const std::string& text);

}  // namespace fovea::bench
