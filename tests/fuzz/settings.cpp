// SPDX-License-Identifier: Apache-2.0
// The key sections shared by scenarios and hardware configurations, as a TOML file and as an assignment. Any
// text is refused with a one-line error, or it gives a configuration that the servo accepts.
#include "firmware/host/config/settings.hpp"

#include <cmath>

#include "firmware/core/task/servo_task.hpp"
#include "firmware/host/config/camera_keys.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/load_keys.hpp"
#include "firmware/host/config/servo_keys.hpp"
#include "firmware/host/config/vision_keys.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/support/panda.hpp"

using fovea::fuzz::Require;
using namespace fovea;

namespace {

struct Everything {
  config::LoadSettings load;
  config::CalibrationSettings camera;
  config::VisionSettings vision;
  config::TargetSettings target;
  config::ServoSettings servo;
  config::KeyTable keys;
  Everything() {
    camera.intrinsics = {640, 480, 500.0, 500.0, 319.5, 239.5};
    config::AddLoadKeys(load, keys);
    config::AddCalibrationKeys(camera, keys);
    config::AddVisionKeys(vision, keys);
    config::AddTargetKeys(target, keys);
    config::AddServoKeys(servo, keys);
  }

  void Apply(const std::vector<config::Setting>& settings) {
    for (const config::Setting& setting : settings) {
      keys.Apply(setting);
    }
    const model::Load carried = config::MakeLoad(load);
    Require(std::isfinite(carried.mass) && carried.mass >= 0.0, "a load's mass is finite and not negative");
    const model::Pose X_EC = config::MakeMount(camera);
    const config::ServoConfig made = config::MakeServoConfig(
        servo, {test::Panda().name, test::Panda().model, {}}, X_EC, config::MakeIntrinsics(camera), target);
    task::ServoTask task;
    Require(task.Init(made).ok(), "the servo accepts every configuration that was made");
  }
};

template <typename Do>
void Refused(Do&& take) {
  try {
    take();
  } catch (const config::InputError& error) {
    Require(fuzz::IsOneLine(error.what()), "an error message is one line");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::InputFile file("settings.toml");
  const auto& path = file.Write({data, size});
  Refused([&] { Everything().Apply(config::ReadTomlFile(path)); });
  const std::string text(reinterpret_cast<const char*>(data), size);
  Refused([&] { Everything().Apply({config::ParseAssignment(text)}); });
  return 0;
}
