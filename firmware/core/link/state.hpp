// The servo's whole state as bytes and back, and its digest: what a flight recorder keeps of it.
#pragma once

#include <cstdint>

#include "firmware/core/link/messages.hpp"

namespace fovea::link {

// What is asked of the servo in a tick, and how the arm answered: of its inputs all that a TickRecord does
// not hold.
struct Demand {
  hal::StatusCode arm_status = hal::StatusCode::kOk;
  task::Request request = task::Request::kNone;
  moves::MotionCommand motion;
  bool change_law = false;
  config::MotionLawKind law = config::MotionLawKind::kComputedTorque;

  // The arm answered, and nothing was asked.
  [[nodiscard]] bool IsPlain() const noexcept {
    return arm_status == hal::StatusCode::kOk && request == task::Request::kNone &&
           motion.kind == moves::MotionKind::kNone && !change_law;
  }
};
inline constexpr std::size_t kMaxDemand = 320;  // bytes
[[nodiscard]] Bytes Encode(const Demand& message, Storage storage) noexcept;
[[nodiscard]] bool Decode(Bytes bytes, Demand& message) noexcept;

// All of the state that a tick takes from the tick before; `kMaxState` bytes hold any. Decoding leaves the
// rest of `state` as it is: the next tick computes it anew. Real-time: yes, some 30 us.
inline constexpr std::size_t kMaxState = 96 * 1024;
[[nodiscard]] Bytes Encode(const task::ServoState& state, Storage storage) noexcept;
[[nodiscard]] bool Decode(Bytes bytes, task::ServoState& state) noexcept;

// 64 bits of the state after a tick of the servo with `config`: of all in it that a tick like this one may
// change, and that does not follow from the inputs and the rest. `measured`: the tick took a measurement, and
// the target's filters count too. For telling states apart, not for keeping secrets. Real-time: yes.
[[nodiscard]] std::uint64_t DigestOf(const config::ServoConfig& config, const task::ServoState& state,
                                     bool measured) noexcept;

// The first group of fields in which the states differ; null: none. Real-time: no.
[[nodiscard]] const char* FirstDifference(const task::ServoState& a, const task::ServoState& b,
                                          Storage storage_a, Storage storage_b) noexcept;

}  // namespace fovea::link
