// SPDX-License-Identifier: Apache-2.0
// Replay: runs the servo again on the recorded inputs of a log.
//
// A log consists of segments. A segment begins at the servo's first tick or at a keyframe and lasts until a
// tick is missing; ticks between a gap and the next keyframe cannot be replayed. Only the build that wrote a
// keyframe can use it. Any build can replay from the first tick.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::log {
class Tick;
}

namespace fovea::flight {

struct ReplayOptions {
  std::map<std::string, std::string> build;  // BuildEntries() of this program
  // 0: begin at the first tick; else at the first keyframe at or after this time since it [s].
  double from_s = 0.0;
  // Returns another configuration for an open-loop replay: the servo gets the inputs that the recorded
  // configuration caused. In each tick its reference starts at the recorded position, because the arm went
  // there; velocities, accelerations and torques are its own. Empty: the recorded configuration.
  std::function<config::ServoConfig(const config::ServoConfig&)> change;
  // Called for every replayed tick: the recorded message, the replayed message, and the servo's own record of
  // the replay. May be empty.
  std::function<void(const log::Tick& recorded, const log::Tick& replayed, const hal::TickRecord& record)>
      on_tick;
};

// The first difference in a segment.
struct Divergence {
  std::uint64_t tick = 0;
  std::int64_t stamp_ns = 0;
  std::string field;  // of the record; "state_digest" when the outputs are still the same
  std::string recorded;
  std::string replayed;
  std::string state_group;  // what differs at the next keyframe; "": nothing, or no keyframe
};

struct Segment {
  std::uint64_t first_tick = 0;
  std::uint64_t last_tick = 0;
  std::int64_t first_ns = 0;
  std::int64_t last_ns = 0;
  bool from_keyframe = false;
  std::string not_replayed;  // the reason; "": the segment was replayed
  std::optional<Divergence> divergence;
  [[nodiscard]] std::uint64_t ticks() const { return last_tick - first_tick + 1; }
};

// The differences of one field over the whole log.
struct FieldChange {
  std::string field;
  std::uint64_t ticks = 0;  // in which it differs
  std::uint64_t first_tick = 0;
  std::int64_t first_ns = 0;
  double most = 0.0;  // the largest difference; infinity: it is not a finite number
  std::int64_t most_ns = 0;
};

struct ReplayResult {
  std::vector<Segment> segments;
  std::vector<FieldChange> changes;  // in the order in which the fields began to differ
  std::uint64_t ticks_lost = 0;      // between segments
  std::int64_t start_ns = 0;         // stamp of the log's first tick
  bool same_build = false;           // of the servo library and the link library
  bool complete = false;             // as log::McapEnd
  std::string why_incomplete;
  [[nodiscard]] bool Identical() const;       // something was replayed, and nothing differs
  [[nodiscard]] std::uint64_t ticks() const;  // replayed
};

// std::runtime_error, naming the log: it cannot be read, or holds nothing to replay.
ReplayResult Replay(const std::filesystem::path& log, const ReplayOptions& options);

}  // namespace fovea::flight
