#include "sim/faults/frame_faults.hpp"

#include "sim/faults/chance.hpp"

namespace fovea::sim {

std::optional<Exposure> FrameSpoiler::Spoil(const Exposure& exposure) {
  if (faults_.loss.window.Contains(exposure.stamp_ns) &&
      Chance(faults_.seed, exposure.sequence) < faults_.loss.share) {
    return std::nullopt;
  }
  if (!faults_.freeze.Contains(exposure.stamp_ns)) {
    return exposure;
  }
  if (!frozen_) {
    frozen_ = exposure;
  }
  Exposure again = *frozen_;
  again.sequence = exposure.sequence;
  again.stamp_ns = exposure.stamp_ns;
  return again;
}

std::int64_t FrameSpoiler::DelayNs(std::int64_t stamp_ns) const {
  return faults_.late.window.Contains(stamp_ns) ? faults_.late.by_ns : 0;
}

}  // namespace fovea::sim
