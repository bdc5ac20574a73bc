// SPDX-License-Identifier: Apache-2.0
#include "sim/run/eye.hpp"

#include <cstdlib>
#include <utility>

#include "sim/camera/on_demand_camera.hpp"
#include "sim/scenario/compose.hpp"

namespace fovea::sim {
namespace {

// By default, Mesa's software renderer splits a picture over all cores. Whole pictures in parallel are more
// efficient. Keeps a value that the user has set; a GPU's driver ignores the variable.
void UseOneThreadPerRenderer() { setenv("LP_NUM_THREADS", "0", /*overwrite=*/0); }

}  // namespace

Eye::Eye(const RunDescription& about, const EyeOptions& options)
    : faults_(about.scenario.faults.picture), width_px_(about.pinhole.width_px) {
  UseOneThreadPerRenderer();
  const auto& sensor = about.bench.camera;
  const Shutter shutter = MakeScenarioShutter(about.bench);
  SimCameraConfig config;
  config.width_px = about.pinhole.width_px;
  config.height_px = about.pinhole.height_px;
  config.exposure_ns = shutter.exposure_ns;
  config.queue = options.queue;
  config.auto_exposure = {sensor.auto_exposure_level, sensor.auto_exposure_lag_s,
                          sensor.auto_exposure_gain_max};
  const SensorConfig pixels = MakeScenarioSensor(about.bench);
  const bool in_parts =
      options.for_vision_only && options.trace == nullptr && !pixels.mosaic && !config.auto_exposure.IsOn();
  const int renderers = in_parts ? 1 : options.renderers;
  for (int i = 0; i < renderers; ++i) {  // one after the other: the first initialises the driver
    optics_.push_back(std::make_unique<Optics>(about.scene, about.eye.pinhole, about.eye.lens,
                                               Sampling::kPlain, i, shutter,
                                               i == 0 ? nullptr : optics_.front().get(), options.pool));
  }
  Sensor made(pixels, SeedOf(about.scenario, RandomStream::kSensor));
  if (in_parts) {
    Optics* const optics = optics_.front().get();
    camera_ = std::make_unique<OnDemandCamera>(
        config, std::move(made),
        [this, optics](const Exposure& exposure, std::span<const PictureArea> areas,
                       std::span<std::uint8_t> rgba) { Draw(*optics, exposure, areas, rgba); },
        [optics] { optics->Release(); });
    return;
  }
  std::vector<Painter> painters;
  for (int i = 0; i < renderers; ++i) {
    Optics* const optics = optics_[static_cast<std::size_t>(i)].get();
    Painter painter;
    painter.draw = [this, optics](const Exposure& exposure, std::span<std::uint8_t> rgba) {
      Draw(*optics, exposure, {}, rgba);
    };
    painter.leave_thread = [optics] { optics->Release(); };
    painters.push_back(options.trace != nullptr ? options.trace->Watched(std::move(painter), *optics, i)
                                                : std::move(painter));
  }
  camera_ = std::make_unique<SimCamera>(config, std::move(made), std::move(painters));
}

void Eye::Draw(Optics& optics, const Exposure& exposure, std::span<const PictureArea> areas,
               std::span<std::uint8_t> rgba) {
  const PictureFaults faults = faults_.Get();
  const std::int64_t taken_ns = exposure.pixels_of ? exposure.pixels_of->stamp_ns : exposure.stamp_ns;
  const bool moves_pixels = faults.mirror.Contains(taken_ns);
  optics.Draw(exposure, rgba, moves_pixels ? std::span<const PictureArea>() : areas);
  SpoilPicture(faults, taken_ns, width_px_, rgba);
}

}  // namespace fovea::sim
