// SPDX-License-Identifier: Apache-2.0
// Keeps the moments of the last exposures, one per step, until each exposure has ended.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "sim/render/exposure.hpp"

namespace fovea::sim {

class ExposureHistory {
 public:
  // `reach_ns`: from an exposure's middle to its end; as long before the middle it begins. 0: an exposure is
  // one moment.
  explicit ExposureHistory(std::int64_t reach_ns) : reach_ns_(reach_ns) {}

  // Adds the present; later than all before.
  void Add(Moment now);
  // The present is the middle of the exposure of frame `sequence`.
  void Begin(std::uint64_t sequence);
  // The oldest exposure that has ended and was not taken; with `around` if it is longer than a moment. An
  // exposure that began before the first moment has less around it.
  [[nodiscard]] std::optional<Exposure> TakeEnded();

 private:
  const std::int64_t reach_ns_;
  std::deque<Moment> past_;       // of the last two reaches and a step, the present last
  std::deque<Exposure> running_;  // that have not ended, oldest first
};

}  // namespace fovea::sim
