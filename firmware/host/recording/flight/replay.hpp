// A replay: the recorded inputs of a log, put through the servo again.
//
// A log falls into segments. One begins at the servo's first tick, or at a keyframe, and goes on as long as
// no tick is missing; what stands between a gap and the next keyframe cannot be replayed. A keyframe is used
// by the build that wrote it alone. From the first tick on any build can replay.
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
  // Another configuration in the place of the recorded one, open loop: the servo gets the inputs that the
  // other one brought about. Its reference goes on from where the recorded one is, since that is where the
  // arm went; velocities, accelerations and torques are its own. Empty: the recorded one.
  std::function<config::ServoConfig(const config::ServoConfig&)> change;
  // Every tick that was replayed: as it was recorded, and as it was now, as a message and as the servo's own
  // record. May be empty.
  std::function<void(const log::Tick& recorded, const log::Tick& replayed, const hal::TickRecord& record)>
      on_tick;
};

// The first thing in which a segment differs.
struct Divergence {
  std::uint64_t tick = 0;
  std::int64_t stamp_ns = 0;
  std::string field;  // of the record; "state_digest" when the outputs are still the same
  std::string recorded;
  std::string replayed;
  std::string state_group;  // what differs at the next keyframe; "": nothing, or there is none
};

struct Segment {
  std::uint64_t first_tick = 0;
  std::uint64_t last_tick = 0;
  std::int64_t first_ns = 0;
  std::int64_t last_ns = 0;
  bool from_keyframe = false;
  std::string not_replayed;  // why; "": it was
  std::optional<Divergence> divergence;
  [[nodiscard]] std::uint64_t ticks() const { return last_tick - first_tick + 1; }
};

// One field over all of the log.
struct FieldChange {
  std::string field;
  std::uint64_t ticks = 0;  // in which it differs
  std::uint64_t first_tick = 0;
  std::int64_t first_ns = 0;
  double most = 0.0;  // infinity: no number says by how much
  std::int64_t most_ns = 0;
};

struct ReplayResult {
  std::vector<Segment> segments;
  std::vector<FieldChange> changes;  // in the order in which the fields began to differ
  std::uint64_t ticks_lost = 0;      // between segments
  std::int64_t start_ns = 0;         // stamp of the log's first tick
  bool same_build = false;           // of the servo, and of what keeps its state
  bool complete = false;             // as log::McapEnd
  std::string why_incomplete;
  [[nodiscard]] bool Identical() const;       // all that was replayed, and something was
  [[nodiscard]] std::uint64_t ticks() const;  // replayed
};

// std::runtime_error, naming the log: it cannot be read, or holds nothing to replay.
ReplayResult Replay(const std::filesystem::path& log, const ReplayOptions& options);

}  // namespace fovea::flight
