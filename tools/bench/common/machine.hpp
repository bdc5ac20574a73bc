// What of a machine decides whether it holds 1 kHz.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fovea::bench {

struct MachineFacts {
  std::string kernel;
  std::string processor;
  int cores = 0;
  std::vector<std::string> limits;  // what stands in the way, in words that say what to do
};

// `missing` is what MakeThreadRealtime could not have. `kept_awake`: it was asked to keep the processor
// awake.
MachineFacts LookAtMachine(const std::vector<std::string>& missing, bool kept_awake);

// How the processors' time went, by the kernel's own account (/proc/stat), since the first call of Start.
class ProcessorTime {
 public:
  ProcessorTime();
  // Of all processors' time until now, 0 to 1: what the virtual machine's host took away, and what processes
  // other than this one and its children had.
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

// What `shares` say in words, one line each; none where they are small.
std::vector<std::string> InWords(const ProcessorTime::Shares& shares);

}  // namespace fovea::bench
