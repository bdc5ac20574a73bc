// SPDX-License-Identifier: Apache-2.0
#include "sim/run/eye.hpp"

#include <cstdlib>
#include <utility>

#include "sim/scenario/compose.hpp"

namespace fovea::sim {
namespace {

// By default, Mesa's software renderer splits a picture over all cores. Whole pictures in parallel are more
// efficient. Keeps a value that the user has set; a GPU's driver ignores the variable.
void UseOneThreadPerRenderer() { setenv("LP_NUM_THREADS", "0", /*overwrite=*/0); }

}  // namespace

Eye::Eye(const RunDescription& about, std::size_t queue, RunTrace* trace, int renderers)
    : faults_(about.scenario.faults.picture), width_px_(about.pinhole.width_px) {
  UseOneThreadPerRenderer();
  const Shutter shutter = MakeScenarioShutter(about.bench);
  std::vector<Painter> painters;
  for (int i = 0; i < renderers; ++i) {  // one after the other: the first initialises the driver
    optics_.push_back(std::make_unique<Optics>(about.scene, about.eye.pinhole, about.eye.lens,
                                               Sampling::kPlain, i, shutter,
                                               optics_.empty() ? nullptr : optics_.front().get()));
    Optics* const optics = optics_.back().get();
    Painter painter;
    painter.draw = [this, optics](const Exposure& exposure, std::span<std::uint8_t> rgba) {
      optics->Draw(exposure, rgba);
      const std::int64_t taken_ns = exposure.pixels_of ? exposure.pixels_of->stamp_ns : exposure.stamp_ns;
      SpoilPicture(faults_.Get(), taken_ns, width_px_, rgba);
    };
    painter.leave_thread = [optics] { optics->Release(); };
    painters.push_back(trace != nullptr ? trace->Watched(std::move(painter), *optics, i)
                                        : std::move(painter));
  }
  SimCameraConfig config;
  config.width_px = about.pinhole.width_px;
  config.height_px = about.pinhole.height_px;
  config.exposure_ns = shutter.exposure_ns;
  config.queue = queue;
  const auto& sensor = about.bench.camera;
  config.auto_exposure = {sensor.auto_exposure_level, sensor.auto_exposure_lag_s,
                          sensor.auto_exposure_gain_max};
  camera_ = std::make_unique<SimCamera>(
      config, Sensor(MakeScenarioSensor(about.bench), SeedOf(about.scenario, RandomStream::kSensor)),
      std::move(painters));
}

}  // namespace fovea::sim
