// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <mutex>

#include "tools/fovea/atlas/way.hpp"

namespace fovea::atlas {
namespace {

using model::Pose;
using model::VecN;

constexpr double kSame = 0.01;  // goal postures this near to each other count as one [rad]

// Without those that are the same.
std::vector<VecN> Different(const std::vector<VecN>& goals) {
  std::vector<VecN> different;
  for (const VecN& goal : goals) {
    const bool is_known = std::any_of(different.begin(), different.end(),
                                      [&](const VecN& other) { return (goal - other).norm() < kSame; });
    if (!is_known) {
      different.push_back(goal);
    }
  }
  return different;
}

}  // namespace

std::string InWords(const Judgement& judgement) {
  return judgement.has_way ? fmt::format("a way of {:.1f} rad exists", judgement.length)
                           : fmt::format("no way found in {} draws from {} goal postures", judgement.draws,
                                         judgement.goals);
}

Judgement JudgeStart(const Scene& scene, const Start& start, const JudgeEffort& effort) {
  const GoalPostures postures(start.goal ? WithGoal(scene, *start.goal) : scene,
                              GoalPostures::Bounds::kOfServo);
  const StartChecks& checks = postures.checks();
  const Pose X_BO = start.TargetPose();
  const VecN q = Eigen::Map<const VecN>(start.q.data(), static_cast<Eigen::Index>(start.q.size()));
  std::mt19937_64 engine(start.way_seed);
  const std::vector<VecN> goals = Different(postures.Find(q, X_BO, {.far = effort.descents}, engine));
  WayProblem problem;
  problem.least = postures.least();
  problem.most = postures.most();
  const double at_start = checks.CosineTo(checks.At(q), X_BO);
  const double least_cosine = std::min(checks.LeastCosine(), at_start - kSame);
  problem.is_allowed = [&](const VecN& at) { return checks.OnTheWay(checks.At(at), X_BO, least_cosine); };
  problem.pull = [&](const VecN& at) { return postures.PulledIntoView(at, X_BO); };
  problem.draws = effort.draws;
  Judgement judgement;
  judgement.goals = static_cast<int>(goals.size());
  for (int i = 0; i < effort.searches && !judgement.has_way; ++i) {
    const WayResult way = FindWay(problem, q, goals, engine());
    judgement.has_way = way.found;
    judgement.length = way.length;
    judgement.draws += way.draws;
  }
  return judgement;
}

void JudgeStarts(const Scene& scene, const std::vector<Start>& starts, int jobs,
                 const std::function<void(std::size_t, const Judgement&)>& on_judged) {
  std::atomic<std::size_t> next = 0;
  std::mutex one_at_a_time;
  const auto work = [&] {
    for (std::size_t i = next++; i < starts.size(); i = next++) {
      const Judgement judgement = JudgeStart(scene, starts[i]);
      const std::scoped_lock lock(one_at_a_time);
      on_judged(i, judgement);
    }
  };
  std::vector<std::future<void>> workers;
  for (int i = 0; i < jobs; ++i) {
    workers.push_back(std::async(std::launch::async, work));
  }
  for (std::future<void>& worker : workers) {
    worker.get();
  }
}

}  // namespace fovea::atlas
