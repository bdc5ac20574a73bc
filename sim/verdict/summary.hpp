// What a run came to: figures for a machine (summary.json) and for a person (a table).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/host/run/run_figures.hpp"
#include "sim/mcu/board_summary.hpp"
#include "sim/theory/run.hpp"

namespace fovea::sim {

struct FaultEvent {
  double t_s = 0.0;
  std::string name;
  std::string key;
  std::string detail;
};

struct ModeEvent {
  double t_s = 0.0;
  std::string mode;
  std::string reason;  // of Hold; "" otherwise
};

// A fault that was put into the run, and what the servo noticed from its beginning on.
struct InjectedFault {
  std::string name;  // of its keys
  double from_s = 0.0;
  double to_s = 0.0;
  std::map<std::string, double> noticed;  // when first [s], by what; see NoticeBook
};

// How far and how fast the hand moved in a mode in which the arm stands, from where that mode began.
struct StandingMotion {
  double most_mm = 0.0;
  double beyond_stop_mm = 0.0;  // of it, what no stop from the speed that it had explains
  double most_m_per_s = 0.0;
  double gained_m_per_s = 0.0;  // more than it had, or was coming to, when the mode began
};

// Ticks in which the arm touched something.
struct ContactTicks {
  std::uint64_t bench = 0;
  std::uint64_t target = 0;
  std::uint64_t self = 0;
};

// How a run ended.
struct RunEnd {
  std::string mode;
  std::string reason;  // of Hold; "" otherwise
  bool brakes = false;
  std::optional<double> at_rest_since_s;    // by truth: no joint moved faster since; none while one does
  std::optional<double> goal_kept_since_s;  // by truth: within the bounds that decide over `converged`
};

struct Summary : run::RunFigures {
  std::string scenario;
  int seed = 0;
  std::string pace;
  bool converged = false;
  std::string verdict;       // one sentence: converged, or why not
  bool interrupted = false;  // told to end before its end

  // Against the simulator's truth. Still targets: over the last 0.5 s.
  std::optional<double> settle_time_s;
  std::optional<double> start_error_px;
  std::optional<double> final_error_px_rms;
  std::optional<double> final_error_mm;
  std::optional<double> final_error_lateral_mm;
  std::optional<double> final_error_depth_mm;
  std::optional<double> final_error_deg;  // none for a sphere, which has no orientation
  // Moving targets: over the second half.
  std::optional<double> tracking_error_mm_rms;
  std::optional<double> tracking_error_px_rms;

  // Commanded circles: of the end effector, from the circle's start on.
  std::optional<double> path_error_mm_rms;
  std::optional<double> path_error_mm_max;
  std::optional<double> home_error_rad;  // largest of the joints', at the end of a way home
  std::optional<TheoryResult> theory;    // of a run beside its analytic answer

  // What must hold, by the truth, and of the reference; see verdict_barriers.hpp.
  std::map<std::string, double> limits;               // largest used fraction of each
  std::map<std::string, double> clearances_m;         // least distance to each plane and box; below 0: within
  std::map<std::string, double> unjudged;             // as `limits`, and may be above 1
  std::uint64_t limit_violations = 0;                 // ticks in which anything was passed or touched
  std::map<std::string, std::uint64_t> violations;    // the same of each that was
  std::map<std::string, std::uint64_t> measurements;  // how many, by what became of them (hal::Intake)
  std::map<std::string, std::uint64_t> limit_ticks;   // ticks in which the servo's guard acted, by limit
  std::uint64_t contact_ticks = 0;  // ticks in which the arm touched bench, target or itself
  ContactTicks contacts;
  std::map<std::string, StandingMotion> unwanted_motion;  // by mode: boot, hold, fault
  std::vector<FaultEvent> faults;
  std::vector<ModeEvent> modes;
  std::vector<InjectedFault> injected;
  RunEnd end;

  std::uint64_t frames = 0;
  std::uint64_t frames_detected = 0;
  std::uint64_t frames_failed = 0;  // that could not be looked at; they count as not found
  std::string frame_failure;        // why the first of them
  std::uint64_t frames_lost = 0;
  std::optional<BoardSummary> mcu;  // of a servo on a board
  double sim_time_s = 0.0;
  double preparing_s = 0.0;  // wall time before the first tick
  double wall_time_s = 0.0;  // from the first tick to the last
  double writing_s = 0.0;    // and after it, for pictures, film and report; known when they are written
  double real_time_factor = 0.0;
  std::string renderer;
};

// Whether the run did what it was for: converged, no limit passed and nothing touched on the way. The
// program's exit code.
inline bool ReachedItsGoal(const Summary& summary) {
  return summary.converged && summary.limit_violations == 0 && summary.contact_ticks == 0;
}

std::string ToJson(const Summary& summary);
std::string ToTable(const Summary& summary);

}  // namespace fovea::sim
