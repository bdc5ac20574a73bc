// What the rows of an atlas say together.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/fovea/atlas/rows.hpp"

namespace fovea::atlas {

// Of the runs that shall converge; every start has a way to its goal that an independent search found.
inline constexpr double kGoalShare = 0.999;

struct Failure {
  int index = 0;
  std::string verdict;
  std::string command;  // that repeats it
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
  int contact_runs = 0;                // in which the arm touched bench, target or itself
  std::optional<Spread> settle_s;      // of those that converged
  std::optional<Spread> error_px;
  std::optional<Spread> error_mm;
  std::optional<Spread> error_deg;
  std::map<std::string, double> limits;  // largest used share of each, over all runs
  Rejections rejections{};               // draws of the sampler that were refused
  std::vector<Failure> failures;         // not converged, or a limit passed

  [[nodiscard]] bool ReachedGoal() const { return converged >= kGoalShare * runs && limit_violations == 0; }
};

// The interval in which the true rate lies with 95 %, by `converged` of `runs` > 0 (Wilson, 1927).
std::array<double, 2> Wilson95(int converged, int runs);

// Of all rows with an index below `runs`.
Figures Summarise(const Heading& heading, const std::string& scenario, const std::map<int, Row>& rows,
                  int runs);

// The shell command that repeats a run.
std::string CommandOf(const Heading& heading, const std::string& scenario, const Row& row);
// The settings of a start, as fovea-sim's --set takes them.
std::vector<std::string> AssignmentsOf(const Heading& heading, const Start& start);

std::string ToJson(const Figures& figures);
std::string ToTable(const Figures& figures);
// The sampler's part alone, of starts that were drawn and not run.
std::string DrawsAsJson(const Figures& figures);
std::string DrawsAsTable(const Figures& figures);

}  // namespace fovea::atlas
