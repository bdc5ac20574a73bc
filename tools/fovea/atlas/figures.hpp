// SPDX-License-Identifier: Apache-2.0
// Figures computed from the rows of an atlas.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/config/terminal.hpp"
#include "tools/fovea/atlas/rows.hpp"

namespace fovea::atlas {

// Share of runs that should converge. For every start an independent search found a path to the goal.
inline constexpr double kGoalShare = 0.999;

struct Failure {
  int index = 0;
  std::string verdict;
  std::string command;  // repeats the run
};

struct Spread {
  double median = 0.0;
  double p95 = 0.0;
  double most = 0.0;
};

struct Figures {
  Heading heading;
  std::string scenario;
  int runs = 0;
  int converged = 0;
  std::array<double, 2> wilson_95{};   // interval of the success rate
  std::uint64_t limit_violations = 0;  // ticks, over all runs
  int contact_runs = 0;                // runs in which the arm touched bench, target or itself
  std::optional<Spread> settle_s;      // this and the errors: of the converged runs
  std::optional<Spread> error_px;
  std::optional<Spread> error_mm;
  std::optional<Spread> error_deg;
  std::map<std::string, double> limits;  // largest used share of each, over all runs
  Rejections rejections{};               // draws that the sampler rejected
  std::vector<Failure> failures;         // not converged, or a limit exceeded

  [[nodiscard]] bool ReachedGoal() const { return converged >= kGoalShare * runs && limit_violations == 0; }
};

// 95 % confidence interval of the true rate when `converged` of `runs` > 0 converged (Wilson, 1927).
std::array<double, 2> Wilson95(int converged, int runs);

// The figures of all rows with an index below `runs`.
Figures Summarise(const Heading& heading, const std::string& scenario, const std::map<int, Row>& rows,
                  int runs);

// The shell command that repeats a run.
std::string CommandOf(const Heading& heading, const std::string& scenario, const Row& row);
// The settings of a start, as values of fovea-sim's --set.
std::vector<std::string> AssignmentsOf(const Heading& heading, const Start& start);

std::string ToJson(const Figures& figures);
std::string ToTable(const Figures& figures, const config::TextStyle& style = {});
// Only the sampler's part, for starts that were drawn but not simulated.
std::string DrawsAsJson(const Figures& figures);
std::string DrawsAsTable(const Figures& figures, const config::TextStyle& style = {});

}  // namespace fovea::atlas
