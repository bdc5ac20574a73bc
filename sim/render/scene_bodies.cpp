// SPDX-License-Identifier: Apache-2.0
#include "sim/render/scene_bodies.hpp"

#include <utility>

#include "sim/render/link_parts.hpp"

namespace fovea::sim {

std::vector<Thing> UploadThings(const Bench& bench) {
  std::vector<Thing> things;
  for (const Mesh& mesh : bench.things) {
    things.push_back({std::make_unique<GpuMesh>(mesh), FindEdges(mesh), FindBounds(mesh), FindBox(mesh)});
  }
  return things;
}

std::vector<Link> UploadLinks(const SimRobot& robot, const Eigen::Isometry3d* X_EC) {
  std::vector<Link> links;
  const Eigen::Isometry3f mount = X_EC != nullptr ? X_EC->cast<float>() : Eigen::Isometry3f::Identity();
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const SimLink& link = robot.links[i];
    const bool carries = X_EC != nullptr && static_cast<int>(i) == robot.tip;
    const Eigen::Isometry3f* camera = carries ? &mount : nullptr;
    const std::vector<Mesh> seen = MakeParts(link, camera, Detail::kPicture);
    const std::vector<Mesh> casters = MakeParts(link, camera, Detail::kShadow);
    std::vector<Box> shapes;
    for (std::size_t k = 0; k < link.visuals.size(); ++k) {
      shapes.push_back(FindBox(casters[k]));
    }
    const Mesh mesh = Join(seen);
    links.push_back({std::make_unique<GpuMesh>(mesh), std::make_unique<GpuMesh>(Join(casters)),
                     FindAllEdges(seen), FindBounds(mesh), std::move(shapes)});
  }
  return links;
}

}  // namespace fovea::sim
