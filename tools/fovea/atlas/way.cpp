// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/way.hpp"

#include <random>
#include <utility>

namespace fovea::atlas {
namespace {

using model::VecN;

using Tree = std::vector<VecN>;

const VecN& NearestOf(const Tree& tree, const VecN& q) {
  std::size_t nearest = 0;
  double least = (tree[0] - q).squaredNorm();
  for (std::size_t i = 1; i < tree.size(); ++i) {
    const double off = (tree[i] - q).squaredNorm();
    if (off < least) {
      least = off;
      nearest = i;
    }
  }
  return tree[nearest];
}

enum class Step : std::uint8_t { kThere, kNearer, kBarred };

// Steps from `from` towards `to`, and adds the reached posture to the tree.
Step StepTowards(const WayProblem& problem, const VecN& from, const VecN& to, Tree& tree) {
  constexpr double kNearer = 0.02;  // least progress, as a share of a step
  const VecN off = to - from;
  const double left = off.norm();
  if (left <= problem.step) {
    tree.push_back(to);
    return Step::kThere;
  }
  VecN q = problem.pull(from + problem.step / left * off);
  q = q.cwiseMax(problem.least).cwiseMin(problem.most);
  const bool nearer = (to - q).norm() < left - kNearer * problem.step;
  if (!nearer || (q - from).norm() > 2.0 * problem.step || !problem.is_allowed(q)) {
    return Step::kBarred;
  }
  tree.push_back(q);
  return Step::kNearer;
}

}  // namespace

bool WayExists(const WayProblem& problem, const VecN& start, const std::vector<VecN>& goals,
               std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  Tree from_start;
  Tree from_goals;
  if (problem.is_allowed(start)) {
    from_start.push_back(start);
  }
  for (const VecN& goal : goals) {
    if (problem.is_allowed(goal)) {
      from_goals.push_back(goal);
    }
  }
  if (from_start.empty() || from_goals.empty()) {
    return false;
  }
  Tree* grows = &from_start;
  Tree* follows = &from_goals;
  VecN aim = from_goals.front();
  for (int draw = 0; draw < problem.draws; ++draw) {
    const VecN near = NearestOf(*grows, aim);
    if (StepTowards(problem, near, aim, *grows) != Step::kBarred) {
      const VecN reached = grows->back();
      VecN at = NearestOf(*follows, reached);
      Step step = Step::kNearer;
      while (step == Step::kNearer) {
        step = StepTowards(problem, at, reached, *follows);
        at = follows->back();
      }
      if (step == Step::kThere) {
        return true;
      }
    }
    std::swap(grows, follows);
    aim = problem.least;
    for (double& joint : aim) {
      joint = static_cast<double>(engine() >> 11U) * 0x1p-53;
    }
    aim = problem.least + aim.cwiseProduct(problem.most - problem.least);
  }
  return false;
}

}  // namespace fovea::atlas
