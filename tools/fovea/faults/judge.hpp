// What a run with a fault came to: what noticed it and when, what the servo did, how much of each limit was
// used, and how it ended.
#pragma once

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace fovea::matrix {

enum class End {
  kRecovered,  // the goal is kept again, for half a second at least
  kSafeStop,   // in Fault, brakes closed, at rest
  kHeld,       // in Hold, at rest
  kGoesOn,     // the fault never ends, and the motion goes on with it, off its way within safety.motion_error
  kUndefined,  // none of these
};
const char* Name(End end);

// How far the hand may move in a mode in which the arm stands, from where that mode began, beyond what a stop
// from the speed that it had then takes (UnwantedMotion); and how much faster it may become than it was. In
// Fault nothing holds the arm any more before its brakes do; but a fault of the eye pulls at nothing.
struct StandBound {
  const char* mode;
  double beyond_stop_mm;
  double gained_m_per_s;
  double gained_by_eye_m_per_s;  // where the fault is the eye's
};
inline constexpr std::array<StandBound, 3> kStandBounds{
    {{"boot", 10.0, 0.1, 0.02}, {"hold", 10.0, 0.1, 0.1}, {"fault", 10.0, 0.25, 0.1}}};

struct Moved {
  double mm = 0.0;
  double beyond_stop_mm = 0.0;
  double gained_m_per_s = 0.0;
};

struct Outcome {
  std::string noticed_by;                // "": by nothing, nor was there need to
  std::optional<int> ticks;              // from the fault's beginning to then
  std::string reaction;                  // of the modes, or of limits; "": none
  std::map<std::string, double> limits;  // largest share used of each
  std::vector<std::string> exceeded;     // of all that must hold by the truth, contact included
  std::map<std::string, Moved> moved;    // by the mode in which the arm should have stood
  std::vector<std::string> too_far;      // in words: those beyond their bound
  std::uint64_t contact_ticks = 0;       // with bench, target or itself
  End end = End::kUndefined;
  std::string end_detail;        // mode and reason at the end
  bool is_on_its_way = false;    // undefined, the fault over and nothing latched: more time may tell
  std::optional<double> off_mm;  // of a motion that goes on: the most that it was off its way
  std::optional<double>
      recovered_after_s;  // from the fault's end until the goal is kept; 0: it was throughout

  [[nodiscard]] bool Failed() const {
    return end == End::kUndefined || !exceeded.empty() || !too_far.empty();
  }
};

// The arm's own limits among those of a summary. They are taken from the simulator's truth and the command in
// force, never from what was measured.
const std::vector<std::string>& PhysicalLimits();

// Judges `run`, a summary with the fault `key` in `injected`, beside `without`, that of the same run with
// `nothing` from the same time on. It has recovered when its goal is kept for `kept_s` at the end.
// std::runtime_error when one of them is no such summary.
Outcome Judge(const std::string& key, const nlohmann::json& run, const nlohmann::json& without,
              double kept_s);

}  // namespace fovea::matrix
