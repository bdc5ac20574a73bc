// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/path_search.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::planning {
namespace {

constexpr int kLooks = 6;  // steps that turn a random posture towards the target
constexpr double kLookShare = 0.7;
constexpr double kAnywhere = 0.15;     // share of random postures that are not turned
constexpr double kPictureShare = 0.6;  // of the picture about its centre, to which the target is turned
constexpr int kAimSteps = 4;           // towards a random posture
constexpr int kFarthest = 400;         // towards the other tree

// A random posture, turned towards the target.
model::VecN Aim(const PostureSpace& space, Work& work, Draws& draws) noexcept {
  model::VecN q = draws.Between(space.range().least, space.range().most);
  if (draws.Uniform(0.0, 1.0) < kAnywhere) {
    return q;
  }
  const config::ViewConfig& view = space.config().guard.view;
  model::Vec3 d_C(kPictureShare * draws.Uniform(view.x_min, view.x_max),
                  kPictureShare * draws.Uniform(view.y_min, view.y_max), 1.0);
  d_C /= d_C.norm();
  Posture posture;
  for (int look = 0; look < kLooks; ++look) {
    space.Place(q, work, posture);
    q = space.LookStep(posture, d_C, kLookShare);
  }
  return q;
}

}  // namespace

PathSearch::PathSearch() {
  from_start_.reserve(kMostNodes);
  from_goals_.reserve(kMostNodes);
}

int PathSearch::NearestOf(const PostureSpace& space, const Tree& tree, const model::VecN& q) noexcept {
  int nearest = 0;
  double least = HUGE_VAL;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const double off = space.Distance(tree[i].q, q);
    if (off < least) {
      least = off;
      nearest = static_cast<int>(i);
    }
  }
  return nearest;
}

Progress PathSearch::Grow(const PostureSpace& space, const model::VecN& to, int steps, Work& work, Tree& tree,
                          int& node) noexcept {
  Progress progress = Progress::kNearer;
  for (int step = 0; step < steps && progress == Progress::kNearer; ++step) {
    const Node& from = tree[static_cast<std::size_t>(node)];
    Node next{from.q, node, from.root};
    progress = tree.size() < kMostNodes && work.IsLeft() ? StepTowards(space, from.q, to, work, next.q)
                                                         : Progress::kBarred;
    if (progress != Progress::kBarred) {
      node = static_cast<int>(tree.size());
      tree.push_back(next);
    }
  }
  return progress;
}

bool PathSearch::Join(int start_node, int goal_node, Polyline& path) const noexcept {
  path.clear();
  for (int i = start_node; i >= 0; i = from_start_[static_cast<std::size_t>(i)].parent) {
    if (path.size() == kMostCorners) {
      return false;
    }
    path.push_back(from_start_[static_cast<std::size_t>(i)].q);
  }
  std::reverse(path.begin(), path.end());
  // The trees meet at the same posture.
  for (int i = from_goals_[static_cast<std::size_t>(goal_node)].parent; i >= 0;
       i = from_goals_[static_cast<std::size_t>(i)].parent) {
    if (path.size() == kMostCorners) {
      return false;
    }
    path.push_back(from_goals_[static_cast<std::size_t>(i)].q);
  }
  return true;
}

void PathSearch::Plant(const model::VecN& start, const std::vector<GoalPosture>& goals) noexcept {
  from_start_.clear();
  from_goals_.clear();
  from_start_.push_back({start, -1, 0});
  for (std::size_t i = 0; i < goals.size(); ++i) {
    from_goals_.push_back({goals[i].q, -1, static_cast<int>(i)});
  }
}

bool PathSearch::FindStraight(const PostureSpace& space, const model::VecN& start,
                              const std::vector<GoalPosture>& goals, Work& work, Polyline& path,
                              int& goal) noexcept {
  Plant(start, goals);
  for (std::size_t i = 0; i < goals.size(); ++i) {
    goal = static_cast<int>(i);
    int node = 0;
    if (Grow(space, goals[i].q, kFarthest, work, from_start_, node) == Progress::kThere) {
      return Join(node, goal, path);
    }
    node = goal;
    if (Grow(space, start, kFarthest, work, from_goals_, node) == Progress::kThere) {
      return Join(0, node, path);
    }
  }
  return false;
}

bool PathSearch::FindByTrees(const PostureSpace& space, const model::VecN& start,
                             const std::vector<GoalPosture>& goals, Work& work, Draws& draws, Polyline& path,
                             int& goal) noexcept {
  Plant(start, goals);
  bool start_grows = true;
  while (work.IsLeft() && from_start_.size() < kMostNodes && from_goals_.size() < kMostNodes) {
    Tree& grows = start_grows ? from_start_ : from_goals_;
    Tree& follows = start_grows ? from_goals_ : from_start_;
    const model::VecN aim = Aim(space, work, draws);
    int node = NearestOf(space, grows, aim);
    const int before = node;
    if (Grow(space, aim, kAimSteps, work, grows, node) != Progress::kBarred || node != before) {
      const model::VecN reached = grows[static_cast<std::size_t>(node)].q;
      int other = NearestOf(space, follows, reached);
      if (Grow(space, reached, kFarthest, work, follows, other) == Progress::kThere) {
        const int start_node = start_grows ? node : other;
        const int goal_node = start_grows ? other : node;
        goal = from_goals_[static_cast<std::size_t>(goal_node)].root;
        return Join(start_node, goal_node, path);
      }
    }
    start_grows = !start_grows;
  }
  return false;
}

}  // namespace fovea::planning
