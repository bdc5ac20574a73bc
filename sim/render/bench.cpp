// SPDX-License-Identifier: Apache-2.0
#include "sim/render/bench.hpp"

#include <algorithm>
#include <mutex>

namespace fovea::sim {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

constexpr float kFloorZ = -0.76F;
constexpr float kBevel = 0.004F;

const Vector3f kDark(0.11F, 0.12F, 0.13F);
const Vector3f kSteel(0.50F, 0.52F, 0.54F);
const Vector3f kPaper(0.86F, 0.85F, 0.80F);
const Vector3f kInstrument(0.66F, 0.68F, 0.66F);
const Vector3f kRed(0.74F, 0.07F, 0.06F);  // the target's own colour

Isometry3f At(float x, float y, float z, float yaw = 0.0F) {
  return Isometry3f(Eigen::Translation3f(x, y, z) * Eigen::AngleAxisf(yaw, Vector3f::UnitZ()));
}

// Adds a solid to the bench. `X`: pose of its centre in B.
void AddBox(Bench& bench, const Vector3f& size, const Isometry3f& X, const Vector3f& colour) {
  bench.things.emplace_back().Append(MakeBox(size, kBevel, colour), X);
}
void AddCylinder(Bench& bench, float radius, float height, const Isometry3f& X, const Vector3f& colour) {
  bench.things.emplace_back().Append(MakeCylinder(radius, height, kBevel, 40, colour), X);
}

void AddRoom(Bench& bench) {
  bench.planes.push_back({{0.4F, 0.0F, kFloorZ}, {7.0F, 7.0F}, {0.9F, 0.9F}, MakeFloor(512)});
  const Vector3f wall(0.74F, 0.76F, 0.77F);
  AddBox(bench, {7.0F, 0.1F, 3.2F}, At(0.4F, 2.2F, kFloorZ + 1.6F), wall);
  AddBox(bench, {0.1F, 7.0F, 3.2F}, At(-1.7F, 0.0F, kFloorZ + 1.6F), wall);
  const Vector3f skirting(0.32F, 0.34F, 0.36F);
  AddBox(bench, {7.0F, 0.02F, 0.1F}, At(0.4F, 2.14F, kFloorZ + 0.05F), skirting);
  AddBox(bench, {0.02F, 7.0F, 0.1F}, At(-1.64F, 0.0F, kFloorZ + 0.05F), skirting);
}

void AddTable(Bench& bench) {
  // The textured top ends where the slab's rounded edge begins.
  const Eigen::Vector2f size(kTableWidth - 2.0F * kBevel, kTableDepth - 2.0F * kBevel);
  bench.planes.push_back({{kTableX, 0.0F, 0.0F},
                          size,
                          size,
                          MakeTableTop(2048, static_cast<double>(kTableWidth),
                                       static_cast<double>(kTableDepth), 0.14, 0.0, 0.90, 0.95)});

  const float below = -0.5F * kTableThickness;
  AddBox(bench, {kTableWidth, kTableDepth, kTableThickness}, At(kTableX, 0.0F, below - 0.001F),
         {0.60F, 0.50F, 0.36F});
  const float leg_height = -kFloorZ - kTableThickness;
  for (const float x : {-0.72F, 0.72F}) {
    for (const float y : {-0.57F, 0.57F}) {
      AddBox(bench, {0.06F, 0.06F, leg_height}, At(kTableX + x, y, kFloorZ + 0.5F * leg_height), kSteel);
    }
    AddBox(bench, {0.04F, 1.1F, 0.06F}, At(kTableX + x, 0.0F, -0.10F), kSteel);
  }
}

// Ordinary things on the bench; none is red, none is a ball.
void AddTools(Bench& bench) {
  AddBox(bench, {0.22F, 0.16F, 0.11F}, At(0.02F, 0.50F, 0.055F, 0.25F), kInstrument);  // power supply
  AddBox(bench, {0.004F, 0.13F, 0.08F}, At(0.125F, 0.527F, 0.058F, 0.25F), kDark);     // its front
  AddBox(bench, {0.21F, 0.15F, 0.014F}, At(0.86F, 0.46F, 0.007F, -0.35F), kPaper);     // note block
  AddBox(bench, {0.018F, 0.15F, 0.016F}, At(0.775F, 0.49F, 0.010F, -0.35F), {0.16F, 0.28F, 0.40F});
  AddCylinder(bench, 0.036F, 0.085F, At(0.99F, -0.44F, 0.0425F), {0.83F, 0.83F, 0.80F});  // mug
  AddCylinder(bench, 0.031F, 0.002F, At(0.99F, -0.44F, 0.0855F), {0.20F, 0.12F, 0.07F});  // coffee
  AddBox(bench, {0.16F, 0.024F, 0.012F}, At(0.84F, -0.50F, 0.006F, 0.5F), kSteel);        // ruler
  AddCylinder(bench, 0.012F, 0.11F,
              At(0.30F, -0.54F, 0.012F, 0.9F) * Isometry3f(Eigen::AngleAxisf(1.5708F, Vector3f::UnitY())),
              {0.78F, 0.60F, 0.12F});  // screwdriver's handle
  AddBox(bench, {0.13F, 0.09F, 0.05F}, At(0.05F, -0.50F, 0.025F, -0.2F),
         {0.18F, 0.30F, 0.42F});  // box of parts
}

void AddClutter(Bench& bench) {
  // The target's colour, another shape.
  AddBox(bench, {0.07F, 0.07F, 0.05F}, At(0.42F, -0.10F, 0.025F, 0.6F), kRed);
  AddBox(bench, {0.15F, 0.028F, 0.02F}, At(0.615F, 0.105F, 0.01F, -0.8F), kRed);  // beside the target
  AddBox(bench, {0.028F, 0.11F, 0.012F}, At(0.47F, 0.33F, 0.006F, 0.4F), kRed);
  // The target's colour and a round outline, but far too small.
  AddCylinder(bench, 0.011F, 0.03F, At(0.60F, -0.20F, 0.015F), kRed);
  AddCylinder(bench, 0.013F, 0.012F, At(0.40F, 0.22F, 0.006F), kRed);
  // The target's shape, another colour.
  bench.balls.push_back({{0.485F, 0.095F, 0.040F}, 0.040F, {0.10F, 0.22F, 0.58F}});
  bench.balls.push_back({{0.70F, 0.23F, 0.032F}, 0.032F, {0.12F, 0.46F, 0.16F}});
  bench.balls.push_back({{0.52F, -0.27F, 0.036F}, 0.036F, {0.88F, 0.72F, 0.10F}});
  bench.balls.push_back({{0.31F, 0.29F, 0.030F}, 0.030F, {0.86F, 0.86F, 0.84F}});
  // Neither, but in the way.
  AddCylinder(bench, 0.042F, 0.09F, At(0.73F, -0.12F, 0.045F), {0.16F, 0.42F, 0.46F});
  AddBox(bench, {0.10F, 0.14F, 0.03F}, At(0.30F, -0.26F, 0.015F, 0.9F), {0.70F, 0.45F, 0.16F});
  AddCylinder(bench, 0.03F, 0.012F, At(0.61F, 0.34F, 0.006F), kSteel);
}

}  // namespace

Bench MakeBench(bool clutter) {
  Bench bench;
  AddTable(bench);  // before the room: near planes are drawn first
  AddRoom(bench);
  AddTools(bench);
  if (clutter) {
    AddClutter(bench);
  }
  return bench;
}

void AddObstacle(const Eigen::AlignedBox3d& box, Bench& bench) {
  const Vector3f size = box.sizes().cast<float>();
  const Vector3f centre = box.center().cast<float>();
  const float bevel = std::min(kBevel, 0.2F * size.minCoeff());
  bench.boxes.push_back(box);
  bench.things.emplace_back().Append(MakeBox(size, bevel, kObstacleColour),
                                     At(centre.x(), centre.y(), centre.z()));
}

std::shared_ptr<const Bench> ShareBench(bool clutter, std::span<const Eigen::AlignedBox3d> obstacles) {
  struct Made {
    bool clutter = false;
    std::weak_ptr<const Bench> bench;
  };
  static std::mutex mutex;
  static std::vector<Made> all;
  const std::lock_guard lock(mutex);
  std::erase_if(all, [](const Made& made) { return made.bench.expired(); });
  const auto is_same = [](const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) {
    return a.min() == b.min() && a.max() == b.max();
  };
  for (const Made& made : all) {
    std::shared_ptr<const Bench> bench = made.bench.lock();
    if (bench && made.clutter == clutter && std::ranges::equal(bench->boxes, obstacles, is_same)) {
      return bench;
    }
  }
  Bench bench = MakeBench(clutter);
  for (const Eigen::AlignedBox3d& box : obstacles) {
    AddObstacle(box, bench);
  }
  auto shared = std::make_shared<const Bench>(std::move(bench));
  all.push_back({clutter, shared});
  return shared;
}

}  // namespace fovea::sim
