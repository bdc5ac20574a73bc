// SPDX-License-Identifier: Apache-2.0
// The lab: table, floor, walls and the things on the bench. Data only, in frame B.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <vector>

#include "sim/render/mesh.hpp"
#include "sim/render/texture.hpp"

namespace fovea::sim {

// A horizontal rectangle, visible from above.
struct TexturedPlane {
  Eigen::Vector3f centre_B = Eigen::Vector3f::Zero();
  Eigen::Vector2f size = Eigen::Vector2f::Ones();  // along x and y [m]
  Eigen::Vector2f tile = Eigen::Vector2f::Ones();  // size of one repetition of the texture [m]
  Texture texture;
};

// A ball, drawn by its exact outline, not by triangles.
struct Ball {
  Eigen::Vector3f p_B = Eigen::Vector3f::Zero();
  float radius = 0.04F;
  Eigen::Vector3f colour{0.8F, 0.1F, 0.1F};
};

struct Bench {
  std::vector<Eigen::AlignedBox3d> boxes;  // of AddObstacle; they are among `things`, too
  std::vector<TexturedPlane> planes;       // near ones first
  std::vector<Mesh> things;                // static things without a texture
  std::vector<Ball> balls;
};

// The table [m]. Its top is at z = 0 in B.
inline constexpr float kTableWidth = 1.6F;  // along x
inline constexpr float kTableDepth = 1.3F;  // along y
inline constexpr float kTableX = 0.42F;     // centre
inline constexpr float kTableThickness = 0.036F;

// The lab bench. `clutter` adds things of the target's colour and things of its shape; each differs from a
// red ball of 80 mm in colour, shape or size.
Bench MakeBench(bool clutter);

inline const Eigen::Vector3f kObstacleColour(0.20F, 0.34F, 0.42F);

// Adds a box that the arm has to avoid.
void AddObstacle(const Eigen::AlignedBox3d& box, Bench& bench);

// MakeBench and AddObstacle for each of `obstacles`. While somebody holds such a bench, all who ask for the
// same one get it: it takes 0.1 s to make, and renderers know it again. From any thread.
std::shared_ptr<const Bench> ShareBench(bool clutter, std::span<const Eigen::AlignedBox3d> obstacles);

}  // namespace fovea::sim
