// SPDX-License-Identifier: Apache-2.0
// Judges a run with a fault: what noticed the fault and when, what the servo did, how much of each limit was
// used, and how the run ended.
#pragma once

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace fovea::matrix {

enum class End {
  kRecovered,  // the goal is kept again, for kept_s or longer
  kSafeStop,   // in Fault, brakes closed, at rest
  kHeld,       // in Hold, at rest
  kGoesOn,     // the fault never ends, and the motion goes on, off its path within safety.motion_error
  kUndefined,  // none of these
};
const char* Name(End end);

// Bounds on the hand's motion in a mode in which the arm must stand: the distance from where the mode began,
// beyond a stop from the speed at that time (UnwantedMotion); and the gain in speed. In Fault nothing holds
// the arm until its brakes close; but a fault of the eye exerts no force on the arm.
struct StandBound {
  const char* mode;
  double beyond_stop_mm;
  double gained_m_per_s;
  double gained_by_eye_m_per_s;  // for a fault of the eye
};
inline constexpr std::array<StandBound, 3> kStandBounds{
    {{"boot", 10.0, 0.1, 0.02}, {"hold", 10.0, 0.1, 0.1}, {"fault", 10.0, 0.25, 0.1}}};

struct Moved {
  double mm = 0.0;
  double beyond_stop_mm = 0.0;
  double gained_m_per_s = 0.0;
};

struct Outcome {
  std::string noticed_by;                // "": nothing noticed it
  std::optional<int> ticks;              // from the fault's start until it was noticed
  std::string reaction;                  // modes, or limits; "": none
  std::map<std::string, double> limits;  // largest used share of each limit
  std::vector<std::string> exceeded;     // limits exceeded by the truth, contact included
  std::map<std::string, Moved> moved;    // by mode in which the arm must stand
  std::vector<std::string> too_far;      // text for each mode beyond its bound
  std::uint64_t contact_ticks = 0;       // with bench, target or itself
  End end = End::kUndefined;
  std::string end_detail;                   // mode and reason at the end
  bool is_on_its_way = false;               // undefined, fault over, nothing latched: needs more time
  std::optional<double> off_mm;             // largest path error of a motion that goes on
  std::optional<double> recovered_after_s;  // from the fault's end until the goal is kept; 0: kept already

  [[nodiscard]] bool Failed() const {
    return end == End::kUndefined || !exceeded.empty() || !too_far.empty();
  }
};

// The arm's own limits in a summary. They come from the simulator's truth and the applied command, not from
// measurements.
const std::vector<std::string>& PhysicalLimits();

// Judges `run`, a summary with the fault `key` in `injected`, by comparison with `without`, the summary of
// the same run with the fault `nothing` from the same time on. The run has recovered when its goal is kept
// for `kept_s` at the end. std::runtime_error when one of them is not such a summary.
Outcome Judge(const std::string& key, const nlohmann::json& run, const nlohmann::json& without,
              double kept_s);

}  // namespace fovea::matrix
