// SPDX-License-Identifier: Apache-2.0
#include "sim/render/renderer_pool.hpp"

#include <algorithm>
#include <utility>

namespace fovea::sim {

std::unique_ptr<SceneRenderer> RendererPool::Take(const RenderScene& scene, const Pinhole& pinhole,
                                                  const RenderQuality& quality, int index,
                                                  const std::optional<SensorRows>& rows,
                                                  SceneRenderer* twin) {
  std::unique_ptr<SceneRenderer> found;
  {
    const std::lock_guard lock(mutex_);
    const auto fitting = std::ranges::find_if(
        waiting_, [&](const auto& renderer) { return renderer->Fits(scene, quality, index, rows); });
    if (fitting != waiting_.end()) {
      found = std::move(*fitting);
      waiting_.erase(fitting);
    }
  }
  if (found == nullptr) {
    return std::make_unique<SceneRenderer>(scene, pinhole, quality, index, rows, twin);
  }
  found->Show(scene, pinhole, rows);
  return found;
}

void RendererPool::Give(std::unique_ptr<SceneRenderer> renderer) {
  renderer->Release();
  const std::lock_guard lock(mutex_);
  std::erase_if(waiting_, [&](const auto& other) { return other->index() == renderer->index(); });
  waiting_.push_back(std::move(renderer));
}

}  // namespace fovea::sim
