// The well-known measure of wake-up latency, where the machine has it: cyclictest of rt-tests.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace fovea::bench {

// Whether the program is in PATH.
bool HasCyclictest();

// The latencies [us] of `periods` of 1 ms by one thread of cyclictest, under `policy` ("fifo" at priority 80,
// or "other"), bound to processor `cpu` where that is not below 0. It counts whole microseconds; the middle
// of each stands for all of its. Nothing when it would not run, e.g. for want of a privilege.
std::optional<std::vector<double>> RunCyclictest(int periods, const std::string& policy, int cpu);

// What cyclictest's --json file says of one thread, as latencies [us]; nothing when it is none.
std::optional<std::vector<double>> ReadCyclictest(const std::string& text);

}  // namespace fovea::bench
