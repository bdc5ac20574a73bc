// SPDX-License-Identifier: Apache-2.0
// Renderers that wait for their next scene. Making one takes most of a second: programs, and the painted
// light of the bench. A process that simulates many runs makes them once.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "sim/render/scene_renderer.hpp"

namespace fovea::sim {

// From any thread; a renderer that is out is used by one.
class RendererPool {
 public:
  // One that waits and fits, or a new one. Parameters, pictures and exceptions: as SceneRenderer's
  // constructor.
  std::unique_ptr<SceneRenderer> Take(const RenderScene& scene, const Pinhole& pinhole,
                                      const RenderQuality& quality, int index,
                                      const std::optional<SensorRows>& rows, SceneRenderer* twin);
  // No other thread may hold its context. Of each index only the last one waits.
  void Give(std::unique_ptr<SceneRenderer> renderer);

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<SceneRenderer>> waiting_;
};

}  // namespace fovea::sim
