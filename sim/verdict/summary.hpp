// SPDX-License-Identifier: Apache-2.0
// The results of a run, as JSON (summary.json) and as a table for a person.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/beliefs/belief.hpp"
#include "firmware/host/config/terminal.hpp"
#include "firmware/host/run/fault_event.hpp"
#include "firmware/host/run/run_figures.hpp"
#include "sim/mcu/board_summary.hpp"
#include "sim/theory/run.hpp"
#include "sim/truth/truth_draw.hpp"

namespace fovea::sim {

struct ModeEvent {
  double t_s = 0.0;
  std::string mode;
  std::string reason;  // of Hold; "" otherwise
};

// An injected fault, and what the servo noticed since its beginning.
struct InjectedFault {
  std::string name;  // of its keys
  double from_s = 0.0;
  double to_s = 0.0;
  std::map<std::string, double> noticed;  // first time [s] of each event; see NoticeBook
};

// How far and how fast the hand moved in a mode in which the arm must stand still, since the mode's start.
struct StandingMotion {
  double most_mm = 0.0;
  double beyond_stop_mm = 0.0;  // part that a stop from the initial speed does not explain
  double most_m_per_s = 0.0;
  double gained_m_per_s = 0.0;  // excess over the initial speed; see UnwantedMotion
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
  std::optional<double> at_rest_since_s;    // by truth: since then every joint is at rest; none if one moves
  std::optional<double> goal_kept_since_s;  // by truth: since then within the bounds of `converged`
};

struct Summary : run::RunFigures {
  std::string scenario;
  int seed = 0;
  std::string pace;
  bool converged = false;
  std::string verdict;       // one sentence: converged, or why not
  bool interrupted = false;  // ended early on request

  // Against the simulator's truth. Still targets: over the last 0.5 s.
  std::optional<double> settle_time_s;
  std::optional<double> start_error_px;
  std::optional<double> final_error_px_rms;
  std::optional<double> final_error_mm;
  std::optional<double> final_error_lateral_mm;
  std::optional<double> final_error_depth_mm;
  std::optional<double> final_error_deg;     // none for a sphere, which has no orientation
  std::optional<double> error_px_max;        // over the run; none if the target was behind the camera
  std::optional<double> camera_path_m;       // length of the camera's way
  std::optional<double> camera_excursion_m;  // largest distance from the straight line between its ends
  // Moving targets: over the second half.
  std::optional<double> tracking_error_mm_rms;
  std::optional<double> tracking_error_px_rms;

  // Commanded circles: errors of the end effector since the circle's start.
  std::optional<double> path_error_mm_rms;
  std::optional<double> path_error_mm_max;
  std::optional<double> home_error_rad;  // largest joint error at the end of a home motion
  std::optional<TheoryResult> theory;    // comparison with the analytic response

  // Conditions on the truth and on the reference; see barriers.hpp.
  std::map<std::string, double> limits;             // largest used share of each
  std::map<std::string, double> clearances_m;       // least distance to each plane and box; negative: inside
  std::map<std::string, double> unjudged;           // as `limits`, but may be above 1
  std::uint64_t limit_violations = 0;               // ticks with any violation or contact
  std::map<std::string, std::uint64_t> violations;  // ticks with a violation, per condition
  std::map<std::string, std::uint64_t> measurements;  // number of measurements, by hal::Intake
  std::map<std::string, std::uint64_t> limit_ticks;   // ticks in which the servo's guard acted, by limit
  std::uint64_t contact_ticks = 0;  // ticks in which the arm touched bench, target or itself
  ContactTicks contacts;
  std::map<std::string, StandingMotion> unwanted_motion;  // by mode: boot, hold, fault
  std::vector<run::FaultEvent> faults;
  std::vector<ModeEvent> modes;
  std::vector<InjectedFault> injected;
  std::vector<TrueValue> truth;              // what is not as the servo believes
  std::optional<beliefs::Findings> beliefs;  // what the run tells of them; none without a camera
  RunEnd end;

  std::uint64_t frames = 0;  // that reached vision
  std::uint64_t frames_detected = 0;
  std::uint64_t frames_failed = 0;  // frames on which vision failed; they count as not found
  std::string frame_failure;        // reason for the first of them
  std::uint64_t frames_lost = 0;    // frames that never reached vision: dropped by the camera, or by a fault
  std::optional<BoardSummary> mcu;  // for a servo on a board
  double sim_time_s = 0.0;
  double preparing_s = 0.0;  // wall time before the first tick
  double wall_time_s = 0.0;  // from the first tick to the last
  double writing_s = 0.0;    // after the last tick, for pictures, film and report; set after they are written
  double real_time_factor = 0.0;
  std::string renderer;
};

// Whether the run converged without a limit violation and without a contact. Decides the program's exit code.
inline bool ReachedItsGoal(const Summary& summary) {
  return summary.converged && summary.limit_violations == 0 && summary.contact_ticks == 0;
}

std::string ToJson(const Summary& summary);
// For a person, in lines that fit into the style's width.
std::string ToTable(const Summary& summary, const config::TextStyle& style = {});

}  // namespace fovea::sim
