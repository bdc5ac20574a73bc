// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/way.hpp"

#include <algorithm>
#include <random>
#include <utility>

#include "tools/fovea/atlas/uniform.hpp"

namespace fovea::atlas {
namespace {

using model::VecN;

struct Node {
  VecN q;
  std::size_t parent = 0;  // the node itself: a root
};
using Tree = std::vector<Node>;
using Path = std::vector<VecN>;

std::size_t NearestOf(const Tree& tree, const VecN& q) {
  std::size_t nearest = 0;
  double least = (tree[0].q - q).squaredNorm();
  for (std::size_t i = 1; i < tree.size(); ++i) {
    const double off = (tree[i].q - q).squaredNorm();
    if (off < least) {
      least = off;
      nearest = i;
    }
  }
  return nearest;
}

enum class Step : std::uint8_t { kThere, kNearer, kBarred };

// Steps from node `parent` towards `to`, and adds the reached posture to the tree.
Step StepTowards(const WayProblem& problem, std::size_t parent, const VecN& to, Tree& tree) {
  constexpr double kNearer = 0.02;  // least progress, as a share of a step
  const VecN from = tree[parent].q;
  const VecN off = to - from;
  const double left = off.norm();
  if (left <= problem.step) {
    if (!problem.is_allowed(to)) {
      return Step::kBarred;
    }
    tree.push_back({to, parent});
    return Step::kThere;
  }
  VecN q = problem.pull(from + problem.step / left * off);
  q = q.cwiseMax(problem.least).cwiseMin(problem.most);
  const bool nearer = (to - q).norm() < left - kNearer * problem.step;
  if (!nearer || (q - from).norm() > 2.0 * problem.step || !problem.is_allowed(q)) {
    return Step::kBarred;
  }
  tree.push_back({q, parent});
  return Step::kNearer;
}

// From the last node of the tree back to its root.
Path BackFromLast(const Tree& tree) {
  Path path;
  std::size_t at = tree.size() - 1;
  path.push_back(tree[at].q);
  while (tree[at].parent != at) {
    at = tree[at].parent;
    path.push_back(tree[at].q);
  }
  return path;
}

// The postures from `from` to `to` in steps that are tested; empty if one of them is not allowed.
Path Straight(const WayProblem& problem, const VecN& from, const VecN& to) {
  const int steps = static_cast<int>((to - from).norm() / problem.step) + 1;
  Path path;
  for (int i = 0; i <= steps; ++i) {
    path.emplace_back(from + (to - from) * i / steps);
    if (i > 0 && i < steps && !problem.is_allowed(path.back())) {
      return {};
    }
  }
  return path;
}

double LengthOf(const Path& path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    length += (path[i] - path[i - 1]).norm();
  }
  return length;
}

// Replaces random parts of the path by straight ones.
void Shorten(const WayProblem& problem, std::mt19937_64& engine, Path& path) {
  constexpr int kShortcuts = 300;
  for (int k = 0; k < kShortcuts && path.size() > 2; ++k) {
    const auto pick = [&] {
      return static_cast<std::size_t>(Uniform(engine, 0.0, 1.0) * static_cast<double>(path.size()));
    };
    const auto [first, last] = std::minmax({pick(), pick()});
    if (last - first < 2) {
      continue;
    }
    const Path straight = Straight(problem, path[first], path[last]);
    if (!straight.empty()) {
      const auto begin = path.begin() + static_cast<std::ptrdiff_t>(first);
      const auto at = path.erase(begin, begin + static_cast<std::ptrdiff_t>(last - first + 1));
      path.insert(at, straight.begin(), straight.end());
    }
  }
}

}  // namespace

WayResult FindWay(const WayProblem& problem, const VecN& start, const std::vector<VecN>& goals,
                  std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  Tree from_start;
  Tree from_goals;
  if (problem.is_allowed(start)) {
    from_start.push_back({start, 0});
  }
  for (const VecN& goal : goals) {
    if (problem.is_allowed(goal)) {
      from_goals.push_back({goal, from_goals.size()});
    }
  }
  WayResult result;
  if (from_start.empty() || from_goals.empty()) {
    return result;
  }
  Tree* grows = &from_start;
  Tree* follows = &from_goals;
  VecN aim = from_goals.front().q;
  for (; result.draws < problem.draws; ++result.draws) {
    if (StepTowards(problem, NearestOf(*grows, aim), aim, *grows) != Step::kBarred) {
      const VecN reached = grows->back().q;
      std::size_t at = NearestOf(*follows, reached);
      Step step = Step::kNearer;
      while (step == Step::kNearer) {
        step = StepTowards(problem, at, reached, *follows);
        at = follows->size() - 1;
      }
      if (step == Step::kThere) {
        Path path = BackFromLast(from_start);
        std::reverse(path.begin(), path.end());
        const Path rest = BackFromLast(from_goals);
        path.insert(path.end(), rest.begin() + 1, rest.end());
        Shorten(problem, engine, path);
        result.found = true;
        result.length = LengthOf(path);
        return result;
      }
    }
    std::swap(grows, follows);
    aim = problem.least;
    for (double& joint : aim) {
      joint = Uniform(engine, 0.0, 1.0);
    }
    aim = problem.least + aim.cwiseProduct(problem.most - problem.least);
  }
  return result;
}

}  // namespace fovea::atlas
