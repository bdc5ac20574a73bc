// SPDX-License-Identifier: Apache-2.0
// Who may change something: one viewer at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "firmware/host/live/rate_limit.hpp"

namespace fovea::live {

class Control {
 public:
  explicit Control(std::chrono::milliseconds silence) : silence_(silence) {}

  // Gives control to `viewer` if nobody else has it. True if it has control now.
  bool Take(std::uint64_t viewer, const std::string& name, Clock::time_point now);
  // Any message of a viewer: the one that has control keeps it.
  void Hear(std::uint64_t viewer, Clock::time_point now);
  // Ends the control of `viewer`. True if it had control.
  bool End(std::uint64_t viewer);
  // Somebody has control and was silent for too long.
  [[nodiscard]] bool IsSilent(Clock::time_point now) const { return !IsFree() && now - heard_ > silence_; }

  [[nodiscard]] bool Has(std::uint64_t viewer) const { return viewer != kNobody && viewer == holder_; }
  [[nodiscard]] bool IsFree() const { return holder_ == kNobody; }
  [[nodiscard]] std::uint64_t holder() const { return holder_; }   // 0 for nobody
  [[nodiscard]] const std::string& name() const { return name_; }  // of the holder; "" for nobody

 private:
  static constexpr std::uint64_t kNobody = 0;

  const std::chrono::milliseconds silence_;
  std::uint64_t holder_ = kNobody;
  std::string name_;
  Clock::time_point heard_{};
};

}  // namespace fovea::live
