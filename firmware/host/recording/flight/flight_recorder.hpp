// SPDX-License-Identifier: Apache-2.0
// Records the data of every tick that a replay needs: the inputs, the outputs, a digest of the servo's state
// after the tick, and each second the whole state before a tick (a keyframe).
//
// The recorder wraps the servo's Step and is also the loop's recorder. The data goes through bounded rings to
// one other thread. Records that do not fit are dropped and counted; the tick never waits.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/core/link/state.hpp"
#include "firmware/core/task/servo_task.hpp"
#include "fovea/hal/record.hpp"
#include "fovea/linux_rt/bounded_ring.hpp"

namespace fovea::flight {

struct FlightRecord {
  hal::TickRecord record;
  link::Demand demand;
  std::optional<std::uint64_t> state_digest;
};

struct Keyframe {
  std::uint64_t tick = 0;  // the next tick
  task::ServoState state;  // before that tick
};

class FlightRecorder final : public task::ServoStep, public hal::Recorder {
 public:
  static constexpr std::uint64_t kKeyframeTicks = 1000;

  // Room for `capacity` records [>= 1]. Borrows both. `task`: the servo behind `step`. Null when that servo
  // runs on another processor: then there are no digests and no keyframes.
  FlightRecorder(task::ServoStep& step, const task::ServoTask* task, std::size_t capacity);

  // From the real-time thread. Real-time: yes; a keyframe takes some 15 us.
  void Step(const task::ServoInputs& inputs, task::ServoOutputs& outputs) noexcept override;
  void Record(const hal::TickRecord& record) noexcept override;

  // From one other thread: calls `take_keyframe(keyframe)` and `take(record)` for all waiting entries, the
  // keyframe of a tick before its record.
  template <typename Take, typename TakeKeyframe>
  void Drain(Take&& take, TakeKeyframe&& take_keyframe) {
    const std::uint64_t end = records_.End();
    keyframes_.Drain(keyframes_.End(), take_keyframe);
    records_.Drain(end, take);
  }

  // Records dropped for lack of room. (A dropped keyframe does not count: the next one follows in a second.)
  [[nodiscard]] std::uint64_t dropped() const noexcept { return records_.dropped(); }

 private:
  task::ServoStep& step_;
  const task::ServoTask* task_;
  link::Demand demand_;  // of the current tick
  linux_rt::BoundedRing<FlightRecord> records_;
  linux_rt::BoundedRing<Keyframe> keyframes_;
};

}  // namespace fovea::flight
