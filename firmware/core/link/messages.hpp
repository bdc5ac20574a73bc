// SPDX-License-Identifier: Apache-2.0
// The frames' payloads: the servo's configuration, inputs and outputs, as bytes and back.
//
// Decode returns false, and `message` must not be used, if bytes are missing or left over, a count exceeds
// its capacity, or a choice is not in the list. Values pass unchanged, non-finite ones included; their user
// checks them, as at the seam. Real-time: yes, all functions.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/arm_model.hpp"
#include "firmware/core/model/load.hpp"
#include "firmware/core/task/servo_task.hpp"
#include "firmware/core/task/stage_probe.hpp"
#include "fovea/hal/arm.hpp"
#include "fovea/hal/record.hpp"
#include "fovea/hal/status.hpp"

namespace fovea::link {

// Who drives the ticks.
enum class Pacing : std::uint8_t {
  kLockstep,  // each Inputs frame is one tick; a repeated one is answered twice and stepped once
  kTimer,     // the servo's own clock, 1 kHz; a tick without a new Inputs frame has no arm state
  kGated,  // as kTimer, but the clock stands from each tick's end until the host sends Go: for a simulator as
           // host, whose millisecond may take any time
};
inline constexpr int kNumPacings = 3;

struct Configuration {
  Pacing pacing = Pacing::kLockstep;
  bool may_provoke = false;   // accept Provoke frames
  std::uint32_t arm_crc = 0;  // ArmCrc of the arm with its load; the servo's own must be equal
  model::Load load;
  config::ServoConfig servo;  // without `arm`: the servo has the arm's model as a constant
};

// kOk, or the error and where: the first kWhere - 1 characters of Status::where.
struct Answer {
  static constexpr std::size_t kWhere = 48;
  hal::StatusCode code = hal::StatusCode::kOk;
  std::array<char, kWhere> where{};
};

inline constexpr std::size_t kNumStages = task::kStageNames.size();

// Losses on the line since the servo was configured; lost bytes and unsent frames: since its start.
struct LineCounters {
  std::uint32_t damaged_frames = 0;  // counted by the servo's reader
  std::uint32_t late_frames = 0;     // with the timer: overtaken, or too old to be used
  std::uint32_t silent_ticks = 0;    // with the timer: without a new Inputs frame
  std::uint32_t missed_ticks = 0;    // with the timer: periods that passed without a tick
  std::uint32_t lost_bytes = 0;      // received faster than taken
  std::uint32_t unsent_frames = 0;   // without room to be sent
  bool operator==(const LineCounters&) const = default;
};

// One tick's outputs without the host's own inputs, and the time that the tick took.
struct Outputs {
  hal::TickRecord record;                                // `arm`, `has_feature` and `feature` are not sent
  std::array<std::uint32_t, kNumStages> stage_counts{};  // of the timer, from one stage's end to the next's
  std::uint32_t tick_counts = 0;                         // of the timer, the whole of Step
  std::uint32_t link_counts = 0;     // of the timer, for the line, since the previous tick
  std::uint32_t periods_passed = 0;  // with the timer: while the tick was computed
  std::uint32_t stack_bytes = 0;     // the largest stack depth so far
  LineCounters line;
};

// Registers of a fault that the processor took.
struct Crash {
  std::uint32_t exception = 0;  // its number: 3 hard, 4 memory, 5 bus, 6 usage fault
  std::uint32_t cfsr = 0;
  std::uint32_t hfsr = 0;
  std::uint32_t pc = 0;
  std::uint32_t lr = 0;
};

enum class Provocation : std::uint8_t { kUsageFault };  // floating point with the FPU switched off

// The CRC of an arm's model, in the order of its fields.
[[nodiscard]] std::uint32_t ArmCrc(const model::ArmModel& arm) noexcept;

// The bytes lie in `storage`; none if they do not fit. kMaxPayload is enough for any message.
using Bytes = std::span<const std::uint8_t>;
using Storage = std::span<std::uint8_t>;
[[nodiscard]] Bytes Encode(const Configuration& message, Storage storage) noexcept;
[[nodiscard]] Bytes Encode(const Answer& message, Storage storage) noexcept;
[[nodiscard]] Bytes Encode(const task::ServoInputs& message, Storage storage) noexcept;
[[nodiscard]] Bytes Encode(const Outputs& message, Storage storage) noexcept;
[[nodiscard]] Bytes Encode(const Crash& message, Storage storage) noexcept;
[[nodiscard]] Bytes Encode(Provocation message, Storage storage) noexcept;
[[nodiscard]] bool Decode(Bytes bytes, Configuration& message) noexcept;
[[nodiscard]] bool Decode(Bytes bytes, Answer& message) noexcept;
[[nodiscard]] bool Decode(Bytes bytes, task::ServoInputs& message) noexcept;
[[nodiscard]] bool Decode(Bytes bytes, Outputs& message) noexcept;
[[nodiscard]] bool Decode(Bytes bytes, Crash& message) noexcept;
[[nodiscard]] bool Decode(Bytes bytes, Provocation& message) noexcept;

}  // namespace fovea::link
