#include <fmt/format.h>

#include "tools/fovea/faults/text.hpp"

namespace fovea::matrix {
namespace {

constexpr const char* kHead = R"(# What faults come to

Printed by `fovea atlas --faults --markdown`: every fault of the simulator at three or four severities, in every mode of
run, at every stage of it. Each cell is a run of its own, beside the same run without the fault. The command fails when one
passes anything that must hold (the arm's limits, the servo's barriers, contact), moves too far or too fast while the arm
should stand, or ends in no defined state.

)";

constexpr const char* kHow = R"(
A cell says, line by line:

1. what noticed the fault, and in how many ticks from its beginning; "-": nothing did, nor was there need to;
2. the reaction: the modes gone through since then, each named once, where they differ from those of the run without the fault,
   else limits that act and would not have. The mode `fault` is a damped stop, or the torque fades, then brakes
   ([GUARDS](../firmware/GUARDS.md));
3. the end. *recovered*: the goal is kept again, for the last half second at least; the time is from the fault's end on. Of a
   fault that never ends: it is kept all the same.
   *safe stop*: a fault is latched, the brakes closed, the arm at rest. *hold*: in Hold, for this reason, at rest. *goes on*: a
   load or a tilt that never ends, and the way is followed all the same, off by so much at most (`safety.motion_error`). All
   else would be **UNDEFINED**. **EXCEEDED** names what was passed, by the simulator's truth (`violations` in a run's
   summary.json); contact is with bench, target or itself. **MOVED** says by how far the hand moved in Boot, Hold or Fault from
   where that mode began, how much of it was more than a stop takes, and by how much it became faster than it was then, where
   that is beyond the bound.

A run goes on for 1.5 to 4 s after its fault. One that is in no defined state then, without a fault that is latched, is run once more,
the same and 6 s longer: that it takes long is told above, and what is stuck stays **UNDEFINED**.

A stop may take as far as the hand goes, at the speed that it has when the mode begins, in the time of the stop: in Hold half of
what the joint that takes longest needs at its largest deceleration, and twice its time to turn its acceleration round; in Fault
`safety.brake_after_s`. Of the joints' true acceleration, what a dead motor, a load or a push does by itself is not counted, nor the
springing back when it is over: it has passed where a joint would have been too fast without that, too.

)";

constexpr const char* kWords = R"(
| noticed by | that is |
|---|---|
| a guard's or a mode's name | the guard, as in [GUARDS](../firmware/GUARDS.md), latched the fault; the servo went into the mode |
| `state_missing` | a tick without a new state of the arm that could be taken |
| `target_not_found` | a picture was looked at and the target is not in it |
| `measurement_left_out` | a measurement that does not fit the target's motion, or is too old |
| `boot goes on`, `hold goes on` | the arm is not sound and at rest, or no target is found, when it would be without the fault |
| `limit ...` | nothing else did; this limit acts and would not have |

A fault of the camera can show only with the next picture, 40 to 75 ms on. What is noticed after as many ticks as the fault lasts was
noticed when it ended.

Last come the largest shares of the arm's own limits used in any of the row's runs, by the simulator's truth and the command in
force, rounded up: position (from the middle of the range), velocity, torque and torque rate of the worst joint.

| stage | the fault begins |
|---|---|
| boot | when half of Boot is over; what is there from the start, with the first tick |
| approach | on the way to the goal, while the arm moves |
| tracking | once the goal is kept |
| coasting | amid half a second for which the whole picture is hidden, on the way (where the fault is the occluder: in which the camera delivers nothing) |
| fault | 20 ms into the damped stop after another fault, `deadline_missed`, that is latched |

| mode of run | boot | approach | tracking | coasting | fault |
|---|---|---|---|---|---|
| `ball`, `ball-moving`: the servo is in | Boot | Track | Track | Coast | Fault |
| `home` | Boot | Move | Hold | - | Fault |
| `flange-circle` | Boot | Move, to a pose | Move, by setpoints | - | Fault |

)";

std::string BoundList() {
  std::string text =
      "| mode | the hand, beyond what a stop takes | faster than it was at the mode's beginning | by a fault "
      "of the eye "
      "|\n|---|---|---|---|\n";
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
        "- **a part of the matrix: {} of its {} cells; an empty cell, or a mode of run without a table, "
        "was not run**\n",
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
