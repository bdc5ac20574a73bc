// SPDX-License-Identifier: Apache-2.0
// Counts the limits that act while the arm moves, to say what kept it from its goal.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "firmware/core/config/guard_config.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::sim {

class ActingLimits {
 public:
  // `obstacles`: that the servo knows.
  explicit ActingLimits(const config::Obstacles& obstacles) : has_boxes_(obstacles.num_boxes > 0) {}

  void Add(const hal::TickRecord& record);

  // E.g. "; limited by field_of_view (safety.view_margin_px) in 89 % of its motion": the limits that acted in
  // at least 5 % of the ticks in motion, the longest first, each with the keys that set it; "" if none did.
  [[nodiscard]] std::string InWords() const;

  // The keys that set where a goal can be reached, e.g. "target.position, servo.goal".
  [[nodiscard]] std::string KeysOfReach() const;

 private:
  [[nodiscard]] std::string KeysOf(hal::Limit limit) const;

  bool has_boxes_;
  std::uint64_t motion_ticks_ = 0;  // in Track, Coast and Move
  std::array<std::uint64_t, hal::kNumLimits> limit_ticks_{};
};

}  // namespace fovea::sim
