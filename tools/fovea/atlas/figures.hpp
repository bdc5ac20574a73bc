// SPDX-License-Identifier: Apache-2.0
// Figures computed from the rows of an atlas.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/config/terminal.hpp"
#include "tools/fovea/atlas/deviations.hpp"
#include "tools/fovea/atlas/rows.hpp"

namespace fovea::atlas {

// A run ends once the goal has been kept for this time [s].
inline constexpr double kSettledS = 2.0;
// A run that does not settle lasts so long [s]. Some ways are 20 rad long.
inline constexpr double kMostS = 25.0;

// Share of the runs that should converge, of those from whose start a way leads to the goal.
inline constexpr double kGoalShare = 0.999;

// A run that failed.
struct Failure {
  int index = 0;
  int line = 0;  // of its start, in the file of --starts; 0: a random start
  std::string verdict;
  std::string way;      // what is known about a way from its start
  std::string command;  // repeats the run
  std::string folder;   // of its pictures, in the folder of the atlas
};

// A start from which the judge found no way.
struct WithoutWay {
  int index = 0;
  int line = 0;
  Judgement judgement;
  std::string end;  // of its run
  std::string command;
};

struct Spread {
  double median = 0.0;
  double p95 = 0.0;
  double most = 0.0;
};

struct Figures {
  Heading heading;
  std::string scenario;
  double width_px = 640.0;  // of a picture
  double height_px = 480.0;
  int runs = 0;
  int converged = 0;
  int held = 0;                        // runs without a way that ended as they have to
  std::array<double, 2> wilson_95{};   // interval of the success rate
  std::uint64_t limit_violations = 0;  // ticks, over all runs
  int contact_runs = 0;                // runs in which the arm touched bench, target or itself
  int without_result = 0;              // runs whose simulator did not end as it should
  std::optional<Spread> settle_s;      // this and the errors: of the converged runs
  std::optional<Spread> error_px;
  std::optional<Spread> error_mm;
  std::optional<Spread> error_deg;
  std::map<std::string, double> limits;  // largest used share of each, over all runs
  Rejections rejections{};               // draws that the sampler rejected
  std::vector<Deviation> deviations;     // of the runs with wrong beliefs
  std::vector<WithoutWay> without_way;
  std::vector<Failure> failures;  // a limit exceeded, or neither converged nor without a way and held

  // The runs with a way: the success rate is of these.
  [[nodiscard]] int WithWay() const { return runs - static_cast<int>(without_way.size()); }
  [[nodiscard]] int FailedWithWay() const { return WithWay() - converged; }
  // A run without a way that did not end as it has to counts as a failure.
  [[nodiscard]] bool ReachedGoal() const {
    return converged >= kGoalShare * (runs - held) && limit_violations == 0;
  }
};

// 95 % confidence interval of the true rate when `converged` of `runs` > 0 converged (Wilson, 1927).
std::array<double, 2> Wilson95(int converged, int runs);

// The figures of all rows with an index below `runs`. `judgements`: of starts, by index. A start without one
// has a way: a run converged from it.
Figures Summarise(const Heading& heading, const std::string& scenario, const std::map<int, Row>& rows,
                  const std::map<int, Judgement>& judgements, int runs);

// The shell command that repeats a run.
std::string CommandOf(const Heading& heading, const std::string& scenario, const Row& row);
// The settings of a start, as values of fovea-sim's --set. `truth`: of its case.
std::vector<std::string> AssignmentsOf(const Heading& heading, const std::vector<std::string>& truth,
                                       const Start& start);
// The folder of a run's files, in the folder of the atlas.
std::string RunFolder(const std::string& case_name, int index);

// E.g. "2, all held with goal_unreachable".
std::string NoWayInWords(const Figures& figures);
std::string ToJson(const Figures& figures);
std::string ToTable(const Figures& figures, const config::TextStyle& style = {});
// Only the sampler's part, for starts that were drawn but not simulated.
std::string DrawsAsJson(const Figures& figures);
std::string DrawsAsTable(const Figures& figures, const config::TextStyle& style = {});

}  // namespace fovea::atlas
