// SPDX-License-Identifier: Apache-2.0
// The properties of a machine that decide whether it keeps 1 kHz.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fovea::bench {

struct MachineFacts {
  std::string kernel;
  std::string processor;
  int cores = 0;
  std::vector<std::string> limits;  // one line per obstacle to 1 kHz, with its remedy if there is one
};

// `missing`: the privileges that MakeThreadRealtime did not get. `kept_awake`: it was asked to keep the
// processor awake.
MachineFacts LookAtMachine(const std::vector<std::string>& missing, bool kept_awake);

// How the time of all processors was used since construction, from the kernel's counters (/proc/stat).
class ProcessorTime {
 public:
  ProcessorTime();
  // Shares of the time of all processors, 0 to 1: `stolen` by the virtual machine's host, and used by
  // `others`, the processes other than this one and its children.
  struct Shares {
    double stolen = 0.0;
    double others = 0.0;
  };
  [[nodiscard]] Shares SinceStart() const;

 private:
  struct Counts {
    double total = 0.0;
    double busy = 0.0;
    double stolen = 0.0;
    double own = 0.0;
  };
  static Counts Now();
  Counts start_;
};

// One line of text for each share that is not small.
std::vector<std::string> InWords(const ProcessorTime::Shares& shares);

}  // namespace fovea::bench
