// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tools/fovea/faults/text.hpp"

namespace fovea::matrix {
namespace {

constexpr const char* kHead = R"(# Results of the faults

Printed by `fovea atlas --faults --markdown`: every fault of the simulator at three or four severities, in every mode
of run, at every stage. Each cell is one run, compared with the same run without the fault. The command fails when a
run exceeds a limit of the arm or a barrier of the servo, has contact, moves too far or too fast while the arm should
stand, or ends in no defined state.

)";

constexpr const char* kHow = R"(
A cell has three lines:

1. What noticed the fault, and after how many ticks from its start. "-": nothing noticed it.
2. The reaction: the modes since the fault's start, each named once, if they differ from the modes of the run without
   the fault. Otherwise the limits that act only with the fault. In the mode `fault` the arm makes a damped stop, or its
   torque fades; then the brakes close ([GUARDS](../firmware/GUARDS.md)).
3. The end. *recovered*: the goal is kept for at least the last half second; the time counts from the fault's end. With
   a fault that never ends, the goal is kept in spite of it.
   *safe stop*: a fault is latched, the brakes are closed, the arm is at rest. *hold*: the arm is in Hold for the named
   reason, at rest. *goes on*: a load or a tilt never ends, and the arm follows its path with at most the given error
   (`safety.motion_error`). Any other end is **UNDEFINED**. **EXCEEDED** names the exceeded limits, by the simulator's
   truth (`violations` in a run's summary.json); contact is with bench, target or the arm itself. **MOVED** means that
   the hand moved too much in Boot, Hold or Fault. It gives the distance since that mode began, the part beyond a stop,
   and the gain in speed.

A run goes on for 1.5 to 4 s after its fault. If it then is in no defined state and no fault is latched, the same run is
repeated with 6 s more. The list above counts these runs. A run that never reaches a defined state is **UNDEFINED**.

The distance of a stop is at most the hand's speed at the start of the mode times the time of the stop. In Hold this
time is half the braking time of the slowest joint at its largest deceleration, plus twice the longest time that a joint
needs to reverse its acceleration. In Fault it is `safety.brake_after_s`. `true_joint_acceleration` ignores the
acceleration that a dead motor, a load or a push causes, and the rebound when it ends. It is exceeded only if a joint's
acceleration would be too large without that part too.

)";

constexpr const char* kWords = R"(
| noticed by | meaning |
|---|---|
| name of a guard; name of a mode | this guard ([GUARDS](../firmware/GUARDS.md)) latched the fault; the servo changed to this mode |
| `state_missing` | a tick without a new, valid state of the arm |
| `target_not_found` | the target was not found in a picture |
| `measurement_left_out` | a measurement that does not fit the target's motion, or is too old |
| `plan_late` | no plan came in time: the visual law goes on alone |
| `boot goes on`, `hold goes on` | the servo stays in this mode longer than without the fault: the arm is not ready, or no target is found |
| `limit ...` | nothing else noticed the fault; this limit acts only with the fault |

A fault of the camera can be noticed only with the next picture, 40 to 75 ms later. A fault that is noticed after as
many ticks as it lasts was noticed when it ended.

The last columns are the largest used shares of the arm's own limits in the runs of the row, rounded up: position (from
the middle of the range), velocity, torque and torque rate of the worst joint. They come from the simulator's truth and
the applied command.

| stage | start of the fault |
|---|---|
| boot | when half of Boot is over; a fault from the start: with the first tick |
| approach | on the way to the goal, while the arm moves |
| tracking | once the goal is kept |
| coasting | on the way to the goal, in the middle of 0.5 s in which the whole picture is hidden (if the fault is the occluder: in which the camera delivers nothing) |
| fault | 20 ms into the damped stop after another latched fault, `deadline_missed` |

| mode of run: the servo is in | boot | approach | tracking | coasting | fault |
|---|---|---|---|---|---|
| `ball`, `ball-moving` | Boot | Track | Track | Coast | Fault |
| `home` | Boot | Move | Hold | - | Fault |
| `flange-circle` | Boot | Move, to a pose | Move, by setpoints | - | Fault |

)";

std::string BoundList() {
  std::string text =
      "| mode | allowed distance beyond a stop | allowed gain in speed | allowed gain with a camera fault |\n"
      "|---|---|---|---|\n";
  for (const StandBound& bound : kStandBounds) {
    text += fmt::format("| {} | {:g} mm | {:g} m/s | {:g} m/s |\n", bound.mode, bound.beyond_stop_mm,
                        bound.gained_m_per_s, bound.gained_by_eye_m_per_s);
  }
  return text;
}

std::string CellText(const Cell* cell) {
  if (cell == nullptr) {
    return "";
  }
  const Outcome& o = cell->outcome;
  const std::string notice = o.ticks ? fmt::format("`{}` {}", o.noticed_by, *o.ticks) : "-";
  const bool loud = o.Failed();
  return fmt::format("{}<br>{}<br>{}{}{}", notice, ShortReaction(o), loud ? "**" : "", EndInWords(o),
                     loud ? "**" : "");
}

std::string FaultList() {
  std::string text = "| fault | key | mild | medium | severe | extreme |\n|---|---|---|---|---|---|\n";
  for (const Fault& fault : Faults()) {
    text += fmt::format("| {} | `faults.{}` |", fault.name, fault.key);
    for (const FaultLevel& level : fault.levels) {
      text += fmt::format(" {}: {} |", level.figures, level.why);
    }
    for (std::size_t i = fault.levels.size(); i < kSeverities.size(); ++i) {
      text += " |";
    }
    text += "\n";
  }
  return text;
}

}  // namespace

std::string ToMarkdown(const Matrix& matrix) {
  std::string text = kHead;
  for (const std::string& line : TotalsInWords(matrix)) {
    text += "- " + line + "\n";
  }
  if (matrix.cells.size() < NumCells()) {
    text += fmt::format(
        "- **a part of the matrix: {} of its {} cells; an empty cell, or a mode of run without a table, was "
        "not run**\n",
        matrix.cells.size(), NumCells());
  }
  text += kHow + BoundList() + kWords + FaultList() + "\nLeft out:";
  for (const std::string& line : LeftOut()) {
    text += " " + line + ".";
  }
  text += "\n";
  const RunMode* mode = nullptr;
  for (const MatrixRow& row : RowsOf(matrix)) {
    const bool coasts = row.mode->has_eye;
    if (row.mode != mode) {
      mode = row.mode;
      text += fmt::format(
          "\n## `{}`: {}\n\n| fault | | boot | approach | tracking |{} fault | q | dq | tau | dtau |\n"
          "|---|---|---|---|---|{}---|---|---|---|---|\n",
          mode->scenario, mode->title, coasts ? " coasting |" : "", coasts ? "---|" : "");
    }
    text += fmt::format("| {} | {} |", row.fault->name, kSeverities[row.severity]);
    for (const Stage stage : kStages) {
      if (coasts || stage != Stage::kCoasting) {
        text += fmt::format(" {} |", CellText(row.cells[static_cast<std::size_t>(stage)]));
      }
    }
    for (const std::string& limit : PhysicalLimits()) {
      text += fmt::format(" {} |", row.Worst(limit));
    }
    text += "\n";
  }
  return text;
}

}  // namespace fovea::matrix
