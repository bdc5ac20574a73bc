// SPDX-License-Identifier: Apache-2.0
// Not a test: prints how often the planner finds a motion from random starts, and what it takes. Where it
// finds a goal posture but no way to it, a longer search tells whether the start is hard or perhaps has none.
//
//   planning_figures <arm> <target> <number of starts> <seed> <times the budget of the longer search>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <string>
#include <vector>

#include "firmware/planning/planner.hpp"
#include "tests/planning/starts.hpp"

namespace fovea {
namespace {

using trajectory::Plan;

const char* WordsOf(const Plan& plan) {
  return trajectory::kPlanOutcomeWords[static_cast<std::size_t>(plan.outcome)];
}

// Computes the plan. The processor time that it took [ms].
double Compute(planning::Planner& planner, const trajectory::PlanRequest& request, Plan& plan) {
  const std::clock_t begin = std::clock();
  planner.Compute(request, plan);
  return 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

double At(std::vector<double> values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void Print(const char* what, const std::vector<double>& values, const char* unit) {
  std::printf("  %-24s median %8.2f, 99 %% %8.2f, largest %8.2f %s\n", what, At(values, 0.5),
              At(values, 0.99), At(values, 1.0), unit);
}

int Run(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr, "planning_figures: <arm> <target> <starts> <seed> <times the budget>\n");
    return 2;
  }
  const config::ServoConfig config = test::PlannedServo(argv[1], argv[2]);
  const int runs = std::atoi(argv[3]);
  test::PlannedStarts starts(config, static_cast<unsigned>(std::atoi(argv[4])));
  const int times = std::atoi(argv[5]);
  planning::Planner planner(config);
  std::vector<double> ms;  // these four of the starts with a motion
  std::vector<double> work;
  std::vector<double> seconds;
  std::vector<double> length;
  std::vector<double> ms_without;
  std::map<std::string, int> failures;
  int found_later = 0;
  Plan plan;
  for (int run = 0; run < runs; ++run) {
    trajectory::PlanRequest request = starts.Next();
    const double took = Compute(planner, request, plan);
    if (plan.IsFound()) {
      ms.push_back(took);
      work.push_back(1e-3 * static_cast<double>(planner.effort().work));
      seconds.push_back(plan.Duration());
      length.push_back(planner.effort().length);
      continue;
    }
    ms_without.push_back(took);
    ++failures[WordsOf(plan)];
    if (planner.effort().goals == 0) {
      continue;
    }
    request.budget *= times;
    request.seed = 2;
    planner.Compute(request, plan);
    found_later += plan.IsFound() ? 1 : 0;
    std::printf("start %d, with %d times the budget: %s; %lld postures\n", run, times, WordsOf(plan),
                static_cast<long long>(planner.effort().work));
    std::fflush(stdout);
  }
  std::printf("%s, %s: a motion from %zu of %d starts; from %d more with %d times the budget\n", argv[1],
              argv[2], ms.size(), runs, found_later, times);
  for (const auto& [why, count] : failures) {
    std::printf("  %4d: %s\n", count, why.c_str());
  }
  Print("planning", ms, "ms of processor time");
  Print("work", work, "thousand postures");
  Print("motion", seconds, "s");
  Print("path", length, "rad");
  Print("planning without a way", ms_without, "ms of processor time");
  return 0;
}

}  // namespace
}  // namespace fovea

int main(int argc, char** argv) { return fovea::Run(argc, argv); }
