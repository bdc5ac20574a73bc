// What the camera's lens lays on its sensor: the scene through the renderer, and through the lens where that
// is not ideal.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/camera/lens.hpp"
#include "sim/render/scene_renderer.hpp"

namespace fovea::sim {

enum class Sampling : std::uint8_t {
  kPlain,  // a ray per pixel; through a lens that is not ideal kFine all the same
  kFine,   // the mean over each pixel of a picture of twice the resolution, at four times the cost
};

// One thread at a time, as SceneRenderer.
class Optics {
 public:
  // As SceneRenderer; std::invalid_argument as LensMap.
  Optics(const RenderScene& scene, const Pinhole& pinhole, const Lens& lens, Sampling sampling,
         int index = 0);

  // Draws `exposure` into `rgba` [height * width * 4], top row first.
  void Draw(const Exposure& exposure, std::span<std::uint8_t> rgba);
  // As SceneRenderer's.
  void Watch(RenderWatch watch) { renderer_.Watch(std::move(watch)); }
  void Release() { renderer_.Release(); }
  [[nodiscard]] const std::string& driver_name() const { return renderer_.driver_name(); }

 private:
  const std::optional<LensMap> lens_;
  SceneRenderer renderer_;
  std::vector<std::uint8_t> wide_;  // what the pinhole before the lens sees
};

}  // namespace fovea::sim
