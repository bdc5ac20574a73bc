// SPDX-License-Identifier: Apache-2.0
// The picture on the sensor: renders the scene at the times of the exposure, and resamples it through the
// lens if the lens is not ideal.
//
// The renderer's values are linear in light, and so is the sensor. Blur is the mean of these values.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/camera/lens.hpp"
#include "sim/camera/shutter.hpp"
#include "sim/render/renderer_pool.hpp"

namespace fovea::sim {

enum class Sampling : std::uint8_t {
  kPlain,  // one ray per pixel; a lens that is not ideal uses kFine anyway
  kFine,   // each pixel is a mean over a picture of twice the resolution, at four times the cost
};

// One thread at a time may use it, as with SceneRenderer.
class Optics {
 public:
  // `index`: as SceneRenderer's, and it throws the same; std::invalid_argument as LensMap. `twin`: of the
  // same scene, camera and lens, on no other thread; what it has prepared is copied. `pool`: its renderer
  // comes from there and goes back; null: a new one. It must outlive this.
  Optics(const RenderScene& scene, const Pinhole& pinhole, const Lens& lens, Sampling sampling, int index = 0,
         const Shutter& shutter = {}, Optics* twin = nullptr, RendererPool* pool = nullptr);
  ~Optics();

  // Draws `exposure` into `rgba` [height * width * 4], top row first. A scene that stands still during the
  // exposure (`around` is null) is drawn once. With `areas`, only their pixels are those of the picture,
  // which takes less time; through a lens all are, at any rate.
  void Draw(const Exposure& exposure, std::span<std::uint8_t> rgba, std::span<const PictureArea> areas = {});
  // As SceneRenderer's.
  void Watch(RenderWatch watch) { renderer_->Watch(std::move(watch)); }
  void Release() { renderer_->Release(); }
  [[nodiscard]] const std::string& driver_name() const { return renderer_->driver_name(); }

 private:
  using Areas = std::span<const PictureArea>;
  void DrawSharp(const Moment& moment, Areas areas, std::span<std::uint8_t> rgba);
  void DrawRows(const Exposure& exposure, double offset_ns, Areas areas, std::span<std::uint8_t> rgba);

  const Shutter shutter_;
  const int height_px_;
  const std::optional<LensMap> lens_;
  RendererPool* const pool_;
  std::unique_ptr<SceneRenderer> renderer_;
  std::vector<std::uint8_t> wide_;  // the pinhole picture that the lens resamples
  std::vector<std::uint16_t> sum_;  // of the sub-exposures
  std::vector<PictureArea> in_band_;
};

}  // namespace fovea::sim
