// SPDX-License-Identifier: Apache-2.0
// The joints' readings of a run's last minute, at any time between two of them.
#pragma once

#include <cstdint>
#include <deque>

#include "firmware/core/model/types.hpp"

namespace fovea::beliefs {

struct JointMotion {
  model::VecN q;
  model::VecN dq;
};

class JointTrack {
 public:
  static constexpr std::int64_t kKeptNs = 60 * hal::kNsPerSecond;

  // `stamp_ns`: later than the one before; another one is ignored.
  void Add(std::int64_t stamp_ns, const model::VecN& q);

  // q, interpolated, and dq, the mean over 10 ms. False if the readings do not reach that far.
  [[nodiscard]] bool At(std::int64_t stamp_ns, JointMotion& motion) const;

  // Stamps of the first and the last reading; 0 if there is none.
  [[nodiscard]] std::int64_t first_ns() const { return readings_.empty() ? 0 : readings_.front().stamp_ns; }
  [[nodiscard]] std::int64_t last_ns() const { return readings_.empty() ? 0 : readings_.back().stamp_ns; }

 private:
  struct Reading {
    std::int64_t stamp_ns = 0;
    model::VecN q;
  };
  [[nodiscard]] model::VecN Interpolated(std::int64_t stamp_ns) const;

  std::deque<Reading> readings_;
};

}  // namespace fovea::beliefs
