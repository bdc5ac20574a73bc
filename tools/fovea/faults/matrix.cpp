// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/faults/matrix.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "firmware/host/config/input_error.hpp"
#include "tools/fovea/faults/runs.hpp"

namespace fovea::matrix {
namespace {

constexpr double kLongestFaultS = 5.0;  // the longest fault that ends
constexpr double kGoalS = 0.8;  // a run goes on at least this long after the goal time without a fault
constexpr double kStopS = 1.5;  // time that a run in Fault gets after the fault; safety.brake_after_s is 0.3
constexpr double kLongerS = 6.0;  // extra time for a run that is still on its way at its end

// The entries of a summary that the judge needs. The rest is dropped.
nlohmann::json Excerpt(const nlohmann::json& summary) {
  nlohmann::json excerpt;
  for (const char* key : {"verdict", "modes", "injected", "end", "limits", "violations", "unwanted_motion",
                          "contact_ticks", "sim_time_s", "path_error_mm_max"}) {
    excerpt[key] = summary.at(key);
  }
  return excerpt;
}

// End of a run with a fault from `onset_s` on for `lasts_s`. A fault without end lasts as long as the run.
double EndFor(const RunMode& mode, Stage stage, double goal_s, double onset_s, double lasts_s) {
  const bool forever = lasts_s >= kForever;
  if (stage == Stage::kFault) {
    return onset_s + (forever ? 0.0 : lasts_s) + kStopS;
  }
  return std::max(onset_s + lasts_s + (forever ? 0.0 : mode.recovery_s), goal_s + kGoalS);
}
// End of the run without the fault: as late as that of the longest run with one.
double EndBeside(const RunMode& mode, Stage stage, double goal_s, double onset_s) {
  return std::max(EndFor(mode, stage, goal_s, onset_s, kLongestFaultS),
                  EndFor(mode, stage, goal_s, onset_s, kForever));
}
std::string Duration(double end_s) { return fmt::format("run.duration_s={:.3f}", end_s); }

// The cells that `only` selects, in order.
std::vector<Cell> CellsOf(const std::vector<std::string>& only) {
  std::vector<Cell> cells;
  for (const RunMode& mode : RunModes()) {
    for (const Fault& fault : Faults()) {
      for (std::size_t severity = 0; severity < fault.levels.size(); ++severity) {
        for (const Stage stage : kStages) {
          Cell cell;
          cell.mode = &mode;
          cell.stage = stage;
          cell.fault = &fault;
          cell.severity = severity;
          const std::string name = NameOf(cell);
          const bool asked = only.empty() || std::any_of(only.begin(), only.end(), [&](const auto& part) {
                               return name.find(part) != std::string::npos;
                             });
          if (asked && MakesSense(mode, stage, fault)) {
            cells.push_back(cell);
          }
        }
      }
    }
  }
  if (cells.empty()) {
    throw config::InputError(
        "--only leaves no cell; a cell has a name such as ball.approach.torque_loss.severe");
  }
  return cells;
}

std::string UndisturbedName(const RunMode& mode) { return mode.name; }
std::string BesideName(const RunMode& mode, const StageSetup& setup) {
  return fmt::format("{}.{}", mode.name, setup.name);
}

Job JobOf(const Cell& cell, const StageTimes& times, const StageSetup& setup) {
  const FaultLevel& level = cell.fault->levels[cell.severity];
  Job job{NameOf(cell), cell.mode->scenario, setup.assignments};
  job.name += cell.longer_s > 0.0 ? ".longer" : "";
  for (const std::string& assignment : AssignmentsOf(*cell.fault, level, setup.onset_s)) {
    job.assignments.push_back(assignment);
  }
  const double end_s = EndFor(*cell.mode, cell.stage, times.goal_s, setup.onset_s, level.lasts_s);
  job.assignments.push_back(Duration(end_s + cell.longer_s));
  return job;
}

Outcome BrokeOff() {
  Outcome outcome;
  outcome.end_detail = "the simulator did not finish";
  return outcome;
}

StageTimes TimesIn(const Runs& runs, const Cell& cell) {
  return TimesOf(*cell.mode, runs.SummaryOf(UndisturbedName(*cell.mode)));
}
Job JobIn(const Runs& runs, const Cell& cell) {
  const StageTimes times = TimesIn(runs, cell);
  return JobOf(cell, times, SetUp(times, cell.stage, cell.fault));
}

void JudgeCell(const Runs& runs, int seed, Cell& cell) {
  const Job job = JobIn(runs, cell);
  const StageSetup setup = SetUp(TimesIn(runs, cell), cell.stage, cell.fault);
  const nlohmann::json& summary = runs.SummaryOf(job.name);
  cell.command = CommandOf(job, seed);
  cell.outcome = summary.is_null() ? BrokeOff()
                                   : Judge(cell.fault->key, summary,
                                           runs.SummaryOf(BesideName(*cell.mode, setup)), cell.mode->kept_s);
}

}  // namespace

std::string NameOf(const Cell& cell) {
  return fmt::format("{}.{}.{}.{}", cell.mode->name, matrix::Name(cell.stage), cell.fault->id,
                     kSeverities[cell.severity]);
}

std::size_t NumCells() { return CellsOf({}).size(); }

Matrix RunMatrix(const MatrixOptions& options) {
  Matrix matrix;
  matrix.seed = options.seed;
  matrix.cells = CellsOf(options.only);

  std::map<std::string, Job> undisturbed;
  for (const Cell& cell : matrix.cells) {
    const std::string name = UndisturbedName(*cell.mode);
    undisturbed[name] = {name, cell.mode->scenario, {}};
  }
  const auto jobs_of = [](const std::map<std::string, Job>& named) {
    std::vector<Job> jobs;
    jobs.reserve(named.size());
    for (const auto& [name, job] : named) {
      jobs.push_back(job);
    }
    return jobs;
  };
  Runs runs(options.out, options.seed, options.jobs, options.resume,
            {"fovea atlas --faults", false,
             [](const Job&, const nlohmann::json& summary, const auto&) { return Excerpt(summary); }});
  {
    atlas::Progress progress("without a fault", static_cast<int>(undisturbed.size()));
    runs.Execute(jobs_of(undisturbed), progress);
  }

  std::map<std::string, Job> beside;
  std::vector<Job> with_fault;
  with_fault.reserve(matrix.cells.size());
  for (Cell& cell : matrix.cells) {
    const RunMode& mode = *cell.mode;
    const StageTimes times = TimesIn(runs, cell);
    const StageSetup setup = SetUp(times, cell.stage, cell.fault);
    cell.onset_s = setup.onset_s;

    Job without{BesideName(mode, setup), mode.scenario, setup.assignments};
    without.assignments.push_back(Window("nothing", setup.onset_s, setup.onset_s + kLongestFaultS));
    without.assignments.push_back(Duration(EndBeside(mode, cell.stage, times.goal_s, setup.onset_s)));
    beside[without.name] = without;

    with_fault.push_back(JobOf(cell, times, setup));
  }
  {
    atlas::Progress progress("stages", static_cast<int>(beside.size()));
    runs.Execute(jobs_of(beside), progress);
  }
  {
    atlas::Progress progress("faults", static_cast<int>(with_fault.size()));
    runs.Execute(with_fault, progress);
  }
  std::vector<Job> longer;
  for (Cell& cell : matrix.cells) {
    JudgeCell(runs, options.seed, cell);
    if (cell.outcome.is_on_its_way) {
      cell.longer_s = kLongerS;
      longer.push_back(JobIn(runs, cell));
    }
  }
  if (!longer.empty()) {
    atlas::Progress progress("given longer", static_cast<int>(longer.size()));
    runs.Execute(longer, progress);
  }
  for (Cell& cell : matrix.cells) {
    if (cell.longer_s > 0.0) {
      JudgeCell(runs, options.seed, cell);
    }
  }
  matrix.runs = static_cast<int>(undisturbed.size() + beside.size() + with_fault.size() + longer.size());
  return matrix;
}

Totals Sum(const Matrix& matrix) {
  Totals totals;
  for (const Cell& cell : matrix.cells) {
    const Outcome& o = cell.outcome;
    totals.exceeded += o.exceeded.empty() ? 0 : 1;
    totals.moved += o.too_far.empty() ? 0 : 1;
    totals.undefined += o.end == End::kUndefined ? 1 : 0;
    totals.recovered += o.end == End::kRecovered ? 1 : 0;
    totals.stopped += o.end == End::kSafeStop ? 1 : 0;
    totals.held += o.end == End::kHeld ? 1 : 0;
    totals.gone_on += o.end == End::kGoesOn ? 1 : 0;
    totals.touched += o.contact_ticks > 0 ? 1 : 0;
    totals.noticed += o.ticks ? 1 : 0;
    totals.longer += cell.longer_s > 0.0 ? 1 : 0;
    if (o.recovered_after_s &&
        (totals.last == nullptr || *o.recovered_after_s > *totals.last->outcome.recovered_after_s)) {
      totals.last = &cell;
    }
    if (o.ticks && (totals.slowest == nullptr || *o.ticks > *totals.slowest->outcome.ticks)) {
      totals.slowest = &cell;
    }
    for (const auto& [limit, used] : o.limits) {
      const Cell*& worst = totals.worst_limits[limit];
      if (worst == nullptr || used > worst->outcome.limits.at(limit)) {
        worst = &cell;
      }
    }
    for (const auto& [mode, way] : o.moved) {
      const Cell*& furthest = totals.furthest[mode];
      if (furthest == nullptr || way.beyond_stop_mm > furthest->outcome.moved.at(mode).beyond_stop_mm) {
        furthest = &cell;
      }
    }
  }
  return totals;
}

}  // namespace fovea::matrix
