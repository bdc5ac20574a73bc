// SPDX-License-Identifier: Apache-2.0
// The state of a run, as the channel /live/state shows it. The server adds what it knows itself: what this
// viewer may do, who has control, how many viewers there are, and what was dropped for this viewer.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fovea::live {

// Of the fault with the same index in Catalogue::faults.
struct FaultState {
  bool active = false;
  std::vector<double> values;  // of its settings, in their order; empty: those of the catalogue

  bool operator==(const FaultState&) const = default;
};

struct TargetState {
  std::array<double, 3> p_BO{};                    // [m]
  std::array<double, 4> q_BO{1.0, 0.0, 0.0, 0.0};  // w, x, y, z
  bool held = false;                               // by a viewer

  bool operator==(const TargetState&) const = default;
};

struct PullState {
  std::string link;
  std::array<double, 3> to_B{};  // [m]

  bool operator==(const PullState&) const = default;
};

struct TickTimesState {
  std::int64_t median_ns = 0;
  std::int64_t max_ns = 0;

  bool operator==(const TickTimesState&) const = default;
};

// What the run tells so far of a value that the servo believes.
struct FindingState {
  std::string name;
  std::string key;                   // of the configuration; "" if it has none
  std::string unit;                  // of the differences
  std::optional<double> configured;  // the key's value, if it is one number in `unit`
  bool known = false;                // false: this motion does not tell it
  double difference = 0.0;           // true value less the believed one
  double sigma = 0.0;

  bool operator==(const FindingState&) const = default;
};

struct State {
  double stamp_s = 0.0;  // time of the run, from its start
  double wall_s = 0.0;   // the same by the wall clock
  std::string mode;
  std::string hold_reason;  // "" where there is none; the words say it to a person
  std::string hold_reason_words;
  std::string fault;
  std::string fault_words;
  bool paused = false;
  double speed = 1.0;  // 0: as fast as it goes
  double real_time_factor = 1.0;
  bool ends = false;  // the run has ended
  std::vector<FaultState> faults;
  std::optional<TargetState> target;
  std::optional<PullState> pull;
  std::optional<TickTimesState> tick;  // durations of the servo's ticks since the last state
  std::vector<FindingState> findings;  // empty: none yet
  std::string notice;                  // one sentence for all viewers; "" where there is none

  bool operator==(const State&) const = default;
};

}  // namespace fovea::live
