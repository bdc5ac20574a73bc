// SPDX-License-Identifier: Apache-2.0
// Draws the bench, the robot and the target for a pinhole camera at a given pose.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/render/bench.hpp"
#include "sim/render/exposure.hpp"
#include "sim/render/pinhole.hpp"
#include "sim/render/row_band.hpp"
#include "sim/render/target_shape.hpp"
#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

struct RenderQuality {
  int samples = 0;  // per pixel, for the edges of meshes; 0 or 1: one. Balls are always exact.
  int shadow_map_px = 256;
  int shadow_taps = 1;         // 1 to 16 samples; each averages four texels
  float shadow_spread = 1.6F;  // radius of the samples, in texels of the shadow map
  bool skip_hidden = true;     // does not draw what a table hides completely; the picture is the same

  bool operator==(const RenderQuality&) const = default;
};

struct RenderScene {
  std::shared_ptr<const Bench> bench = std::make_shared<const Bench>();
  SimRobot robot;
  Eigen::Isometry3d X_EC = Eigen::Isometry3d::Identity();  // pose of the camera on the tip link
  bool has_eye = true;                                     // false: no camera housing and no target
  TargetShape target;
  Eigen::Matrix3d target_R_BO = Eigen::Matrix3d::Identity();  // at the start
  Eigen::Vector3f target_colour{0.74F, 0.07F, 0.06F};
  double light = 1.0;  // brightness; 1: a well-lit room and a well-set camera
};

// Draw calls it after each part of its work, with the part's name.
using RenderWatch = std::function<void(const char* part)>;

// One thread at a time. The first call on a thread takes the OpenGL context; Release releases it.
class SceneRenderer {
 public:
  // `index` numbers the renderers that work at the same time, from 0 (see EglContext). `rows`: for DrawBand.
  // `twin`: a renderer of the same scene that is on no other thread; what it has painted is copied, in place
  // of being painted again. std::runtime_error (one line): there is no EGL, or the driver cannot draw.
  SceneRenderer(const RenderScene& scene, const Pinhole& pinhole, const RenderQuality& quality, int index = 0,
                const std::optional<SensorRows>& rows = std::nullopt, SceneRenderer* twin = nullptr);
  ~SceneRenderer();
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  // True if Show can show this: the bench is the same object, and so are quality, index, and whether there
  // are rows.
  [[nodiscard]] bool Fits(const RenderScene& scene, const RenderQuality& quality, int index,
                          const std::optional<SensorRows>& rows) const;
  // Shows another scene that fits, by another camera: its pictures are those of a new renderer. Robot and
  // target are made anew; bench, light on it, and programs are kept, which take most of a renderer's time.
  void Show(const RenderScene& scene, const Pinhole& pinhole, const std::optional<SensorRows>& rows);

  // Draws `moment` as seen from `X_BC` into `rgba` [height * width * 4], top row first. With `areas`: only
  // their pixels are those of the picture, which takes less time.
  void Draw(const Moment& moment, const Eigen::Isometry3d& X_BC, std::span<std::uint8_t> rgba,
            std::span<const PictureArea> areas = {});

  // Draws the rows of `band` into those of `rgba`, a whole picture; the others stay as they are. Each pixel
  // of a ball or a plate shows it at the time of its row. All else, shadows too, is as in the band's middle.
  // Call it only on a renderer that knows the sensor's rows. `areas`: as for Draw.
  void DrawBand(const RowBand& band, std::span<std::uint8_t> rgba, std::span<const PictureArea> areas = {});

  // Call it before the first Draw. Draw then finishes each part separately, which makes it a little slower.
  void Watch(RenderWatch watch);

  void Release();
  [[nodiscard]] const Pinhole& pinhole() const;
  [[nodiscard]] int index() const;
  [[nodiscard]] const std::string& driver_name() const { return driver_name_; }

 private:
  struct Impl;
  void CheckSize(std::span<const std::uint8_t> rgba) const;

  std::string driver_name_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fovea::sim
