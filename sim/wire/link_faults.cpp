#include "sim/wire/link_faults.hpp"

namespace fovea::sim {

std::int64_t FaultDice::DelayNs() {
  constexpr double kNsPerMs = 1e6;
  constexpr double kHeldBackMs = 1.5;
  double ms = faults_.delay_ms;
  if (faults_.jitter_ms > 0.0) {
    ms += faults_.jitter_ms * even_(random_);
  }
  if (Happens(faults_.reorder)) {
    ms += kHeldBackMs;
  }
  return static_cast<std::int64_t>(ms * kNsPerMs);
}

}  // namespace fovea::sim
