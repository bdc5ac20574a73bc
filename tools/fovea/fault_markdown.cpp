#include <fmt/format.h>

#include "fault_text.hpp"

namespace fovea::matrix {
namespace {

constexpr const char* kHead = R"(# What faults come to

Printed by `fovea atlas --faults --markdown`: every fault of the simulator at three severities, in every mode of run, at
every stage of it. Each cell is a run of its own, beside the same run without the fault. The command fails when one
exceeds a limit of the arm's or ends in no defined state.

)";

constexpr const char* kHow = R"(
A cell says, line by line:

- what noticed the fault, and in how many ticks from its beginning: a guard (as in [GUARDS](../firmware/GUARDS.md)), a mode, a limit
  that acts and would not have, or
  - `state_missing`: a tick without a new state of the arm that could be taken,
  - `target_not_found`: a picture was looked at and the target is not in it,
  - `measurement_left_out`: a measurement that does not fit the target's motion, or comes too late,
  - `boot goes on`: the arm is not sound and at rest when it should be; "-": by nothing, nor was there need to. A fault of the
  camera can show only in the next picture, 20 to 75 ms on.
- the reaction: modes gone through since then (each named once) that differ from those of the run without the fault, else limits; in
  `fault` a damped stop, then brakes.
- the end. *recovered*: the goal is kept again, at least for the last half second; after a time, counted from the fault's
  end. *safe stop*: fault latched, brakes closed, at rest. *held*: in Hold, at rest. All else would be **UNDEFINED**.

Last come the largest shares of the arm's own limits used in any of the row's runs, by the simulator's truth and the command in
force, rounded up: position (from the middle of the range), velocity, torque and torque rate of the worst joint.

| stage | the fault begins |
|---|---|
| boot | when half of Boot is over |
| approach | on the way to the goal, while the arm moves |
| tracking | once the goal is kept |
| coasting | amid half a second for which the whole picture is hidden, on the way (where the fault is the occluder: in which the camera delivers nothing) |
| fault | 20 ms into the damped stop after another fault, `deadline_missed`, that is latched |

)";

std::string CellText(const Cell* cell) {
  if (cell == nullptr) {
    return "";
  }
  const Outcome& o = cell->outcome;
  const std::string notice = o.ticks ? fmt::format("`{}` {}", o.noticed_by, *o.ticks) : "-";
  const bool loud = o.Failed();
  return fmt::format("{}<br>{}<br>{}{}{}{}", notice, ShortReaction(o), loud ? "**" : "", EndInWords(o),
                     loud ? "**" : "", o.contact_ticks > 0 ? " (touched the table)" : "");
}

std::string FaultList() {
  std::string text = "| fault | key | mild | medium | severe |\n|---|---|---|---|---|\n";
  for (const Fault& fault : Faults()) {
    text += fmt::format("| {} | `faults.{}` |", fault.name, fault.key);
    for (const FaultLevel& level : fault.levels) {
      text += fmt::format(" {}: {} |", level.figures, level.why);
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
  text += kHow + FaultList() + "\nLeft out:";
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
