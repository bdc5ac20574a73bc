// SPDX-License-Identifier: Apache-2.0
// Carries tick records out of the real-time thread.
#pragma once

#include <cstdint>

#include "fovea/hal/record.hpp"
#include "fovea/linux_rt/bounded_ring.hpp"

namespace fovea::linux_rt {

class RecordRing final : public hal::Recorder {
 public:
  // Room for `capacity` records [>= 1].
  explicit RecordRing(std::size_t capacity) : ring_(capacity) {}

  // From the real-time thread.
  void Record(const hal::TickRecord& record) noexcept override { ring_.Push(record); }

  // From one other thread: calls `take(record)` for every record that is there, oldest first.
  template <typename Take>
  void Drain(Take&& take) {
    ring_.Drain(ring_.End(), take);
  }

  [[nodiscard]] std::uint64_t dropped() const noexcept { return ring_.dropped(); }

 private:
  BoundedRing<hal::TickRecord> ring_;
};

}  // namespace fovea::linux_rt
