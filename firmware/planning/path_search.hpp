// SPDX-License-Identifier: Apache-2.0
// Searches a path of straight joint motions from the start to one of the goals.
//
// First straight to each goal, the cheapest first, with the target kept in the picture. Then two trees, one
// from the start and one from all goals, which grow towards random postures and towards each other (Kuffner
// and LaValle, RRT-Connect, ICRA 2000). Few postures see the target. So a random posture is first turned
// towards it, and a step that takes it out of the picture is corrected (Berenson and others, Manipulation
// planning on constraint manifolds, ICRA 2009).
#pragma once

#include <vector>

#include "firmware/planning/edges.hpp"
#include "firmware/planning/goal_search.hpp"

namespace fovea::planning {

inline constexpr std::size_t kMostCorners = 512;
using Polyline = std::vector<model::VecN>;  // kMostCorners are reserved, so that it does not grow

class PathSearch {
 public:
  static constexpr int kMostNodes = 6000;  // of a tree

  PathSearch();

  // Straight to the goals. True if a path was found: `path` from `start` to the posture of goal number
  // `goal`.
  [[nodiscard]] bool FindStraight(const PostureSpace& space, const model::VecN& start,
                                  const std::vector<GoalPosture>& goals, Work& work, Polyline& path,
                                  int& goal) noexcept;
  // The same by trees, until the work is used up.
  [[nodiscard]] bool FindByTrees(const PostureSpace& space, const model::VecN& start,
                                 const std::vector<GoalPosture>& goals, Work& work, Draws& draws,
                                 Polyline& path, int& goal) noexcept;

 private:
  struct Node {
    model::VecN q;
    int parent = -1;
    int root = 0;  // number of the goal; 0 in the start's tree
  };
  using Tree = std::vector<Node>;

  void Plant(const model::VecN& start, const std::vector<GoalPosture>& goals) noexcept;
  // The number of the node nearest to `q`.
  [[nodiscard]] static int NearestOf(const PostureSpace& space, const Tree& tree,
                                     const model::VecN& q) noexcept;
  // Steps from `node` towards `to` until there or barred. `node` becomes the last one reached.
  [[nodiscard]] static Progress Grow(const PostureSpace& space, const model::VecN& to, int steps, Work& work,
                                     Tree& tree, int& node) noexcept;
  [[nodiscard]] bool Join(int start_node, int goal_node, Polyline& path) const noexcept;

  Tree from_start_;
  Tree from_goals_;
};

}  // namespace fovea::planning
