// SPDX-License-Identifier: Apache-2.0
// The servo's whole state as bytes and back, and its digest, for the flight recorder.
#pragma once

#include <cstdint>

#include "firmware/core/link/messages.hpp"

namespace fovea::link {

// The requests to the servo in a tick, and the arm's answer: all inputs that a TickRecord does not hold.
struct Demand {
  hal::StatusCode arm_status = hal::StatusCode::kOk;
  task::Request request = task::Request::kNone;
  moves::MotionCommand motion;
  bool change_law = false;
  config::MotionLawKind law = config::MotionLawKind::kComputedTorque;
  config::Tuning tuning;
  trajectory::PlanPart plan;

  // True if the arm answered and nothing was requested.
  [[nodiscard]] bool IsPlain() const noexcept {
    return arm_status == hal::StatusCode::kOk && request == task::Request::kNone &&
           motion.kind == moves::MotionKind::kNone && !change_law && !tuning.IsAsked() && !plan.IsThere();
  }
};
inline constexpr std::size_t kMaxDemand = 784;  // bytes
// The key that changes and the plan's part are last, and only written if there is one: older logs end before
// them.
[[nodiscard]] Bytes Encode(const Demand& message, Storage storage) noexcept;
[[nodiscard]] bool Decode(Bytes bytes, Demand& message) noexcept;

// All state that a tick takes from the previous tick; `kMaxState` bytes are always enough. Decoding leaves
// the rest of `state` unchanged: the next tick computes it. Real-time: yes, some 30 us.
inline constexpr std::size_t kMaxState = 96 * 1024;
[[nodiscard]] Bytes Encode(const task::ServoState& state, Storage storage) noexcept;
[[nodiscard]] bool Decode(Bytes bytes, task::ServoState& state) noexcept;

// A 64-bit digest of the state after a tick of the servo with `config`. It covers the state that such a tick
// may change and that does not follow from the inputs and the rest. `measured`: the tick took a measurement,
// so that the target's filters count too. It tells states apart; it is not cryptographic. Real-time: yes.
[[nodiscard]] std::uint64_t DigestOf(const config::ServoConfig& config, const task::ServoState& state,
                                     bool measured) noexcept;

// The first group of fields in which the states differ; null: none. Real-time: no.
[[nodiscard]] const char* FirstDifference(const task::ServoState& a, const task::ServoState& b,
                                          Storage storage_a, Storage storage_b) noexcept;

}  // namespace fovea::link
